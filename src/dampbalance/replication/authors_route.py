"""The route by which the authors obtained their numbers, as far as the printed digits show it.

    simulate_levels   the equation of motion divided by m, its coefficients rounded, by a scheme of fixed step
    read_levels       a, b and W at the samples, everything else between them, then read as for the paper (`ReadOut`)
    estimates         Table 3 with the slip of sign in its V_s columns
    scheme_table      the integrals of Table 2 by every other scheme and way of rounding, and by the exact solver with
                      the damping of the simulation put in by hand: W and b follow from it, whatever causes it
    trial_table       a in many cycles, by the simulation and its rivals: only for the right one do the printed a of
                      all levels belong to one sampling instant

Scheme, step, cycle, decimals and rules of reading come from the configuration. They were chosen with the printed digits
in view (`config/README.md` says which by which); no printed number itself is read here. Not all printed features are
rounded values of the simulation: some show how they were read. Each rule of reading is stated without reference to any
printed number, and each can be left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from ..arrays import Array
from ..balance import APPROACHES, TERMS, Approach, direct, slip_velocity, slip_velocity_as_printed
from ..estimates import estimate_table
from ..features import Features, PhaseKind, of_numbers, of_orbit, stack
from ..motion.orbit import steady_orbit
from ..project.case import Case
from ..solver import least_squares
from .clean import CYCLES_TO_READ, ReadAt, of_record
from .fixed_step import SCHEMES, simulate
from .read_out import ReadOut
from .record import SimulatedRecord
from .sampled import Cycle, read_cycle

if TYPE_CHECKING:
    import pandas as pd

CORRECTED = "V_s with minus"
"""The V_s pairs as (19) states them."""

APPROACHES_OF_TABLE_3: dict[str, Approach] = {
    "X_s": APPROACHES["X_s"],
    "t_s": APPROACHES["t_s"],
    "V_s": Approach("V_s", slip_velocity_as_printed, "V_s with plus", takes_phase=True),
    CORRECTED: Approach(CORRECTED, slip_velocity, takes_phase=True),
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
        """Return the unrounded features, a row per level: the columns of `Features.to_frame` and SLIPPING_SAMPLE."""
        return self.unrounded.to_frame().assign(**{SLIPPING_SAMPLE: self.slipping_sample})


def printed_coefficients(case: Case) -> dict[str, float]:
    """Return c_over_m (1/s) and k_over_m (1/s²) with the decimals that the authors' program kept."""
    osc, numerics = case.oscillator, case.numerics
    ratios = {
        "c_over_m": (osc.c / osc.m, numerics.c_over_m_decimals),
        "k_over_m": (osc.k / osc.m, numerics.k_over_m_decimals),
    }
    return {name: v if kept is None else round(v, kept) for name, (v, kept) in ratios.items()}


def added_damping(case: Case, omega: float) -> float:
    """Return the damping mω²h, N s/m, that backward Euler adds to c near resonance.   omega : rad/s."""
    return case.oscillator.m * omega**2 * case.numerics.step_s


def effective_damping(case: Case, omega: float) -> float:
    """Return the damping that the simulated motion shows near resonance, N s/m: m (c/m) as rounded plus d mω²h.

    d : `Scheme.dissipation`, 1 for backward Euler.   omega : rad/s.
    """
    added = SCHEMES[case.numerics.scheme].dissipation * added_damping(case, omega)
    return case.oscillator.m * printed_coefficients(case)["c_over_m"] + added


def simulate_levels(
    case: Case, frequency: str, keep_cycles: int = CYCLES_TO_READ
) -> list[SimulatedRecord]:
    """Return the last cycles of the simulated response to each level."""
    return [
        simulate(
            case.oscillator,
            motion,
            scheme=case.numerics.scheme,
            step=case.numerics.step_s,
            cycles=case.numerics.cycles,
            keep_cycles=keep_cycles,
            stick_samples=0,  # `check_feasible` has counted the samples of steady stick phases
            **printed_coefficients(case),
        )
        for motion in case.motions(frequency)
    ]


