"""How the authors obtained their numbers, as far as the printed digits show.

    simulate_levels   the equation of motion divided by m, its coefficients rounded, by a scheme of fixed step
    read_levels       a, b and W at the samples, all else between them, then as it was written down (`ReadOut`)
    estimates         Table 3 with the slip of sign in its V_s columns
    scheme_table      the integrals of Table 2 by every other scheme: if the numbers singled out backward Euler on
                      rounded coefficients only because nothing else was tried, they would prove little

Scheme, step, cycle, decimals and rules of reading come from the configuration. They were chosen with the printed digits
in view (`config/README.md` says which by which); no printed number itself is read here. The printed features are not
all rounded values of their simulation; some carry the mark of how they were read. Each rule of reading is stated
without reference to any printed number, and each can be left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple, Self, cast

import numpy as np

from ..arrays import Array
from ..balance import APPROACHES, TERMS, Approach, direct, slip_velocity, slip_velocity_as_printed
from ..estimates import estimate_table
from ..features import Features, Phase, of_numbers, stack
from ..motion.fixed_step import SCHEMES, simulate
from ..project.case import Case
from ..reading.clean import CYCLES_TO_READ, ReadAt, of_record
from ..record import Record
from ..solver import least_squares

if TYPE_CHECKING:
    import pandas as pd

# A reading is divided by its unit in binary: what lies this close to a whole number of units is that number.
_WHOLE = 1e-9


@dataclass(frozen=True, slots=True)
class ReadOut:
    """Rules by which features are read; a rule that is None is not applied. SI units.

    X_decimals, X_s_decimals, V_s_decimals, phi_decimals : decimals kept in m, m, m/s, rad, rounded to nearest.
    X_n_decimals : decimals kept of the amplitudes X_1, X_3, X_5 of the harmonics, m.
    X_s_mark : m. Instead of rounding X_s: the length X + X_s of the microstick line in whole marks of the axis, up to
    the first mark beyond the corner, taken off the X that was read. (With marks of 1 µm, 12.3 µm read 13 µm.)
    t_s_inset : s, taken off t_s: timed from the first sample inside the microstick phase to the last one inside it, the
    phase is shorter than from reversal to slip, by one step at each end.
    t_s_unit : s. t_s in whole units that fit, as on a display that drops what follows (with 0.1 ms, 2.98 reads 2.9).
    common_phi_decimals, common_t_s_decimals : decimals of the means that stand for φ (rad), t_s (s) in Eqs. (16)–(19).

    The reverse-slip readings X_r, V_r, t_r follow the rules of X_s, V_s, t_s. Raises ValueError naming the rule.
    """

    X_decimals: int | None = None
    X_n_decimals: int | None = None
    X_s_decimals: int | None = None
    X_s_mark: float | None = None
    V_s_decimals: int | None = None
    phi_decimals: int | None = None
    t_s_inset: float = 0.0
    t_s_unit: float | None = None
    common_phi_decimals: int | None = None
    common_t_s_decimals: int | None = None

    def __post_init__(self) -> None:
        for name in self.__slots__:
            value = getattr(self, name)
            if value is not None and not 0 <= value < math.inf:
                raise ValueError(f"ReadOut.{name} must not be negative, got {value!r}")
        for name in ("X_s_mark", "t_s_unit"):
            if getattr(self, name) == 0.0:
                raise ValueError(f"ReadOut.{name} must be positive, or None for no such rule")
        if self.X_s_mark is not None and self.X_s_decimals is not None:
            raise ValueError("ReadOut: give X_s_mark or X_s_decimals, not both")

    @classmethod
    def from_config(cls, section: Mapping[str, Any]) -> Self:
        """The rules of a section of the configuration, whose keys carry their units; null is no rule."""
        rules = {key: value for key, value in section.items() if value is not None}
        return cls(**{key.removesuffix("_m").removesuffix("_s"): v for key, v in rules.items()})

    def apply(self, features: Features) -> Features:
        """The features as read, each response by itself."""
        X = _rounded(features.X, self.X_decimals)
        phases = ("phi", "phi_reversal", "phi_zero_crossing", "phi_fundamental")
        amplitudes = ("X_1", "X_3", "X_5")

        def slip(at: Array) -> Array:
            """|X_s| as read: by its mark, counted from the peak, or rounded."""
            if self.X_s_mark is None:
                return _rounded(at, self.X_s_decimals)
            return X - np.ceil((features.X - at) / self.X_s_mark - _WHOLE) * self.X_s_mark

        def time(t: Array) -> Array:
            inside, unit = t - self.t_s_inset, self.t_s_unit
            return inside if unit is None else np.floor(inside / unit + _WHOLE) * unit

        return features.replaced(
            X=X,
            X_s=-slip(-features.X_s),
            X_r=slip(features.X_r),
            V_s=_rounded(features.V_s, self.V_s_decimals),
            V_r=_rounded(features.V_r, self.V_s_decimals),
            t_s=time(features.t_s),
            t_r=time(features.t_r),
            **{name: _rounded(getattr(features, name), self.phi_decimals) for name in phases},
            **{name: _rounded(getattr(features, name), self.X_n_decimals) for name in amplitudes},
        )

    def common(self, features: Features) -> Features:
        """The features as read, with the rounded means of φ and t_s in place of the individual ones."""
        shared = self.apply(features).with_common("phi", "t_s")
        return shared.replaced(
            phi=_rounded(shared.phi, self.common_phi_decimals),
            t_s=_rounded(shared.t_s, self.common_t_s_decimals),
        )


def _rounded(values: Array, decimals: int | None) -> Array:
    return values if decimals is None else np.round(values, decimals)


CORRECTED = "V_s with minus"
"""The V_s pairs as (19) states them."""

APPROACHES_OF_TABLE_3: dict[str, Approach] = {
    "X_s": APPROACHES["X_s"],
    "t_s": APPROACHES["t_s"],
    "V_s": Approach(slip_velocity_as_printed, "V_s with plus"),
    CORRECTED: Approach(slip_velocity, CORRECTED),
}
"""The rows behind the printed Table 3: the V_s pairs with their slip of sign, and for comparison those without it."""


SLIPPING_SAMPLE = "V_s_at_sample_m_per_s"
"""The column of the velocity of the first slipping sample, at which V_s was read."""


class ReadFeatures(NamedTuple):
    """Features as the authors wrote them down.

    tabulated : for Table 1 and the least squares.   two_point : with one φ and one t_s, for the formulas of Table 3.
    unrounded : what both were read from, in full digits.
    slipping_sample : the velocity of the first sample that slips, m/s.
    """

    tabulated: Features
    two_point: Features
    unrounded: Features
    slipping_sample: Array

    def to_frame(self) -> pd.DataFrame:
        """The unrounded features, a row per level: the columns of `Features.to_frame` and SLIPPING_SAMPLE."""
        return self.unrounded.to_frame().assign(**{SLIPPING_SAMPLE: self.slipping_sample})


def coefficients(case: Case) -> dict[str, float]:
    """c_over_m (1/s) and k_over_m (1/s²) with the decimals that the authors' program kept, as `simulate` takes them."""
    osc, numerics = case.oscillator, case.numerics
    ratios = {
        "c_over_m": (osc.c / osc.m, numerics.c_over_m_decimals),
        "k_over_m": (osc.k / osc.m, numerics.k_over_m_decimals),
    }
    return {name: v if kept is None else round(v, kept) for name, (v, kept) in ratios.items()}


