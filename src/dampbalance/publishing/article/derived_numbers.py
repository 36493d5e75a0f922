"""Compute the numbers that the article argues with and no other result contains, each from the tables of results.

`derived_numbers` collects them in one nested dictionary, so that each has a place (a JSON pointer) in one file.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd

from ...balance import TERMS, viscous_integral
from ...estimates import estimate_table
from ...features import FEATURE_COLUMNS, Features
from ...figures.numerics import Damping, Evidence
from ...model import Oscillator
from ...project.case import Case
from ...project.files import ROUTES, plain
from ...replication import comparison
from ...replication.authors_route import (
    added_damping,
    damping_by_hand,
    effective_damping,
    printed_coefficients,
)
from ...replication.claims import evidence as proof
from ...replication.claims import unprinted
from ...replication.claims.verdicts import VERDICTS, counts
from ...replication.clean import CYCLES_TO_READ
from ...replication.numbers import (
    HARMONIC,
    TABLE_2,
    Key,
    Numbers,
    by_key,
    features_of,
    of_errors,
    of_estimates,
    select,
)
from ...replication.read_out import ReadOut
from ...solver import Pair

Json = dict[str, Any]

GLANCE = {
    "paper’s fit": "reversal",
    r"mean $\varphi$ (ours)": "mean",
    r"own $\varphi_1$": "fundamental",
    "Fourier balance": "fourier",
}
"""Label of the figure at a glance → its way of `comparison.WAYS_TO_COMPARE`. The fit with a mean φ is ours: the paper
takes that phase in its pairs, and each level's φ in its least squares."""


def derived_numbers(
    case: Case,
    numbers: pd.DataFrame,
    claims: pd.DataFrame,
    approaches: pd.DataFrame,
    schemes: pd.DataFrame,
    cycles: pd.DataFrame,
) -> Json:
    """Return all numbers of evidence.json, each group under the name of what it describes.

    numbers : of all routes, with what is printed (`numbers.with_claims`).   claims : the table of verdicts, as text.
    approaches, schemes, cycles : by `comparison.approaches_table`, `authors_route.scheme_table` and `trial_table`.

    None stands for a number that does not exist, such as the relative error of a true value of zero.
    """
    oscillator, pairs, rows = case.oscillator, case.pairs, by_key(numbers)

    def features_by(route: str, name: str) -> Features:
        return features_of(rows, route, name, case.omega(name))

    exact = {name: features_by("exact", name) for name in case.frequencies_hz}
    first, features_of_first = next(iter(exact.items()))
    terms = {name: balance_terms(of, oscillator) for name, of in exact.items()}
    errors = approaches.set_index("approach")
    rebuilt = features_by("as_published", first)
    per_sample = 2.0 * rebuilt.V_s * case.numerics.step_s  # of a, for one sample more
    added = added_damping(case, float(features_of_first.omega[0]))
    return plain(
        {
            "setting": setting(case, features_of_first),
            "verdicts": {
                count.key: {
                    **count.of_verdict,
                    "computed": count.computed,
                    "given": count.given,
                    "statement": count.statements,
                    "statements_held": count.statements_held,
                }
                for count in counts(claims)
            },
            "chance": proof.chance(claims),
            "routes": proof.by_route(claims),
            "choices": numbers_of_free_choices(case),
            "table_3": proof.inputs_of_table_3(case, rows),
            "unprinted": left_open(case, exact, rows),
            "recipe": recipe(case, features_of_first),
            # of backward Euler near resonance, where c, as rounded, acts as c + mω²h, N s/m
            "dissipation": {
                "added": added,
                "effective": effective_damping(case, float(features_of_first.omega[0])),
                "rounded": oscillator.m * printed_coefficients(case)["c_over_m"],
                "by_hand": damping_by_hand(case, first),
                "relative": added / oscillator.c if oscillator.c else math.nan,
            },
            "integrals": integral_deviations(features_of_first, rebuilt, numbers, schemes),
            "lock_in": {name: lock_in_errors(f, oscillator, pairs) for name, f in exact.items()},
            "fourier_largest": {
                term: errors.loc[["fourier"], f"{term}_largest_pair_error_percent"].max()
                for term in TERMS
            },
            "balance": terms,
            "causes": comparison.cause_shifts(approaches, case.frequencies_hz),
            "fundamental_work_largest": max(of["W_fundamental"]["max"] for of in terms.values()),
            "two_point_largest": {  # of the pairs by Table 3's formulas
                route: {
                    name: {term: rows[_two_point(name, term)][route] for term in TERMS}
                    for name in exact
                }
                for route in ROUTES
            },
            "direct_largest": {  # with exact features at any frequency, %
                term: errors.loc[["direct"]]
                .filter(regex=f"^{term}_.*error_percent$")
                .abs()
                .max(axis=None)
                for term in TERMS
            },
            # of the printed a from the rebuilt one, in samples of the instant at which slip is detected
            "slip_detected": _range((_printed(numbers, "a") - rebuilt.a) / per_sample),
            "step_from_W": step_from_work(numbers, schemes, case),
            "cycles": agreement_of_instants(sampling_instants(cycles, numbers), numbers),
            "vocabulary": {
                "verdicts": [asdict(verdict) for verdict in VERDICTS.values()],
                "ways": comparison.WAYS_TO_COMPARE,
            },
        }
    )