def features_of(
    records: Sequence[SimulatedRecord], case: Case, frequency: str, reading: ReadAt
) -> Features:
    """Read features off the records of all levels, in full digits; the regime of an unreadable record says why."""
    omega, k = case.omega(frequency), case.oscillator.k
    features = []
    for level, record in enumerate(records):
        try:
            features.append(of_record(record, omega, k, reading, case.numerics.after_slip(level)))
        except ValueError as error:
            Y = float(np.max(np.abs(record.y)))
            features.append(of_numbers(omega, f"not read: {error}", Y=Y))
    return stack(features)


def read_levels(records: Sequence[SimulatedRecord], case: Case, frequency: str) -> ReadFeatures:
    """Read features of all levels by the rules `tabulated` and `two_point`; a, b and W at the samples."""
    sampled = features_of(records, case, frequency, "sample")
    integrals = {name: getattr(sampled, name) for name in ("a", "b", "W")}
    between = features_of(records, case, frequency, "interpolated")
    between = between.with_phase(cast(PhaseKind, case.phase)).replaced(**integrals)
    tabulated, two_point = (
        ReadOut.from_config(rules) for rules in (case.numerics.tabulated, case.numerics.two_point)
    )
    return ReadFeatures(tabulated.apply(between), two_point.common(between), between, sampled.V_s)


def estimates(tabulated: Features, two_point: Features, case: Case) -> pd.DataFrame:
    """Return the table of estimates: `tabulated` by every approach, `two_point` by those of Table 3."""
    return estimate_table(
        tabulated,
        case.oscillator.k,
        case.pairs,
        common=two_point,
        common_approaches=tuple(APPROACHES_OF_TABLE_3.values()),
    )


_CYCLES = 12
"""Steady cycles in which a is read: a period is not a whole number of steps, so that each has other samples."""

_C_DECIMALS = 4
"""Decimals of a damping coefficient entered by hand, N s/m: those of the printed c, for a reader to enter the same."""

_UNROUNDED: dict[str, tuple[str, ...]] = {
    "rounded": (),
    "c_over_m": ("k_over_m_decimals",),
    "exact": ("c_over_m_decimals", "k_over_m_decimals"),
}
"""Way of rounding → the coefficients that keep all their digits: both are rounded, c/m alone is, or neither is."""


def _with_coefficients(case: Case, rounding: str, **numerics: Any) -> Case:
    """Return the case with its coefficients rounded in another way, and with these fields of its numerics."""
    changed = numerics | dict.fromkeys(_UNROUNDED[rounding])
    return replace(case, numerics=replace(case.numerics, **changed))


def damping_by_hand(case: Case, frequency: str) -> float:
    """Return the `effective_damping`, N s/m, with the decimals that a reader would type."""
    return round(effective_damping(case, case.omega(frequency)), _C_DECIMALS)


def _read_cycles(
    records: Sequence[SimulatedRecord], case: Case, frequency: str, cycle: int, between: bool
) -> list[Cycle]:
    """Read one steady cycle of each record, without the harmonics, which take most of the time of `features_of`.

    cycle : how many periods before the last whole cycle of the records.
    between : whether events are located between samples.
    """
    omega, k = case.omega(frequency), case.oscillator.k
    read = []
    for level, record in enumerate(records):
        period = 2.0 * math.pi / (omega * case.numerics.step_s)  # steps in a period
        end = len(record) - round(cycle * period)
        kept = slice(max(end - math.ceil(CYCLES_TO_READ * period) - 1, 0), end)
        cut, t0 = np.ascontiguousarray(record.signals[:, kept]), float(record.t[kept.start])
        after = case.numerics.after_slip(level)
        read.append(read_cycle(cut, t0, record.dt, omega, k, between, after))
    return read


def _at_samples(records: Sequence[SimulatedRecord], case: Case, frequency: str) -> Features:
    """Read a, b and W of the last cycle at the samples."""
    omega, read = case.omega(frequency), _read_cycles(records, case, frequency, 0, between=False)
    return stack([of_numbers(omega, "", a=of.a, b=of.b, W=of.W) for of in read])