def added_damping(case: Case, omega: float) -> float:
    """The damping mω²h, N s/m, that backward Euler adds to c near resonance.   omega : rad/s."""
    return case.oscillator.m * omega**2 * case.numerics.step_s


def simulate_levels(case: Case, frequency: str, keep_cycles: int = CYCLES_TO_READ) -> list[Record]:
    """The last cycles of the simulated response to each level."""
    return [
        simulate(
            case.oscillator,
            motion,
            scheme=case.numerics.scheme,
            step=case.numerics.step_s,
            cycles=case.numerics.cycles,
            keep_cycles=keep_cycles,
            stick_samples=0,  # of the steady stick phases, `check_feasible` has seen to it
            **coefficients(case),
        )
        for motion in case.motions(frequency)
    ]


def features_of(records: Sequence[Record], case: Case, frequency: str, reading: ReadAt) -> Features:
    """Features read off the records of all levels, in full digits; a record that cannot be read says why."""
    omega, k = case.omega(frequency), case.oscillator.k
    features = []
    for level, record in enumerate(records):
        try:
            features.append(of_record(record, omega, k, reading, case.numerics.after_slip(level)))
        except ValueError as error:
            Y = float(np.max(np.abs(record.y)))
            features.append(of_numbers(omega, f"not read: {error}", Y=Y))
    return stack(features)


