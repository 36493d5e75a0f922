"""Numbers that the article uses and no other result contains, computed from the tables of results.

Each is a row of derived.csv: an id, a value, and its unit. Article and page look numbers up by their ids.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from ... import balance, solver
from ...balance import TERMS, viscous_integral
from ...features import FEATURE_COLUMNS, Features
from ...model import Oscillator
from ...project.case import Case
from ...replication import authors_route, comparison
from ...replication import numbers as of_routes
from ...replication.claims import evidence, unprinted, verdicts
from ...replication.clean import CYCLES_TO_READ
from ...replication.numbers import Numbers, select
from ...replication.read_out import ReadOut
from ...studies.parameters import parameter
from ...studies.study_file import Study

Rows = dict[str, tuple[Any, str]]
"""Id → a number or a text, and its unit. None or NaN stands for a number that does not exist."""


def rows(group: str, values: Mapping[Any, Any], unit: str = "") -> Rows:
    """Return the rows of a group, whose ids are GROUP.NAME."""
    return {f"{group}.{name}": (value, unit) for name, value in values.items()}


def table(derived: Rows) -> list[dict[str, object]]:
    """Return the rows of derived.csv."""
    return [{"id": name, "value": value, "unit": unit} for name, (value, unit) in derived.items()]


def derived_numbers(
    case: Case,
    numbers: pd.DataFrame,
    claims: pd.DataFrame,
    schemes: pd.DataFrame,
    cycles: pd.DataFrame,
) -> Rows:
    """Return all numbers that follow from the table of numbers and from the claims.

    numbers : of all routes, with what is printed (`numbers.with_claims`).   claims : the table of verdicts, as text.
    schemes, cycles : by `authors_route.scheme_table` and `trial_table`.
    """
    by_key = of_routes.by_key(numbers)
    exact, rebuilt = (
        {n: of_routes.features_of(by_key, route, n, case.omega(n)) for n in case.frequencies_hz}
        for route in ("exact", "as_published")
    )
    first, last = next(iter(exact)), next(reversed(exact))
    derived = {
        **setting(case, exact[first]),
        **verdict_counts(claims),
        **rows("chance", evidence.chance(claims)),
        **rows(
            "chance.but_V_s",
            evidence.chance(claims[~claims["id"].str.startswith("table1.V_s.")]),
        ),
        **rows("V_s", evidence.slip_velocities(numbers, cycles)),
        **rows("routes", evidence.by_route(claims)),
        **rows("choices", {n: len(of) for n, of in evidence.free_choices(case).items()}),
        **inputs_of_table_3(case, by_key),
        **left_open(case, last, exact[last], by_key),
        **damping(case, first, schemes),
        **integral_deviations(exact[first], rebuilt[first], numbers, schemes),
        **step_from_work(numbers, schemes, case),
        **agreement_of_instants(sampling_instants(cycles, numbers), numbers),
        **starts(cycles, case),
        **largest_errors(numbers),
    }
    # deviation of the printed a from the rebuilt one, in samples by which the detection of slip would be shifted
    per_sample = 2.0 * rebuilt[first].V_s * case.numerics.step_s
    off = (_printed(numbers, "a") - rebuilt[first].a) / per_sample
    derived["rebuilt.a.samples"] = (_largest(off), "")
    for name, features in exact.items():
        derived |= balance_terms(name, features, case.oscillator)
        derived |= rounding(name, features, case)
    derived |= rows("rounding", {"draws": unprinted.DRAWS, "seed": unprinted.SEED})
    work = [f.Y * f.X_1 * np.sin(f.phi_fundamental) / f.W for f in exact.values()]
    of_work = _largest(np.pi * case.oscillator.k * np.array(work) - 1.0)
    derived["W_fundamental"] = (100.0 * of_work, "%")  # of πkYX_1 sin φ_1
    approaches = comparison.approaches_table(by_key, case.frequencies_hz)
    for name, shifts in comparison.cause_shifts(approaches, case.frequencies_hz).items():
        derived |= rows(f"cause.{name}", {cause: shifts[cause] for cause in comparison.CAUSES}, "%")
    return derived


def setting(case: Case, exact: Features) -> Rows:
    """Describe the simulation, and how the responses at the first frequency are read, step by step, for Table 3.

    c_over_m, k_over_m : the rounded coefficients of the equation divided by m.   count : numbers of levels and so on.

    periods : number simulated before the cycle that is read.
    slip_samples : number of samples after the detection of slip at which a begins, level by level.
    X, mark : units to which X and X + X_s are read.   swing : X + X_s as read, if all levels agree.
    steps : number of steps subtracted from t_s.   t_s_unit, t_s : unit of t_s, and its value for all levels.
    phi, phi_decimals : the phase for all levels, rad, and its decimals.

    exact : features of the exact responses; read to such coarse units, those of the simulation give the same numbers.
    """
    numerics, rules = case.numerics, ReadOut.from_config(case.numerics.two_point)
    coefficients, common = authors_route.printed_coefficients(case), rules.common(exact)
    sizes = {"levels": case.levels_m, "frequencies": case.frequencies_hz, "pairs": case.pairs}
    swings = {round(1e6 * swing, 6) for swing in (common.X + common.X_s).tolist()}
    X_unit = None if rules.X_decimals is None else 10.0 ** (6 - rules.X_decimals)
    agreed = rules.X_s_mark is not None and len(swings) == 1
    return {
        "swing": (2e6 * case.oscillator.Z_m, "µm"),  # 2 Z_m
        "scheme": (numerics.scheme.replace("-", " ").replace("euler", "Euler"), ""),
        "step": (1e6 * numerics.step_s, "µs"),
        "c_over_m": (coefficients["c_over_m"], "s⁻¹"),
        "k_over_m": (coefficients["k_over_m"], "s⁻²"),
        **rows("count", {name: len(of) for name, of in sizes.items()}),
        "recipe.periods": (numerics.cycles - CYCLES_TO_READ, ""),
        "recipe.slip_samples": (", ".join(map(str, numerics.slip_samples)), ""),
        "recipe.X": (X_unit, "µm"),
        "recipe.mark": (rules.X_s_mark and 1e6 * rules.X_s_mark, "µm"),
        "recipe.swing": (swings.pop() if agreed else None, "µm"),
        "recipe.steps": (round(rules.t_s_inset / numerics.step_s, 3), ""),
        "recipe.t_s_unit": (rules.t_s_unit and 1e3 * rules.t_s_unit, "ms"),
        "recipe.t_s": (1e3 * float(common.t_s[0]), "ms"),
        "recipe.phi": (float(common.phi[0]), ""),
        "recipe.phi_decimals": (rules.common_phi_decimals, ""),
    }


def verdict_counts(claims: pd.DataFrame) -> Rows:
    """Return how many numbers earn each verdict, by part of the paper; and the mark and the meaning of each verdict."""
    counted: Rows = {}
    for count in verdicts.counts(claims):
        others = {"computed": count.computed, "given": count.given}
        others |= {"statement": count.statements, "statements_held": count.statements_held}
        others |= {"statements_undecided": count.statements_undecided}
        counted |= rows(f"verdicts.{count.key}", {**count.of_verdict, **others})
    for name, verdict in verdicts.VERDICTS.items():
        counted |= rows(f"verdict.{name}", {"mark": verdict.mark, "meaning": verdict.meaning})
    return counted


def inputs_of_table_3(case: Case, numbers: Numbers) -> Rows:
    """Return `evidence.inputs_of_table_3`: what the inputs give, and how many numbers a step of one of them changes.

    moved : with the input one step less, 0, and one step more, 1; or with the other sign, 0.
    """
    found = evidence.inputs_of_table_3(case, numbers)
    derived = rows(
        "table_3", {name: found[name] for name in ("inputs", "given", "given_by_exact_X")}
    )
    derived |= rows("moved_X", dict(zip(("fewest", "most"), found["moved_X"], strict=True)))
    for name in ("X + X_s", "t_s", "phi", "sign"):
        derived |= rows(f"moved.{name}", dict(enumerate(found["moved"][name])))
    return derived


def left_open(case: Case, frequency: str, exact: Features, numbers: Numbers) -> Rows:
    """Count how often unprinted read-outs exceed the largest error that the paper states at a frequency.

    draws, seed : of the Monte Carlo.   0, 1, 2 : of the spreads, half widths of X and φ, and the share of draws above
    the printed bound.   rounded : low and high, between which the largest error of the inner part of the draws lies
    where X alone is rounded as for Table 3.
    """
    worst = of_routes.key_of(frequency, "any", of_routes.HARMONIC, "largest")
    bound = float(numbers[worst]["printed"] or math.nan)
    (rounded,) = unprinted.drawn(exact, case, bound, [unprinted.ROUNDED])
    derived = rows("unprinted", {"draws": unprinted.DRAWS, "seed": unprinted.SEED})
    derived |= rows("unprinted", {"inner": 100.0 * (1.0 - 2.0 * unprinted.RARE)}, "%")
    derived |= rows("unprinted.rounded", {"low": rounded.low, "high": rounded.high}, "%")
    for n, of in enumerate(unprinted.drawn(exact, case, bound)):
        derived[f"unprinted.{n}.X"] = (1e6 * of.X_m, "µm")
        derived[f"unprinted.{n}.phi"] = (of.phi_rad, "rad")
        derived[f"unprinted.{n}.above"] = (100.0 * of.share, "%")
    return derived


def rounding(frequency: str, exact: Features, case: Case) -> Rows:
    """Return how the rounding of all its read-outs spreads the largest error of F_k by the Fourier balance, over pairs.

    table_1 : with the decimals of Table 1.   one_more : with one decimal more.
    median, p95 : quantiles over the draws of `unprinted.rounding_errors`.
    """
    derived: Rows = {}
    for more, name in enumerate(("table_1", "one_more")):
        errors = unprinted.rounding_errors(exact, case, more)
        of = {"median": float(np.median(errors)), "p95": float(np.quantile(errors, 0.95))}
        derived |= rows(f"rounding.{frequency}.{name}", of, "%")
    return derived


def damping(case: Case, frequency: str, schemes: pd.DataFrame) -> Rows:
    """Return what backward Euler adds to c near resonance, where c, as rounded, acts as c + mω²h; and c by each scheme.

    schemes : the table of `authors_route.scheme_table`.
    """
    omega, unit = case.omega(frequency), "N s/m"
    rounded = case.oscillator.m * authors_route.printed_coefficients(case)["c_over_m"]
    simulated = select(schemes, coefficients="rounded").drop_duplicates("scheme")
    return {
        "added": (authors_route.added_damping(case, omega), unit),
        "effective": (authors_route.effective_damping(case, omega), unit),
        "c.rounded": (rounded, unit),
        "c.by_hand": (authors_route.damping_by_hand(case, frequency), unit),
        **rows("c", simulated.set_index("scheme")["c_N_s_per_m"].to_dict(), unit),
    }


def integral_deviations(
    exact: Features, rebuilt: Features, numbers: pd.DataFrame, schemes: pd.DataFrame
) -> Rows:
    """Return relative deviations of the printed a, b and W of Table 2.

    dev : from the exact ones, at the highest level.
    rebuilt : from the rebuilt ones, the largest in size; b at the first level by itself.
    c_over_m, unrounded : the largest of W from a simulation with c/m alone rounded, and with no coefficient rounded.
    by_hand : likewise, from the exact solver with the damping of the simulation entered by hand.
    c.print_but_first : c, N s/m, by least squares of the printed integrals without the first level, whose b is wrong.
    """
    printed = {name: _printed(numbers, name) for name in of_routes.TABLE_2}
    off = {name: of / getattr(exact, name) - 1.0 for name, of in printed.items()}
    a, b, W = (of / getattr(rebuilt, name) - 1.0 for name, of in printed.items())
    derived = rows("dev", {name: of[-1] for name, of in off.items()})
    largest = {"a": _largest(a), "b": _largest(b[1:]), "b.first": abs(b[0]), "W": _largest(W)}
    derived |= rows("rebuilt", largest)
    but_first = balance.Rows({"F_k": printed["a"], "c": printed["b"]}, printed["W"])[1:]
    derived["c.print_but_first"] = (float(solver.least_squares(but_first)["c"]), "N s/m")
    others = {
        "c_over_m": ("backward-euler", "c_over_m"),
        "unrounded": ("backward-euler", "exact"),
        "by_hand": ("exact", "by_hand"),
    }
    for name, (scheme, coefficients) in others.items():
        of = select(schemes, scheme=scheme, coefficients=coefficients)[FEATURE_COLUMNS["W"]]
        derived[f"{name}.W"] = (_largest(printed["W"] / of.to_numpy() - 1.0), "")
    return derived


def step_from_work(numbers: pd.DataFrame, schemes: pd.DataFrame, case: Case) -> Rows:
    """Return the step, µs, at which backward Euler gives each printed W of Table 2, by way of rounding c/m and k/m.

    Its error is proportional to h, and Runge–Kutta with the same coefficients gives W for h → 0.

    schemes : the table of `authors_route.scheme_table`.
    """
    W = schemes.set_index("scheme")
    steps: Rows = {}
    for rounding in ("rounded", "c_over_m", "exact"):
        of = W.loc[W["coefficients"] == rounding, "W_J"]
        euler, limit = (of[name].to_numpy() for name in ("backward-euler", "rk4"))
        share = (_printed(numbers, "W") - limit) / (euler - limit)
        step = 1e6 * case.numerics.step_s * share
        steps |= rows(f"step_from_W.{rounding}", {"min": step.min(), "max": step.max()}, "µs")
    return steps


SIMULATION = ["trial", "scheme", "step_s", "c_N_s_per_m", "k_over_m_per_s2"]
"""The columns of `authors_route.trial_table` that name one simulation."""


def sampling_instants(cycles: pd.DataFrame, numbers: pd.DataFrame) -> pd.DataFrame:
    """Return the sampling instant within a step that each printed a implies, in each cycle of each simulation.

    The column `instant` is added: the part of a step by which a level deviates from the mean of its cycle, between −1/2
    and 1/2. If the simulation is the one behind the printed a, all levels agree on one instant, and it is zero. Whole
    steps do not count, because a may begin a sample earlier or later.

    cycles : the table of `authors_route.trial_table`.
    """
    per_step = 2.0 * cycles["V_s_m_per_s"] * cycles["step_s"]
    printed = _printed(numbers, "a")[cycles["level"].to_numpy() - 1]
    turns = np.exp(2j * np.pi * (printed - cycles["a_m"]) / per_step)
    mean = turns.groupby([cycles[name] for name in [*SIMULATION, "cycle"]]).transform("mean")
    return cycles.assign(instant=np.angle(turns / mean) / (2.0 * np.pi))


def agreement_of_instants(instants: pd.DataFrame, numbers: pd.DataFrame) -> Rows:
    """Return how well the printed a of all levels agree on one sampling instant, in steps, by trial.

    instants : by trial, the largest deviation of a level in a cycle: the smallest and the largest of all cycles; W, the
    largest relative deviation of W from the print.
    instants.chance : the probability that random instants agree as well as those of the as-published simulation do in
    every cycle (`evidence.chance_of_instants`), for each setting that was tried.
    cycles : number of cycles of the as-published simulation, of other steps and of all other settings tried.
    other_damping : of the trials with another c, entered by hand, the one whose instants agree best: its c, its spread,
    and the largest relative deviation of its W from the print.

    instants (argument) : by `sampling_instants`.
    """
    W = _printed(numbers, "W")[instants["level"].to_numpy() - 1]
    sizes = instants.assign(spread=instants["instant"].abs(), W=(instants["W_J"] / W - 1.0).abs())
    spreads = sizes.groupby([*SIMULATION, "cycle"])["spread"].max().groupby("trial")
    of_damping = sizes[sizes["trial"] == "other_damping"].groupby("c_N_s_per_m")
    largest = of_damping[["spread", "W"]].max()
    best = largest.sort_values("spread").iloc[:1].reset_index().iloc[0]
    cycles, others = (select(sizes, trial=name) for name in ("as_published", "other_steps"))
    derived = rows(
        "cycles", {"count": cycles["cycle"].nunique(), "steps": others["step_s"].nunique()}
    )
    derived |= rows("cycles", {"settings": sizes.groupby(SIMULATION).ngroups - 1})
    of_W = sizes.groupby("trial")["W"].max()
    for name, of in spreads:
        derived |= rows(f"instants.{name}", {"min": of.min(), "max": of.max(), "W": of_W[name]})
    worst = float(spreads.max()["as_published"])
    chance = evidence.chance_of_instants(worst, instants["level"].nunique())
    derived |= rows("instants", {"chance": chance})
    derived |= rows("other_damping", {"c": best["c_N_s_per_m"]}, "N s/m")
    return derived | rows("other_damping", {name: best[name] for name in ("spread", "W")})


def starts(cycles: pd.DataFrame, case: Case) -> Rows:
    """Return what the samples at which the printed a begin have in common, in steps, in the cycle that is read.

    alike : difference between the lowest and the highest level in where the onset of slip falls between two samples.
    rule : low and high. With any number of steps between them, a begins at every level at the first sample that is at
    least this number after the onset. If there is no such number, low exceeds high.

    cycles : the table of `authors_route.trial_table`.
    """
    of_trial = select(cycles, trial="as_published")
    onset = of_trial.loc[of_trial["cycle"] == 0, "onset_steps"].to_numpy()
    begins = onset + [case.numerics.after_slip(level) for level in range(len(onset))]
    rule = {"rule.low": (begins - 1.0).max(), "rule.high": begins.min()}
    apart = (onset[0] - onset[-1] + 0.5) % 1.0 - 0.5
    return rows("starts", {"alike": abs(apart), **rule})


def largest_errors(numbers: pd.DataFrame) -> Rows:
    """Return the largest errors of F_k and c with exact features at any frequency: of direct integration by pairs and
    by least squares, of the Fourier balance by pairs."""
    derived: Rows = {}
    for approach, kinds in {
        "direct": ("largest", "least_squares"),
        "fourier": ("largest",),
    }.items():
        errors = select(numbers, approach=approach, unit="%")
        sizes = errors[errors["kind"].isin(kinds)].set_index("quantity")["exact"].abs()
        derived |= rows(f"largest.{approach}", {term: sizes[term].max() for term in TERMS}, "%")
    return derived


def balance_terms(frequency: str, features: Features, osc: Oscillator) -> Rows:
    """Compare the terms of the balance at a frequency, from the lowest level (first) to the highest (last), in %.

    share : a F_k / W.   sine : sin φ with φ of the reversal, not in %.
    spread : (largest − smallest sin φ)/mean, with φ of the reversal and of the fundamental.
    W_common, W_individual : error of W = πkYX sin φ with the mean φ and with each level's φ of the reversal.

    The first is made up of three errors, 1 + W_common = (1 + W_peak)(1 + W_which)(1 + W_shared), the second of the
    first two of them. Each isolates one cause:

    W_peak : the peak X in place of the amplitude X_1 of the fundamental.
    W_which : sin φ of the reversal in place of sin φ of the fundamental, level by level.
    W_shared : the sine of the mean φ of the reversal in place of that of each level's own; W_shared_right : of the
    mean φ of the fundamental, which shows what sharing costs alone.

    b_fifth : error of πωΣn²X_n² up to n = 5, its largest size.   third : the largest X_3/X_1.
    """
    W, b = features.W, features.b
    work = np.pi * osc.k * features.Y * features.X
    sine = np.sin(features.phi_reversal)
    sines = {"reversal": sine, "fundamental": np.sin(features.phi_fundamental)}
    shared, shared_right = (
        np.sin(np.mean(phi)) for phi in (features.phi_reversal, features.phi_fundamental)
    )
    harmonics = {1: features.X_1, 3: features.X_3, 5: features.X_5}
    b_fifth = 100.0 * (viscous_integral(features.omega, harmonics) / b - 1.0)
    spread = {name: 100.0 * (np.ptp(of) / np.mean(of)) for name, of in sines.items()}

    def ends(name: str, values: np.ndarray, unit: str = "%") -> Rows:
        return rows(f"{name}.{frequency}", {"first": values[0], "last": values[-1]}, unit)

    return {
        **ends("share", 100.0 * features.a * osc.F_k / W),
        **ends("sine", sine, ""),
        **ends("W_individual", 100.0 * (work * sine / W - 1.0)),
        **ends("W_common", 100.0 * (work * shared / W - 1.0)),
        **ends("W_peak", 100.0 * (features.X / features.X_1 - 1.0)),
        **ends("W_which", 100.0 * (sine / sines["fundamental"] - 1.0)),
        **ends("W_shared", 100.0 * (shared / sine - 1.0)),
        **ends("W_shared_right", 100.0 * (shared_right / sines["fundamental"] - 1.0)),
        **rows(f"spread.{frequency}", spread, "%"),
        **rows("third", {frequency: (100.0 * features.X_3 / features.X_1).max()}, "%"),
        **rows(f"b_fifth.{frequency}", {"size": _largest(b_fifth)}, "%"),
    }


def of_study(study: Study, text: str, numbers: Mapping[str, Any]) -> Rows:
    """Return what a study shows: its paragraph and the numbers in it (`paragraph`), its cases, and its axes."""
    derived = rows(f"study.{study.name}", {"paragraph": text, **numbers})
    derived |= rows("cases", {study.name: study.cases})
    for axis in study.axis_names:
        if not parameter(axis).is_word:
            reach = dict(zip(("low", "high"), study.extent(axis), strict=True))
            derived |= rows(f"range.{study.name}.{axis}", reach)
    return derived


def of_environment(
    packages: Mapping[str, str], typesetter: str, python: str, software: Mapping[str, Any]
) -> Rows:
    """Return the versions of packages, of typst and of Python, and what CITATION.cff states (`manifest.software`)."""
    stated = {name: software[name] for name in ("version", "licence")}
    return {
        "python": (python, ""),
        "typesetter": (typesetter, ""),
        **rows("package", packages),
        **rows("software", stated),
        **rows("author", dict(enumerate(software["authors"]))),
        **rows("software.address", software["addresses"]),
    }


def _printed(numbers: pd.DataFrame, name: str) -> np.ndarray:
    """Return the printed a, b or W of Table 2, level by level."""
    texts = select(numbers, quantity=name, kind="level")["printed"]
    return texts[texts != ""].astype(float).to_numpy()


def _largest(values: np.ndarray) -> float:
    return float(np.abs(values).max())
