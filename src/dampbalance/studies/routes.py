"""Where the responses of a study come from: what each route needs, and its defaults."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..law.terms import FRICTION, in_order

LAWS = "laws"
"""The route whose cases end in a law that is chosen, not in coefficients."""

NONE = "none"
"""Where no law is chosen."""


@dataclass(frozen=True, slots=True)
class Route:
    """A way to the responses of a case.

    numerics : the parameters of the route; of each group one is needed.   settings : other keys of `route` that mean
    something to it.   cycles, chunk_cases : if the file does not say; a chunk is a few seconds of work.
    """

    numerics: tuple[tuple[str, ...], ...] = ()
    optional: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    cycles: int = 4
    chunk_cases: int = 512

    @property
    def parameters(self) -> set[str]:
        """Every parameter that means something to the route."""
        return {name for group in self.numerics for name in group} | set(self.optional)


ROUTES = {
    "exact": Route(chunk_cases=524_288),
    "fixed_step": Route(
        numerics=(("scheme",), ("step_s", "steps_per_cycle")),
        settings=("cycles", "reading"),
        cycles=10,
        chunk_cases=64,
    ),
    "sampled": Route(numerics=(("sampling_hz",),), settings=("cycles", "reading")),
    "measured": Route(
        numerics=(("sampling_hz",), ("noise",)),
        optional=("run",),
        settings=("cycles", "seed", "replicates"),
        cycles=100,
        chunk_cases=60,
    ),
    LAWS: Route(
        numerics=(("law",), ("noise",)),
        optional=("run",),
        settings=("cycles", "seed"),
        cycles=100,
        chunk_cases=2,
    ),
}

REPLICATES = 200
"""Bootstrap replicates if the file does not say: a standard error from them is good to 5 %."""


def law_named(terms: Iterable[str]) -> str:
    """The name of a law by its terms, friction first: F_k + c + c_2."""
    return " + ".join(in_order((FRICTION, *terms)))


def terms_named(name: str) -> tuple[str, ...]:
    """The terms of a law by its name. Raises ValueError for a term that is not known, or a name of another form."""
    terms = in_order(name.split(" + "))
    if law_named(terms) != name:
        raise ValueError(f"the law {name!r} should be written {law_named(terms)!r}")
    return terms