def setting(case: Case, first: Features) -> Json:
    """Describe the case: parameters, frequencies, levels, and the rounded coefficients of the equation divided by m."""
    osc, numerics = case.oscillator, case.numerics
    return {
        **asdict(osc),
        "zeta": osc.zeta,
        "natural_frequency_hz": osc.omega_n / (2.0 * math.pi),
        "swing_um": 2e6 * osc.Z_m,  # 2 Z_m
        "frequency_hz": dict(case.frequencies_hz),
        "levels_mm": (1e3 * first.Y).tolist(),
        "levels": len(first),
        "frequencies": len(case.frequencies_hz),
        "pairs": len(case.pairs),
        "scheme": numerics.scheme.replace("-", " ").replace("euler", "Euler"),
        "step_us": 1e6 * numerics.step_s,
        "cycles": numerics.cycles,
        "steps_per_cycle": round(2.0 * math.pi / float(first.omega[0]) / numerics.step_s),
        **printed_coefficients(case),
        "t_s_mean_ms": 1e3 * float(np.mean(first.t_s)),
        "phi_mean": float(np.mean(first.phi)),
    }


def recipe(case: Case, exact: Features) -> Json:
    """Return the numbers of the recipe for Table 3: how the responses at the first frequency are read.

    None stands for a rule that the case does not have.

    periods : number simulated before the cycle that is read.
    slip_samples : number of samples after the detection of slip at which a begins, level by level.
    X_um, mark_um : units to which X and X + X_s are read.   swing_um : X + X_s as read, if all levels agree.
    steps : number of steps subtracted from t_s.   t_s_unit_ms, t_s_ms : unit of t_s, and its value for all levels.
    phi, phi_decimals : the phase for all levels, rad, and its decimals.

    exact : features of the exact responses; read to such coarse units, those of the simulation give the same numbers.
    """
    numerics = case.numerics
    rules = ReadOut.from_config(numerics.two_point)
    common = rules.common(exact)
    swings = sorted({round(1e6 * swing, 6) for swing in (common.X + common.X_s).tolist()})
    return {
        "periods": numerics.cycles - CYCLES_TO_READ,
        "slip_samples": ", ".join(map(str, numerics.slip_samples)),
        "X_um": None if rules.X_decimals is None else 10.0 ** (6 - rules.X_decimals),
        "mark_um": None if rules.X_s_mark is None else 1e6 * rules.X_s_mark,
        "swing_um": swings[0] if rules.X_s_mark is not None and len(swings) == 1 else None,
        "steps": round(rules.t_s_inset / numerics.step_s, 3),
        "t_s_unit_ms": None if rules.t_s_unit is None else 1e3 * rules.t_s_unit,
        "t_s_ms": 1e3 * float(common.t_s[0]),
        "phi": float(common.phi[0]),
        "phi_decimals": rules.common_phi_decimals,
    }


