"""Features of responses: all that the estimators use (Tables 1 and 2).

`of_orbit` computes them from an exact orbit, `of_orbits` from many; `replication/clean.py` reads them off a sampled
record; `stack` joins responses. A feature that does not exist (nothing slips, or there is no single slip onset) is NaN,
and `regime` says why.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, get_args, get_type_hints

import numpy as np
from numpy.typing import ArrayLike

from .arguments import floats, one_of
from .arguments import names as names_of
from .arrays import Array, ReadOnly, Words
from .motion.orbit import Orbit
from .motion.orbits import Orbits
from .motion.regime import Regime

if TYPE_CHECKING:
    import pandas as pd

PhaseKind = Literal["reversal", "zero_crossing", "fundamental"]

Metres = Annotated[Array, "m"]
Radians = Annotated[Array, "rad"]
Seconds = Annotated[Array, "s"]
Speeds = Annotated[Array, "m_per_s"]

_REGIME = "regime"
_AT_ONSET = ("V_s", "t_s", "V_r", "t_r")  # zero where the contact is rigid


@dataclass(frozen=True, eq=False)
class Features:
    """The features of steady responses from which each approach forms its rows of the energy balance.

    Use `to_frame` for a table of them. All are read-only arrays of one shape in SI units, NaN where a feature does not
    exist. The first axis counts the levels (or records) that are solved together, further axes cases or replicates. A
    value with fewer axes is broadcast to the shape of Y.

    omega : drive frequency ω, rad/s.
    Y : amplitude of the base, m.   X : peak displacement, m.
    X_s, V_s : displacement (m, negative) and velocity (m/s) at forward slip onset.
    t_s : time from the velocity reversal at −X to that onset, s (as in Eqs. 17 and 18).
    phi : lag of x behind y that the balance uses, rad: one of the next three, see `with_phase`.
    phi_reversal : lag of the velocity reversal at +X behind the peak of y.   phi_zero_crossing : lag of the upward zero
    crossing of x behind that of y.   phi_fundamental : lag of the fundamental of x behind y.
    X_r, V_r, t_r : the mirror image at reverse slip onset; X_r > 0, V_r < 0, t_r from the reversal at +X.
    X_1, X_3, X_5 : amplitudes of the harmonics of x, m.
    a, b, W : friction travel (m), viscous integral (m²/s), input work (J) per cycle by direct integration, (5), (7).
    regime : kind of each response, or why a feature is missing, in words.
    integrals : symbol of a further term of a law → its integral over a period (`law/terms.py`), where it was computed.

    Raises ValueError naming the field whose shape does not fit.
    """

    omega: Annotated[Array, "rad_per_s"]
    Y: Metres
    X: Metres
    X_s: Metres
    V_s: Speeds
    t_s: Seconds
    phi: Radians
    phi_reversal: Radians
    phi_zero_crossing: Radians
    phi_fundamental: Radians
    X_r: Metres
    V_r: Speeds
    t_r: Seconds
    X_1: Metres
    X_3: Metres
    X_5: Metres
    a: Metres
    b: Annotated[Array, "m2_per_s"]
    W: Annotated[Array, "J"]
    regime: Words
    integrals: Mapping[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        shape = floats(self.Y).shape
        for name in _FIELDS:
            kind = object if name == _REGIME else np.float64
            object.__setattr__(self, name, _fitted(name, getattr(self, name), kind, shape))
        if self.integrals:
            fitted = {s: _fitted(s, g, np.float64, shape) for s, g in self.integrals.items()}
            object.__setattr__(self, "integrals", ReadOnly(fitted))

    def __len__(self) -> int:
        return len(self.Y)

    def replaced(self, **values: ArrayLike) -> Self:
        """Return a copy with the features that are given by name replaced; values are broadcast to the shape of Y."""
        unknown = sorted(set(values) - set(FEATURE_COLUMNS))
        if unknown:
            raise ValueError(f"unknown features {unknown}; known are {list(FEATURE_COLUMNS)}")
        return replace(self, **values)  # type: ignore[arg-type]

    def with_phase(self, phase: str) -> Self:
        """Return a copy whose `phi` is the phase named: "reversal", "zero_crossing" or "fundamental"."""
        kind = one_of("phase", phase, get_args(PhaseKind))
        return self.replaced(phi=getattr(self, f"phi_{kind}"))

    def with_common(self, *names: str) -> Self:
        """Return a copy in which each feature named is its mean over the levels that have it, case by case.

        `with_common("phi", "t_s")` gives the common phase and slip time of Eqs. (16), (18), (19). A feature that is NaN
        stays NaN.
        """
        common = {}
        for name in names_of("features", names, FEATURE_COLUMNS):
            values = getattr(self, name)
            exists = np.isfinite(values)
            with np.errstate(invalid="ignore"):  # no level has it: NaN
                mean = np.sum(np.where(exists, values, 0.0), axis=0) / np.sum(exists, axis=0)
            common[name] = np.where(exists, mean, np.nan)
        return self.replaced(**common)

    def rigid(self) -> Self:
        """Return a copy for a model with a rigid contact: X_s = −X, V_s = 0, t_s = 0, so that a = 4X.

        This is the limit of every approach; the motion itself (X, φ, b, W) stays. For a compliant contact
        a = 4X − 4Z_m: the rigid model overestimates a by 4Z_m.
        """
        X, none = self.X, 0.0 * self.X
        return self.replaced(X_s=-X, X_r=X, a=4.0 * X, **dict.fromkeys(_AT_ONSET, none))

    def __getitem__(self, index: Any) -> Self:
        """Return the responses at `index`, as in NumPy: [[1, 0]] selects two levels in that order, [:, i] one case."""
        return replace(
            self,
            **{name: getattr(self, name)[index] for name in _FIELDS},
            integrals={symbol: g[index] for symbol, g in self.integrals.items()},
        )

    def to_columns(self) -> dict[str, Any]:
        """Return the features by name of their column (`FEATURE_COLUMNS`), ω first and the regime last."""
        columns = {column: getattr(self, name) for name, column in _COLUMNS.items()}
        return {**columns, _REGIME: list(self.regime)}

    def to_frame(self) -> pd.DataFrame:
        """Return a table with a row per response and the columns of `to_columns`."""
        import pandas as pd  # slow to import, and needed for tables only

        return pd.DataFrame(self.to_columns())

    @classmethod
    def from_frame(cls, frame: pd.DataFrame) -> Self:
        """Return the features of a table as `to_frame` makes it. Raises ValueError for a missing column or no row."""
        if missing := [c for c in (*_COLUMNS.values(), _REGIME) if c not in frame.columns]:
            found = list(frame.columns)
            raise ValueError(f"a table of features needs the columns {missing}, found {found}")
        if frame.empty:
            raise ValueError("there are no responses: give at least one")
        values: Any = {name: frame[col].to_numpy(np.float64) for name, col in _COLUMNS.items()}
        return cls(regime=frame[_REGIME].to_numpy(dtype=object), **values)


_COLUMNS = {
    name: f"{name}_{kind.__metadata__[0]}"
    for name, kind in get_type_hints(Features, include_extras=True).items()
    if hasattr(kind, "__metadata__")
}
FEATURE_COLUMNS = {name: column for name, column in _COLUMNS.items() if name != "omega"}
"""Column of a data frame that holds each feature, named with its unit."""

_FIELDS = (*_COLUMNS, _REGIME)


def _fitted(name: str, given: Any, kind: Any, shape: tuple[int, ...]) -> Any:
    """Return values as a read-only array of that shape."""
    try:
        if type(given) is np.ndarray and given.dtype == kind:  # nearly always
            values = given
        else:
            values = np.asarray(given, dtype=kind) if kind is object else floats(given)
    except ValueError as error:
        raise ValueError(
            f"Features.{name} must hold numbers, NaN where there is none, not {error}"
        ) from None
    if values.shape == shape:  # three times faster than broadcasting
        values = values.view()
        values.flags.writeable = False
        return values
    try:
        return np.broadcast_to(values, shape)  # read-only
    except ValueError:
        raise ValueError(f"Features.{name} has shape {values.shape}, Y has {shape}") from None


def of_orbit(orbit: Orbit) -> Features:
    """Return the features of one steady orbit, exact to rounding.

    The orbit is symmetric, x(t + T/2) = −x(t), so that reverse slip is the mirror image of forward slip.
    """
    amplitudes, lags = zip(*map(orbit.harmonic, (1, 3, 5)), strict=True)
    Y, omega = np.array([orbit.motion.Y]), orbit.motion.omega
    return _of_either(orbit, omega, Y, str(orbit.regime), lags[0], amplitudes)


def of_orbits(orbits: Orbits, Y: Array, omega: Array) -> Features:
    """Return the features of many steady orbits.   Y : m, omega : rad/s, of shapes that broadcast to that of the
    orbits."""
    words = np.array([str(regime) for regime in Regime], dtype=object)
    amplitudes = orbits.X_1, orbits.X_3, orbits.X_5
    Y = np.broadcast_to(Y, orbits.X.shape)
    return _of_either(orbits, omega, Y, words[orbits.regime], orbits.phi_1, amplitudes)


def _of_either(
    orbit: Any, omega: Any, Y: Array, regime: Any, lag: Any, amplitudes: Sequence[Any]
) -> Features:
    """Return the features of an `Orbit` or of `Orbits`.   lag : of the fundamental, rad.   amplitudes : of harmonics 1,
    3 and 5, m."""
    names = ("X", "X_s", "V_s", "t_s", "phi", "phi_zero_crossing", "a", "b", "W")
    return Features(
        omega=omega,
        Y=Y,
        regime=regime,
        **{name: getattr(orbit, name) for name in names},
        X_r=-orbit.X_s,
        V_r=-orbit.V_s,
        t_r=orbit.t_s,
        phi_reversal=orbit.phi,
        phi_fundamental=wrapped_phase(lag),
        **dict(zip(("X_1", "X_3", "X_5"), amplitudes, strict=True)),
    )


def of_numbers(omega: ArrayLike, regime: ArrayLike, **numbers: Any) -> Features:
    """Return features from values by name, of one response or arrays; those that are not given are NaN."""
    values: dict[str, Any] = dict.fromkeys(FEATURE_COLUMNS, np.nan) | numbers
    values["Y"] = np.atleast_1d(np.asarray(values["Y"], dtype=np.float64))
    return Features(omega=omega, regime=regime, **values)  # type: ignore[arg-type]


def wrapped_phase(angle: ArrayLike) -> Array:
    """Return angles modulo 2π, rad, in [−π/2, 3π/2), so that lags near 0 and near π both lie well inside."""
    return np.asarray((np.asarray(angle) + 0.5 * np.pi) % (2.0 * np.pi) - 0.5 * np.pi)


def side_by_side(parts: Sequence[Features]) -> Features:
    """Return parts of shape (n,) side by side as cases, shape (n, number of parts)."""
    return _stacked(parts, partial(np.stack, axis=1))


def stack(parts: Sequence[Features]) -> Features:
    """Return the responses of all parts, in order, as levels. Raises ValueError if there are none."""
    if not parts:
        raise ValueError("there are no responses: give at least one")
    return _stacked(parts, np.concatenate)


def _stacked(parts: Sequence[Features], join: Callable[..., Any]) -> Features:
    """Return the joined arrays of all parts, with the integrals that every part has."""
    shared = [s for s in parts[0].integrals if all(s in part.integrals for part in parts)]
    return Features(
        **{name: join([getattr(part, name) for part in parts]) for name in _FIELDS},
        integrals={s: join([part.integrals[s] for part in parts]) for s in shared},
    )
