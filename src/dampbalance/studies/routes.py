"""Where the responses of a study come from: what each route needs, and what stands for what is left out."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ..project.documents import Problem
from .parameters import PARAMETERS


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
    "exact": Route(chunk_cases=262_144),
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
}

REPLICATES = 200
"""Bootstrap replicates if the file does not say: a standard error from them is good to 5 %."""


def route_problems(
    route: Mapping[str, Any], used: Collection[str], columns: Collection[str]
) -> Iterator[Problem]:
    """What does not fit the route: parameters and settings that are missing, or that mean nothing to it.

    route : that section of the file.   used : every parameter of the study.   columns : kinds of columns asked for.
    """
    kind = route.get("kind", "exact")
    wanted = ROUTES[kind]
    for names in wanted.numerics:
        if not set(used) & set(names):
            yield ("route",), f"{kind} needs {' or '.join(names)}, here or as an axis"
        elif set(names) <= set(used) and len(names) > 1:
            yield ("route",), f"{' and '.join(names)} say the same; keep one"
    for name in sorted(used):
        if PARAMETERS[name].kind == "numerics" and name not in wanted.parameters:
            yield ("route",), f"{name} means nothing to the route {kind}"
        if PARAMETERS[name].kind == "read_out" and kind == "measured":
            yield ("read_out", name), "means nothing to the route measured: noise is its limit"
    for name in route:
        known = {key for each in ROUTES.values() for key in each.settings}
        if name in known and name not in wanted.settings:
            yield ("route", name), f"means nothing to the route {kind}; leave it out"
    if kind == "measured" and "seed" not in route:
        yield ("route", "seed"), "missing; the seed of the noise, an integer of at least 0"
    if "intervals" in columns and kind != "measured":
        yield ("columns",), "intervals are those of noisy records: they need the route measured"