def numbers_of_free_choices(case: Case) -> Json:
    """List the free choices behind the as-published numbers with their counts: continuous, discrete, list."""
    choices = proof.free_choices(case)
    return {**{kind: len(of) for kind, of in choices.items()}, "list": choices}


def left_open(case: Case, exact: Mapping[str, Features], numbers: Numbers) -> Json:
    """Count how often unprinted read-outs exceed the largest error that the paper states at its last frequency.

    draws, seed : of the Monte Carlo.   spreads : half widths of X, µm, and φ, rad, and the share of draws above the
    printed bound, %.   rounded : low and high, between which the largest error, %, of the inner inner_percent of the
    draws lies where X alone is rounded as for Table 3.
    """
    last, table = list(exact.items())[-1]
    printed = numbers[_two_point(last, "any")]["printed"]
    bound = float(printed) if printed else math.nan
    spreads = unprinted.drawn(table, case, bound)
    (rounded,) = unprinted.drawn(table, case, bound, [unprinted.ROUNDED])
    return {
        "draws": unprinted.DRAWS,
        "seed": unprinted.SEED,
        "inner_percent": 100.0 * (1.0 - 2.0 * unprinted.RARE),
        "spreads": [
            {"X_um": 1e6 * of.X_m, "phi_rad": of.phi_rad, "above_percent": 100.0 * of.share}
            for of in spreads
        ],
        "rounded": {"low": rounded.low, "high": rounded.high},
    }


def integral_deviations(
    exact: Features, rebuilt: Features, numbers: pd.DataFrame, schemes: pd.DataFrame
) -> Json:
    """Return the relative deviations of a, b and W of Table 2, as ranges over the levels.

    printed : of the printed numbers from the exact ones.   as_published : of the rebuilt simulation from the exact one.
    printed_from_rebuilt : of the printed numbers from the rebuilt ones, in size; without the first level as well.
    printed_from_c_over_m, printed_from_unrounded : of the printed numbers from a simulation with c/m alone rounded, and
    with no coefficient rounded, in size.
    printed_from_by_hand : likewise, from the exact solver with the damping of the simulation put in by hand.
    """
    others = {
        "printed_from_c_over_m": ("backward-euler", "c_over_m"),
        "printed_from_unrounded": ("backward-euler", "exact"),
        "printed_from_by_hand": ("exact", "by_hand"),
    }
    simulated = {(of, by): rows for (of, by), rows in schemes.groupby(["scheme", "coefficients"])}
    deviations: Json = {}
    for name in TABLE_2:
        printed, column = _printed(numbers, name), FEATURE_COLUMNS[name]
        of_exact, of_rebuilt = getattr(exact, name), getattr(rebuilt, name)
        from_rebuilt = np.abs(printed / of_rebuilt - 1.0)
        deviations[name] = {
            "printed": _range(printed / of_exact - 1.0),
            "as_published": _range(of_rebuilt / of_exact - 1.0),
            "printed_from_rebuilt": _range(from_rebuilt),
            "printed_from_rebuilt_beyond_first": _range(from_rebuilt[1:]),
            **{
                of: _range(np.abs(printed / simulated[which][column].to_numpy() - 1.0))
                for of, which in others.items()
            },
            "printed_from_rebuilt_at_first": from_rebuilt[0],
        }
    return deviations


