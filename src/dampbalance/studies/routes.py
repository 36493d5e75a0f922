"""Where the responses of a study come from: what each route needs, and its defaults."""

from __future__ import annotations

from dataclasses import dataclass


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
}

REPLICATES = 200
"""Bootstrap replicates if the file does not say: a standard error from them is good to 5 %."""
