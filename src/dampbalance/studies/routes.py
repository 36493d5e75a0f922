"""Where the responses of a study come from: one object per route answers what the rest asks of it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field

from ..balance import APPROACHES
from ..law.terms import FRICTION, KNOWN_TERMS, in_order

NONE = "none"
"""The name where no law is chosen."""


@dataclass(frozen=True, slots=True)
class Route:
    """A way to the responses of a case; what depends on the route is asked here.

    kind : its name in the file.
    needs : parameters of the route; of each group one is needed.
    optional : further parameters that it takes.
    settings : other keys of the section `route` that it takes.
    refuses : sections of the file that mean nothing to it, and why.
    any_law : whether the oscillator may have further damping terms, and the balance too.
    answers : what a case ends in, which facts are about: coefficients by symbol, or the law that its records support.
    approaches : to the balance, if the file does not say; none where a case ends in a law.
    figures : kinds of figures.
    columns : kinds of columns in the table of cases, if the file does not say.
    cycles, chunk_cases : if the file does not say; a chunk is a few seconds of work.
    """

    kind: str
    needs: tuple[tuple[str, ...], ...] = ()
    optional: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    refuses: tuple[str, ...] = ()
    any_law: bool = False
    answers: Collection[str] = field(default_factory=KNOWN_TERMS.keys)
    approaches: Collection[str] = field(default_factory=APPROACHES.keys)
    figures: tuple[str, ...] = ("curves", "map", "steps", "scatter")
    columns: tuple[str, ...] = ("parameters", "errors")
    cycles: int = 4
    chunk_cases: int = 512

    def __reduce__(self) -> tuple[Callable[[str], Route], tuple[str]]:
        """A copy is the route itself, whose answers and approaches follow what is registered."""
        return _named, (self.kind,)

    @property
    def parameters(self) -> set[str]:
        """Every parameter that means something to the route."""
        return {name for group in self.needs for name in group} | set(self.optional)

    @property
    def is_noisy(self) -> bool:
        """Whether the records have noise, which needs a seed and makes rules of reading meaningless."""
        return "seed" in self.settings

    @property
    def has_intervals(self) -> bool:
        """Whether coefficients have standard errors, by which their rows can be weighted."""
        return "replicates" in self.settings


ROUTES = {
    route.kind: route
    for route in (
        Route("exact", any_law=True, chunk_cases=524_288),
        Route(
            "fixed_step",
            needs=(("scheme",), ("step_s", "steps_per_cycle")),
            settings=("cycles", "reading"),
            cycles=10,
            chunk_cases=64,
        ),
        Route("sampled", needs=(("sampling_hz",),), settings=("cycles", "reading")),
        Route(
            "measured",
            needs=(("sampling_hz",), ("noise",)),
            optional=("run",),
            settings=("cycles", "seed", "replicates"),
            cycles=100,
            chunk_cases=60,
        ),
        Route(
            "laws",
            needs=(("law",), ("noise",)),
            optional=("run",),
            settings=("cycles", "seed"),
            refuses=("base", "estimation", "columns", "summary_by"),
            any_law=True,
            answers=("law",),
            approaches=(),
            figures=("confusion",),
            columns=("chosen",),
            cycles=100,
            chunk_cases=2,
        ),
    )
}


def _named(kind: str) -> Route:
    return ROUTES[kind]


REPLICATES = 200
"""Bootstrap replicates if the file does not say; their standard error is accurate to 5 %."""


def law_named(terms: Iterable[str]) -> str:
    """The name of a law by its terms, friction first: F_k + c + c_2."""
    return " + ".join(in_order((FRICTION, *terms)))


def terms_named(name: str) -> tuple[str, ...]:
    """The terms of a law by its name. Raises ValueError for an unknown term, or a name of another form."""
    terms = in_order(name.split(" + "))
    if law_named(terms) != name:
        raise ValueError(f"the law {name!r} should be written {law_named(terms)!r}")
    return terms