def read_levels(records: Sequence[Record], case: Case, frequency: str) -> ReadFeatures:
    """Features off the records of all levels by the rules `tabulated` and `two_point`; a, b and W at the samples."""
    sampled = features_of(records, case, frequency, "sample")
    integrals = {name: getattr(sampled, name) for name in ("a", "b", "W")}
    between = features_of(records, case, frequency, "interpolated")
    between = between.with_phase(cast(Phase, case.phase)).replaced(**integrals)
    tabulated, two_point = (
        ReadOut.from_config(rules) for rules in (case.numerics.tabulated, case.numerics.two_point)
    )
    return ReadFeatures(tabulated.apply(between), two_point.common(between), between, sampled.V_s)


def estimates(tabulated: Features, two_point: Features, case: Case) -> pd.DataFrame:
    """The table of estimates: `tabulated` by every approach, `two_point` by those of Table 3."""
    return estimate_table(
        tabulated,
        case.oscillator.k,
        case.pairs,
        common=two_point,
        common_approaches=APPROACHES_OF_TABLE_3,
    )


_CYCLES = 12
"""Steady cycles in which a is read: a period is no whole number of steps, so that each samples the motion elsewhere."""


def scheme_table(case: Case, frequency: str) -> pd.DataFrame:
    """a, b, W of every scheme on rounded and on exact coefficients c/m, k/m, and the F_k, c they give together.

    One row per scheme, coefficients ("rounded" or "exact") and level; F_k_N and c_N_s_per_m (least squares of the
    levels) are the same in the rows of one simulation.
    """
    exact = replace(case.numerics, c_over_m_decimals=None, k_over_m_decimals=None)
    tables: list[dict[str, Any]] = []
    for scheme in SCHEMES:
        for coefficients, numerics in (("rounded", case.numerics), ("exact", exact)):
            tried = replace(case, numerics=replace(numerics, scheme=scheme))
            read = features_of(simulate_levels(tried, frequency), tried, frequency, "sample")
            estimate = least_squares(direct(read, case.oscillator.k))
            which = {"scheme": scheme, "coefficients": coefficients, "level": _levels(read)}
            numbers = {"a_m": read.a, "b_m2_per_s": read.b, "W_J": read.W}
            fitted = {term.column: float(estimate[s]) for s, term in TERMS.items()}
            tables.append(which | numbers | fitted)
    return _stacked(tables)


def cycle_table(case: Case, frequency: str) -> pd.DataFrame:
    """a (m) and V_s (m/s) of the as-published simulation in each of its last steady cycles.

    One row per cycle, the last one first, and level. Which cycle the authors integrated decides where the samples fall;
    what the printed a say of the step must therefore hold in all of them.
    """
    kept = min(_CYCLES + CYCLES_TO_READ - 1, case.numerics.cycles)
    records = simulate_levels(case, frequency, keep_cycles=kept)
    period = 2.0 * math.pi / case.omega(frequency) / case.numerics.step_s  # in steps
    length = math.ceil(CYCLES_TO_READ * period) + 1
    tables: list[dict[str, Any]] = []
    for cycle in range(kept - CYCLES_TO_READ + 1):
        ends = [len(record) - round(cycle * period) for record in records]
        parts = [r.samples(max(end - length, 0), end) for r, end in zip(records, ends, strict=True)]
        read = features_of(parts, case, frequency, "sample")
        which = {"cycle": -cycle, "level": _levels(read)}
        tables.append(which | {"a_m": read.a, "V_s_m_per_s": read.V_s})
    return _stacked(tables)


def _levels(features: Features) -> range:
    return range(1, len(features) + 1)


def _stacked(tables: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    import pandas as pd  # slow to import, and needed for tables only

    return pd.concat(map(pd.DataFrame, tables), ignore_index=True)