def scheme_table(case: Case, frequency: str) -> pd.DataFrame:
    """Tabulate a, b, W of every scheme and of the exact solver, and the F_k, c that they give together.

    One row per scheme, coefficients and level. Coefficients c/m and k/m are "rounded", "exact" (neither is rounded)
    or, by the configured scheme and by Runge–Kutta, "c_over_m" (c/m alone is). The scheme "exact" is the exact solver
    with c `by_hand`. F_k_N and c_N_s_per_m (least squares of the levels) are the same in the rows of one simulation.
    """
    k = case.oscillator.k
    tables: list[dict[str, Any]] = []

    def add(scheme: str, coefficients: str, read: Features) -> None:
        estimate = least_squares(direct(read, k))
        which = {"scheme": scheme, "coefficients": coefficients, "level": range(1, len(read) + 1)}
        numbers = {"a_m": read.a, "b_m2_per_s": read.b, "W_J": read.W}
        tables.append(which | numbers | {t.column: float(estimate[s]) for s, t in TERMS.items()})

    for scheme in SCHEMES:
        for rounding in _UNROUNDED:
            if rounding != "c_over_m" or scheme in (case.numerics.scheme, "rk4"):
                tried = _with_coefficients(case, rounding, scheme=scheme)
                add(
                    scheme,
                    rounding,
                    _at_samples(simulate_levels(tried, frequency), case, frequency),
                )
    damped = replace(case.oscillator, c=damping_by_hand(case, frequency))
    orbits = [steady_orbit(damped, motion) for motion in case.motions(frequency)]
    add("exact", "by_hand", stack([of_orbit(orbit) for orbit in orbits]))
    return _stacked(tables)


def cycle_table(case: Case, frequency: str, count: int = _CYCLES) -> pd.DataFrame:
    """Tabulate a (m), V_s (m/s) and W (J) of the as-published simulation in each of its last steady cycles.

    One row per cycle, the last one first, and level. Which cycle the authors integrated decides where the samples fall;
    what the printed a say of the step must therefore hold in all of them. The column onset_steps says where they fall:
    how many steps, not whole, pass from the onset of slip to the sample at which it is detected.

    count : the number of cycles to read, less if fewer are simulated.
    """
    kept = min(count + CYCLES_TO_READ - 1, case.numerics.cycles)
    records = simulate_levels(case, frequency, keep_cycles=kept)
    tables: list[dict[str, Any]] = []
    for cycle in range(kept - CYCLES_TO_READ + 1):
        read, exactly = (
            _read_cycles(records, case, frequency, cycle, between) for between in (False, True)
        )
        tables += [
            {
                "cycle": [-cycle],
                "level": level,
                "a_m": at.a,
                "V_s_m_per_s": at.V_s,
                "W_J": at.W,
                "onset_steps": at.start - of.start + (at.t_s - of.t_s) / case.numerics.step_s,
            }
            for level, (at, of) in enumerate(zip(read, exactly, strict=True), 1)
        ]
    return _stacked(tables)


_OTHER_STEPS = (0.4, 0.6, 0.8, 1.2, 1.4, 1.6, 1.8, 2.0, 2.4)
"""Other steps of the trapezoidal rule, multiples of the configured one (Runge–Kutta gives the same to 1e-4 steps)."""
_OTHER_DAMPING = (-5e-4, -4e-4, -3e-4, -2e-4, -1e-4, 1e-4)
"""Further damping entered by hand, N s/m above `damping_by_hand`: around that with which the instants agree best."""
_STEPS_OF_W = {"c_over_m": 1.003, "exact": 0.986}
"""Way of rounding → the step at which W agrees as well (`step_from_W` of the article), a multiple of the configured."""