def step_from_work(numbers: pd.DataFrame, schemes: pd.DataFrame, case: Case) -> Json:
    """Return the step, µs, at which backward Euler gives each printed W of Table 2, by way of rounding c/m and k/m.

    Its error is proportional to h, and Runge–Kutta with the same coefficients gives W for h → 0.

    schemes : the table of `authors_route.scheme_table`.
    """
    W = schemes.set_index("scheme")
    steps: Json = {}
    for rounding in ("rounded", "c_over_m", "exact"):
        of = W.loc[W["coefficients"] == rounding, "W_J"]
        euler, limit = (of[name].to_numpy() for name in ("backward-euler", "rk4"))
        share = (_printed(numbers, "W") - limit) / (euler - limit)
        steps[rounding] = _range(1e6 * case.numerics.step_s * share)
    return steps


SIMULATION = ["trial", "scheme", "step_s", "c_N_s_per_m"]
"""The columns of `authors_route.trial_table` that name one simulation."""


def sampling_instants(cycles: pd.DataFrame, numbers: pd.DataFrame) -> pd.DataFrame:
    """Return the sampling instant within a step that each printed a implies, in each cycle of each simulation.

    Adds a column instant: the part of a step by which a level deviates from the mean of its cycle, between −1/2 and
    1/2. If the simulation is the one behind the printed a, all levels agree on one instant, and it is zero. Whole steps
    do not count, because a may begin a sample earlier or later.

    cycles : the table of `authors_route.trial_table`.
    """
    per_step = 2.0 * cycles["V_s_m_per_s"] * cycles["step_s"]
    printed = _printed(numbers, "a")[cycles["level"].to_numpy() - 1]
    turns = np.exp(2j * np.pi * (printed - cycles["a_m"]) / per_step)
    mean = turns.groupby([cycles[name] for name in [*SIMULATION, "cycle"]]).transform("mean")
    return cycles.assign(instant=np.angle(turns / mean) / (2.0 * np.pi))


def agreement_of_instants(instants: pd.DataFrame, numbers: pd.DataFrame) -> Json:
    """Return how well the printed a of all levels agree on one sampling instant, in steps, by trial.

    spread : by trial, the largest deviation of a level in a cycle: the smallest and the largest of all cycles.
    count : number of cycles of the as-published simulation.   steps : number of other steps tried.
    other_damping : of the trials with another c, put in by hand, the one whose instants agree best: its c (N s/m), its
    spread, and by how much of itself its W misses print at most.

    instants : by `sampling_instants`.
    """
    W = _printed(numbers, "W")[instants["level"].to_numpy() - 1]
    sizes = instants.assign(spread=instants["instant"].abs(), W=(instants["W_J"] / W - 1.0).abs())
    spreads = sizes.groupby([*SIMULATION, "cycle"])["spread"].max().groupby("trial")
    of_damping = sizes[sizes["trial"] == "other_damping"].groupby("c_N_s_per_m")
    largest = of_damping[["spread", "W"]].max()
    best = largest.sort_values("spread").iloc[:1].reset_index().iloc[0]
    columns = {"c": "c_N_s_per_m", "spread": "spread", "W": "W"}
    cycles, others = (sizes[sizes["trial"] == name] for name in ("as_published", "other_steps"))
    return {
        "count": cycles["cycle"].nunique(),
        "steps": others["step_s"].nunique(),
        "spread": {name: {"min": of.min(), "max": of.max()} for name, of in spreads},
        "other_damping": {name: best[of] for name, of in columns.items()},
    }


def at_a_glance(
    evidence: Evidence, approaches: pd.DataFrame, case: Case
) -> tuple[Damping, dict[str, list[float]], list[float]]:
    """Return the values that `figures.numerics.glance` draws: damping, and errors of F_k at each frequency, Hz.

    evidence : what the figure of the numerics draws.   approaches : the table of `comparison.approaches_table`.
    """
    c, fit = case.oscillator.c, ("c", "least_squares", "direct")
    damping = Damping(
        true=c,
        added=added_damping(case, case.omega(next(iter(case.frequencies_hz)))),
        rebuilt=float(evidence.of("as_published", *fit).iloc[0]),
        printed=float(evidence.printed(*fit)[0]),
    )
    ways = approaches.set_index(list(comparison.WAY))["F_k_error_percent"]
    errors = {
        label: [float(error) for error in np.atleast_1d(ways[comparison.WAYS_TO_COMPARE[way]])]
        for label, way in GLANCE.items()
    }
    return damping, errors, list(case.frequencies_hz.values())


