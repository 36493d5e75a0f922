"""How the authors obtained their numbers, as far as the printed digits show.

    simulate_levels   the equation of motion divided by m, its coefficients rounded, by a scheme of fixed step
    read_levels       a, b and W at the samples, all else between them, then as it was written down
    estimates         Table 3 with the slip of sign in its V_s columns

Scheme, step, cycle, decimals and rules of reading come from the configuration. They were chosen with the printed digits
in view (`config/README.md` says which by which); no printed number itself is read here.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from ..arrays import Array
from ..balance import APPROACHES, Approach, slip_velocity, slip_velocity_as_printed
from ..estimates import estimate_table
from ..features import Features, Phase, of_numbers, stack
from ..motion.fixed_step import simulate
from ..project.case import Case
from ..reading.clean import CYCLES_TO_READ, ReadAt, of_record
from ..record import Record
from .readout import ReadOut

if TYPE_CHECKING:
    import pandas as pd

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
