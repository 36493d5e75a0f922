"""Features of the steady responses of n cases at L levels, as arrays of shape (L, n)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ..features import COLUMNS
from ..motion.orbits import steady_orbits, write_zero_crossings
from ..motion.regime import Regime

Array = NDArray[np.float64]

STEP_TOO_COARSE, NOT_READ, RIGID_LIMIT = 5, 6, 7
REGIME_NAMES = [
    *(regime.name.lower() for regime in Regime),
    "step_too_coarse",
    "not_read",
    "rigid_limit",
]
REGIME_WORDS = [
    *map(str, Regime),
    "the fixed step is too coarse for the stick phases, or unstable",
    "no slip onset could be read off the record",
    "the slip onset drowns in the noise: that of a rigid contact stands for it",
]
"""Why a feature is missing, by code: `Regime`, and what the routes that read records add to it."""


@dataclass(frozen=True)
class Responses:
    """Features as in `features.Features`, but of many cases: arrays (L, n), omega (1, n), regime codes (L, n).

    The row functions of `balance.py` and the rules of `replication/readout.py` work element by element
    and take it as it is.
    """

    omega: Array
    Y: Array
    X: Array
    X_s: Array
    V_s: Array
    t_s: Array
    phi: Array
    phi_reversal: Array
    phi_zero_crossing: Array
    phi_fundamental: Array
    X_r: Array
    V_r: Array
    t_r: Array
    X_1: Array
    X_3: Array
    X_5: Array
    a: Array
    b: Array
    W: Array
    regime: NDArray[np.uint8]

    def replaced(self, **values: Array) -> Self:
        """The same responses but for the features given by name."""
        return replace(self, **values)  # type: ignore[arg-type]

    def with_phase(self, phase: str) -> Self:
        """The same responses with `phi` the phase named: reversal, zero_crossing or fundamental."""
        return replace(self, phi=getattr(self, f"phi_{phase}"))

    def with_common(self, *names: str) -> Self:
        """Each of the features named replaced, case by case, by its mean over the levels that have it."""
        common = {}
        for name in names:
            values: Array = getattr(self, name)
            known = np.isfinite(values)
            count = np.count_nonzero(known, axis=0)
            with np.errstate(invalid="ignore"):  # no level has it: NaN
                mean = np.sum(np.where(known, values, 0.0), axis=0) / count
            common[name] = np.where(known, mean, np.nan)
        return replace(self, **common)

    def cases(self, index: NDArray[np.int64]) -> Self:
        """The cases `index`."""
        return replace(self, **{name: getattr(self, name)[:, index] for name in _FIELDS})


_FIELDS = ("omega", *COLUMNS, "regime")


def exact_responses(
    si: Mapping[str, Array], Y: Array, zero_crossings: bool, threads: int | None = None
) -> Responses:
    """The exact steady responses of n cases at L levels.

    si : m, c, k, K_z, F_k, omega, each (n,).   Y : amplitudes of the base, m, (L, n).   zero_crossings : whether the
    phase of the displacement's zero crossing is wanted (it costs a root search per response); NaN otherwise.
    """
    system = {name: si[name][None, :] for name in ("m", "c", "k", "K_z", "F_k", "omega")}
    orbits = steady_orbits(**system, Y=Y, threads=threads)
    crossing = np.full(Y.shape, np.nan)
    if zero_crossings:
        inputs = [np.broadcast_to(array, Y.shape).ravel() for array in (*system.values(), Y)]
        write_zero_crossings(
            np.stack(inputs),
            np.stack(
                [orbits.X.ravel(), orbits.V_s.ravel(), orbits.t_s.ravel(), orbits.phi.ravel()]
            ),
            orbits.regime.ravel(),
            crossing.reshape(-1),
        )
    return Responses(
        omega=system["omega"],
        Y=Y,
        X=orbits.X,
        X_s=orbits.X_s,
        V_s=orbits.V_s,
        t_s=orbits.t_s,
        phi=orbits.phi,
        phi_reversal=orbits.phi,
        phi_zero_crossing=crossing,
        phi_fundamental=wrapped(orbits.phi_1),
        X_r=-orbits.X_s,  # the orbit is symmetric: reverse slip mirrors forward slip
        V_r=-orbits.V_s,
        t_r=orbits.t_s,
        X_1=orbits.X_1,
        X_3=orbits.X_3,
        X_5=orbits.X_5,
        a=orbits.a,
        b=orbits.b,
        W=orbits.W,
        regime=orbits.regime,
    )


def wrapped(angle: Array) -> Array:
    """The angles plus multiples of 2π, in [−π/2, 3π/2), as in `features.wrapped`."""
    return np.asarray((angle + 0.5 * np.pi) % (2.0 * np.pi) - 0.5 * np.pi)