def lock_in_errors(features: Features, oscillator: Oscillator, pairs: Sequence[Pair]) -> Json:
    """Return the errors of F_k and c, %, by the Fourier balance with b = πωX_1² alone, which a lock-in amplifier gives.

    pair : size of the largest error of all pairs.   least_squares : error with its sign.
    """
    table = estimate_table(features.replaced(X_3=0.0, X_5=0.0), oscillator.k, pairs)
    errors = of_errors(of_estimates("", table), oscillator)
    kinds = {"pair": "largest", "least_squares": "least_squares"}
    return {
        name: {term: errors[Key("", term, "fourier", kind, unit="%")] for term in TERMS}
        for name, kind in kinds.items()
    }


def balance_terms(features: Features, oscillator: Oscillator) -> Json:
    """Compare the terms of the balance, as ranges over the levels, in %.

    friction_share : a F_k / W.   sine : sin φ with φ of the reversal, not in %.
    phase_spread : (largest − smallest sin φ)/mean, with φ of the reversal and of the fundamental.
    W_common, W_individual : error of W = πkYX sin φ with the mean φ and with each level's φ of the reversal.
    W_fundamental : size of the error of πkYX_1 sin φ_1, which is rounding.   b_harmonic : error of πωX².
    b_first, b_fifth : error of πωΣn²X_n² up to n = 1, 5.   third : X_3/X_1.
    """
    work = np.pi * oscillator.k * features.Y
    W, b = features.W, features.b
    phases = {"reversal": features.phi_reversal, "fundamental": features.phi_fundamental}
    sines = {name: np.sin(phase) for name, phase in phases.items()}
    common = np.sin(np.mean(features.phi_reversal))
    harmonics = {1: features.X_1, 3: features.X_3, 5: features.X_5}
    terms = {
        "friction_share": features.a * oscillator.F_k / W,
        "W_common": work * features.X * common / W - 1.0,
        "W_individual": work * features.X * sines["reversal"] / W - 1.0,
        "W_fundamental": np.abs(work * features.X_1 * sines["fundamental"] / W - 1.0),
        "b_harmonic": np.pi * features.omega * features.X**2 / b - 1.0,
        "b_first": viscous_integral(features.omega, {1: features.X_1}) / b - 1.0,
        "b_fifth": viscous_integral(features.omega, harmonics) / b - 1.0,
        "third": features.X_3 / features.X_1,
    }
    return {
        **{name: _range(100.0 * values) for name, values in terms.items()},
        "sine": _range(sines["reversal"]),
        "phase_spread": {name: 100.0 * (np.ptp(of) / np.mean(of)) for name, of in sines.items()},
    }


def _two_point(frequency: str, quantity: str) -> Key:
    """Return the key of the largest error of the pairs by the formulas of Table 3."""
    return Key(frequency, quantity, HARMONIC, "largest", "", "common", unit="%")


def _printed(numbers: pd.DataFrame, name: str) -> np.ndarray:
    """Return the printed a, b or W of Table 2, level by level."""
    texts = select(numbers, quantity=name, kind="level")["printed"]
    return texts[texts != ""].astype(float).to_numpy()


def _range(values: Any) -> Json:
    """Return the smallest and largest value, those of the first and the last level, and the largest size."""
    numbers = np.asarray(values)
    return {
        "min": numbers.min(),
        "max": numbers.max(),
        "first": numbers[0],
        "last": numbers[-1],
        "size": np.abs(numbers).max(),
    }
