"""Features of n responses at one frequency: all that the estimators know (Tables 1 and 2).

`of_orbit` takes them from an exact orbit, `reading/clean.py` reads them off a sampled record; `stack` joins
responses. What a response does not have (no slip, no slip onset) is NaN, and its `regime` says why.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .motion.orbit import Orbit

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
Phase = Literal["reversal", "zero_crossing", "fundamental"]

COLUMNS = {
    "Y": "Y_m",
    "X": "X_m",
    "X_s": "X_s_m",
    "V_s": "V_s_m_per_s",
    "t_s": "t_s_s",
    "phi": "phi_rad",
    "phi_reversal": "phi_reversal_rad",
    "phi_zero_crossing": "phi_zero_crossing_rad",
    "phi_fundamental": "phi_fundamental_rad",
    "X_r": "X_r_m",
    "V_r": "V_r_m_per_s",
    "t_r": "t_r_s",
    "X_1": "X_1_m",
    "X_3": "X_3_m",
    "X_5": "X_5_m",
    "a": "a_m",
    "b": "b_m2_per_s",
    "W": "W_J",
}
"""Column of a data frame that holds each feature, named with its unit."""

_OMEGA, _REGIME = "omega_rad_per_s", "regime"


@dataclass(frozen=True, eq=False)
class Features:
    """Features of n responses at one frequency; read-only arrays of shape (n,), SI units, NaN where one does not exist.

    omega : drive frequency ω, rad/s.
    Y : amplitude of the base, m.   X : peak displacement, m.
    X_s, V_s : displacement (m, negative) and velocity (m/s) at forward slip onset.
    t_s : time from the velocity reversal at −X to that onset, s (as in Eqs. 17 and 18).
    phi : the lag of x behind y that the balance uses, rad; one of the next three unless replaced.
    phi_reversal : lag of the velocity reversal at +X behind the peak of y.   phi_zero_crossing : lag of the upward zero
    crossing of x behind that of y.   phi_fundamental : lag of the fundamental of x behind y.
    X_r, V_r, t_r : the mirror image at reverse slip onset; X_r > 0, V_r < 0, t_r from the reversal at +X.
    X_1, X_3, X_5 : amplitudes of the harmonics of x, m.
    a, b, W : friction travel (m), viscous integral (m²/s), input work (J) per cycle by direct integration, (5), (7).
    regime : for each response, what kind it is, or why something is missing.

    Raises ValueError naming the field when lengths differ.
    """

    omega: float
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
    regime: tuple[str, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "omega", float(self.omega))
        object.__setattr__(self, "regime", tuple(str(words) for words in self.regime))
        for name in COLUMNS:
            values = np.array(getattr(self, name), dtype=np.float64)
            if values.shape != (len(self.regime),):
                raise ValueError(
                    f"Features.{name} has shape {values.shape}, regime has {len(self.regime)} entries"
                )
            values.flags.writeable = False
            object.__setattr__(self, name, values)

    def __len__(self) -> int:
        return len(self.regime)

    @property
    def slipping(self) -> NDArray[np.bool_]:
        """Which responses have a slip onset, shape (n,)."""
        return np.isfinite(self.X_s)

    def replaced(self, **values: ArrayLike) -> Self:
        """The same features but for those given by name; a single number stands for all responses."""
        unknown = sorted(set(values) - set(COLUMNS))
        if unknown:
            raise ValueError(f"unknown features {unknown}; known are {list(COLUMNS)}")
        arrays = {name: np.asarray(value, dtype=np.float64) for name, value in values.items()}
        filled = {n: np.full(len(self), a) if a.ndim == 0 else a for n, a in arrays.items()}
        return replace(self, **filled)  # type: ignore[arg-type]

    def with_phase(self, phase: Phase) -> Self:
        """The same features with `phi` the phase named: "reversal", "zero_crossing" or "fundamental"."""
        name = f"phi_{phase}"
        if name not in COLUMNS:
            raise ValueError(
                f'phase must be "reversal", "zero_crossing" or "fundamental", got {phase!r}'
            )
        return self.replaced(phi=getattr(self, name))

    def with_common(self, *names: str) -> Self:
        """The same features with each of those named replaced by its mean over the responses that have it.

        `with_common("phi", "t_s")` is the common phase and slip time of Eqs. (16), (18), (19). A response that lacks
        the feature goes on lacking it.
        """
        common: dict[str, ArrayLike] = {}
        for name in names:
            values: Array = getattr(self, name)
            known = np.isfinite(values)
            common[name] = np.where(
                known, np.mean(values[known]) if known.any() else np.nan, np.nan
            )
        return self.replaced(**common)

    def take(self, indices: Sequence[int]) -> Self:
        """The responses `indices`, counted from 0, in that order."""
        chosen = list(indices)
        arrays = {name: getattr(self, name)[chosen] for name in COLUMNS}
        return replace(self, regime=tuple(self.regime[i] for i in chosen), **arrays)

    def to_frame(self) -> pd.DataFrame:
        """One row per response, columns named with their units (`COLUMNS`), ω first and the regime last."""
        import pandas as pd  # slow to import, and needed for tables only

        columns = {column: getattr(self, name) for name, column in COLUMNS.items()}
        frame = pd.DataFrame({**columns, _REGIME: list(self.regime)})
        frame.insert(0, _OMEGA, self.omega)
        return frame

    @classmethod
    def from_frame(cls, frame: pd.DataFrame) -> Self:
        """The features that `to_frame` described. Raises ValueError: a column missing, several frequencies, no row."""
        missing = [c for c in (_OMEGA, *COLUMNS.values(), _REGIME) if c not in frame.columns]
        if missing:
            raise ValueError(
                f"a table of features needs the columns {missing}, found {list(frame.columns)}"
            )
        return cls(
            omega=_one_frequency(frame[_OMEGA].to_numpy(dtype=np.float64)),
            regime=tuple(frame[_REGIME]),
            **{name: frame[column].to_numpy(dtype=np.float64) for name, column in COLUMNS.items()},
        )


def of_orbit(orbit: Orbit) -> Features:
    """Features of one exact steady orbit, exact to rounding.

    The orbit is symmetric, x(t + T/2) = −x(t): reverse slip is the mirror image of forward slip.
    """
    (X_1, phi_1), (X_3, _), (X_5, _) = (orbit.harmonic(n) for n in (1, 3, 5))
    return single(
        orbit.motion.omega,
        str(orbit.regime),
        Y=orbit.motion.Y,
        X=orbit.X,
        X_s=orbit.X_s,
        V_s=orbit.V_s,
        t_s=orbit.t_s,
        phi=orbit.phi,
        phi_reversal=orbit.phi,
        phi_zero_crossing=orbit.phi_zero_crossing,
        phi_fundamental=wrapped(phi_1),
        X_r=-orbit.X_s,
        V_r=-orbit.V_s,
        t_r=orbit.t_s,
        X_1=X_1,
        X_3=X_3,
        X_5=X_5,
        a=orbit.a,
        b=orbit.b,
        W=orbit.W,
    )


def single(omega: float, regime: str, **values: float) -> Features:
    """Features of one response from its numbers by name; one that is not given does not exist (NaN)."""
    numbers = dict.fromkeys(COLUMNS, np.nan) | values
    return Features(
        omega=omega, regime=(regime,), **{name: np.array([v]) for name, v in numbers.items()}
    )


def wrapped(angle: float) -> float:
    """The angle plus a multiple of 2π, in [−π/2, 3π/2): lags near 0 and near π both lie well inside."""
    return float((angle + 0.5 * np.pi) % (2.0 * np.pi) - 0.5 * np.pi)


def stack(parts: Sequence[Features]) -> Features:
    """The responses of all parts as one, in order. Raises ValueError when there is none or the frequencies differ."""
    omega = _one_frequency(np.array([part.omega for part in parts]))
    arrays = {name: np.concatenate([getattr(part, name) for part in parts]) for name in COLUMNS}
    return Features(omega=omega, regime=tuple(r for part in parts for r in part.regime), **arrays)


def _one_frequency(omegas: Array) -> float:
    if omegas.size == 0:
        raise ValueError("there are no responses: give at least one")
    if np.any(omegas != omegas[0]):
        raise ValueError(
            f"features belong to one frequency, got ω = {sorted(set(omegas.tolist()))} rad/s"
        )
    return float(omegas[0])