def trials(case: Case, frequency: str) -> Iterator[tuple[str, Case]]:
    """Yield every rival of the as-published simulation, as (name of the trial, case).

    rounding_c_over_m, rounding_exact : the coefficients rounded in another way.
    step_of_W_c_over_m, step_of_W_exact : likewise, with the step that compensates for it in W.
    by_hand : schemes that add no damping, with c `damping_by_hand`.
    other_steps, other_damping : the trapezoidal rule with other steps, and with other c.
    by_hand_unrounded : the trapezoidal rule with c `damping_by_hand` and all digits of k/m.
    by_hand_k : likewise, with k/m rounded or not, and with the cω²h/2 that backward Euler adds to k as well.
    semi_implicit, explicit : the other Euler schemes, with k/m rounded or not and the c that makes their motion as
    damped as the simulated one: `damping_by_hand`, and mω²h more for explicit Euler, which takes as much away.
    """
    numerics, c = case.numerics, damping_by_hand(case, frequency)
    # a transient loses a factor of 40 in each period (ζ = 0.6): the first one read is steady
    few = {"cycles": min(numerics.cycles, 13)}
    for rounding, factor in _STEPS_OF_W.items():
        yield f"rounding_{rounding}", _with_coefficients(case, rounding, **few)
        other = {"step_s": factor * numerics.step_s}
        yield f"step_of_W_{rounding}", _with_coefficients(case, rounding, **few | other)

    def by_hand(scheme: str, factor: float = 1.0, more: float = 0.0, **other: Any) -> Case:
        changed: dict[str, Any] = {"scheme": scheme, "step_s": factor * numerics.step_s}
        changed |= few | {"c_over_m_decimals": None} | other
        damped = replace(case.oscillator, c=round(c + more, _C_DECIMALS))
        return replace(case, oscillator=damped, numerics=replace(numerics, **changed))

    for scheme in ("trapezoidal", "rk4"):
        yield "by_hand", by_hand(scheme)
    yield from (("other_steps", by_hand("trapezoidal", factor)) for factor in _OTHER_STEPS)
    yield from (("other_damping", by_hand("trapezoidal", more=more)) for more in _OTHER_DAMPING)
    added = added_damping(case, case.omega(frequency))
    unrounded: dict[str, Any] = {"k_over_m_decimals": None}
    yield "by_hand_unrounded", by_hand("trapezoidal", **unrounded)
    for of_k in ({}, unrounded):
        yield "by_hand_k", _stiffer(by_hand("trapezoidal", **of_k), frequency)
        yield "semi_implicit", by_hand("semi-implicit-euler", **of_k)
        yield "explicit", by_hand("explicit-euler", more=added, **of_k)


def _stiffer(case: Case, frequency: str) -> Case:
    """Return the case with the stiffness cω²h/2 that backward Euler adds, and the same drive kY."""
    osc, h = case.oscillator, case.numerics.step_s
    k = osc.k + 0.5 * osc.c * case.omega(frequency) ** 2 * h
    levels = tuple(Y * osc.k / k for Y in case.levels_m)
    return replace(case, oscillator=replace(osc, k=k), levels_m=levels)


def trial_table(case: Case, frequency: str) -> pd.DataFrame:
    """Return the `cycle_table` of the as-published simulation (trial "as_published") and of each of its rivals.

    Columns trial, scheme, step_s (s), c_N_s_per_m and k_over_m_per_s2 (as rounded) say which one a row belongs to.
    """
    tables: list[dict[Any, Any]] = []
    for trial, rival in (("as_published", case), *trials(case, frequency)):
        # three cycles of a rival show that its instants do not depend on the cycle
        count = _CYCLES if trial == "as_published" else 3
        which = {
            "trial": trial,
            "scheme": rival.numerics.scheme,
            "step_s": rival.numerics.step_s,
            "c_N_s_per_m": rival.oscillator.c,
            "k_over_m_per_s2": printed_coefficients(rival)["k_over_m"],
        }
        tables.append(which | dict(cycle_table(rival, frequency, count).items()))
    return _stacked(tables)


def _stacked(tables: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    import pandas as pd  # slow to import, and needed for tables only

    return pd.concat(map(pd.DataFrame, tables), ignore_index=True)
