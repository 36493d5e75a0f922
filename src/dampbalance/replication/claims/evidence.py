"""How much the agreement with the print proves: agreement by chance, free choices, and the inputs behind Table 3.

Everything follows from the tables of claims and numbers and from the configuration.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from scipy.special import bdtrc

from ...features import Features
from ...project.case import Case
from ..authors_route import CORRECTED, estimates
from ..numbers import Numbers, features_of, of_estimates
from ..read_out import ReadOut
from .judging import HALF
from .printed import PAIRS, Printed
from .table import SEPARATOR
from .verdicts import HOLDING, REPRODUCED, ROUTE_NAMES, part_of

CLOSE_UNITS = 5.0
"""Distance from an exact number, in units of the last digit, within which ten last digits lie."""

BY_CHANCE = 0.1
"""The share of numbers within CLOSE_UNITS that agree in the last digit if it is a matter of chance."""


def chance(claims: pd.DataFrame) -> dict[str, float]:
    """Count the exact numbers that may agree by chance: those in columns that the exact route does not give throughout.

    close : those that, rounded to the printed decimals, agree in all digits but the last.
    within : those less than CLOSE_UNITS off.
    expected : BY_CHANCE of those within.   observed : those that give the printed digits.
    p : probability that chance gives at least as many, of a binomial distribution.

    claims : claims.csv as text.
    """
    exact = claims[_made_otherwise(claims) & (claims["exact"] != "")]
    units = exact["printed"].map(lambda text: Printed(text).unit)
    off = ((exact["exact"].astype(float) - exact["printed"].astype(float)) / units).abs()
    rounded = (exact["exact"].astype(float) / units).round()
    printed = (exact["printed"].astype(float) / units).round()
    within, observed = int((off < CLOSE_UNITS).sum()), int((off <= HALF).sum())
    return {
        "close": int((np.trunc(rounded / 10.0) == np.trunc(printed / 10.0)).sum()),
        "within": within,
        "expected": BY_CHANCE * within,
        "observed": observed,
        "p": float(bdtrc(observed - 1, within, BY_CHANCE)),
    }


def chance_of_instants(largest: float, levels: int) -> float:
    """Return the probability that instants drawn at random agree within `largest` of their circular mean, in steps.

    With u_i uniform on a circle of length 1 and d = `largest` small, the deviations from the mean fill the body
    |y_i| ≤ d, Σ y_i = 0. Its volume in the coordinates y_2 … y_n is (2d)^(n−1) P(|S| ≤ 1), where S is the sum of
    n − 1 numbers that are uniform between −1 and 1 (Irwin–Hall), and the u_i − u_1 have the Jacobian n:

        P = n (2d)^(n−1) P(|S| ≤ 1),   for five levels 5 · 16 d⁴ · 115/192

    Exact for d below 1/(2n), where the instants lie on less than half of the circle; a mean of directions then differs
    from that of the u_i by a relative (2πd)²/6 or so.

    largest : d, steps.   levels : number n of instants, at least 2.
    """
    n = levels - 1
    # distribution function of the sum of n numbers between 0 and 1, at (n − 1)/2, where S = −1
    x = 0.5 * (n - 1)
    terms = ((-1) ** j * math.comb(n, j) * (x - j) ** n for j in range(math.floor(x) + 1))
    below = math.fsum(terms) / math.factorial(n)
    return min(levels * (2.0 * largest) ** n * (1.0 - 2.0 * below), 1.0)


def slip_velocities(numbers: pd.DataFrame, cycles: pd.DataFrame) -> dict[str, float]:
    """Compare the printed V_s with those of the exact and of the simulated motion, in units of the last digit.

    exact_units : the largest distance of an exact one.
    simulated_units.min, .max : distances of the simulated ones, read at the onset of slip, between samples.
    sampled_units.min, .max : likewise, read at the sample at which slip is detected.
    chance : the probability that exact numbers with random last digits, uniform within CLOSE_UNITS of each printed
    one, all lie within exact_units.

    numbers : with what is printed (`numbers.with_claims`).   cycles : the table of `authors_route.trial_table`.
    """
    rows = numbers[(numbers["quantity"] == "V_s") & (numbers["kind"] == "level")]
    rows = rows[rows["printed"] != ""]
    printed = rows["printed"].astype(float)
    units = rows["printed"].map(lambda text: Printed(text).unit)
    read = cycles[(cycles["trial"] == "as_published") & (cycles["cycle"] == 0)]
    values = {
        "exact": rows["exact"].to_numpy(),
        "simulated": rows["unrounded"].to_numpy(),
        "sampled": read["V_s_m_per_s"].to_numpy()[rows["line"].astype(int) - 1],
    }
    off = {name: ((value - printed) / units).abs() for name, value in values.items()}
    largest = float(off["exact"].max())
    found = {"exact_units": largest, "chance": min(largest / CLOSE_UNITS, 1.0) ** len(rows)}
    for name in ("simulated", "sampled"):
        found[f"{name}_units.min"] = float(off[name].min())
        found[f"{name}_units.max"] = float(off[name].max())
    return found


def _made_otherwise(claims: pd.DataFrame) -> pd.Series:
    """Return which computed numbers are in columns that were not obtained by the exact route.

    A column that the exact route judges counts as such if this route misses one of its numbers: V_s.
    """
    computed, exact = claims["kind"] == "computed", ROUTE_NAMES["exact"]
    missed = computed & ~claims["agrees"].str.startswith(exact)
    of_column = missed.groupby(claims["quantity"])
    return computed & ((claims["judged"] != exact) | of_column.transform("any"))


def by_route(claims: pd.DataFrame) -> dict[str, int]:
    """Count the computed numbers by the routes that give them, next to the verdicts, which name the best one.

    exact : in columns that the exact route gives throughout.
    simulation : given as published, of all other columns.   simulation_reproduced : of these, exact agrees as well.
    print : given by arithmetic on printed tables alone, of columns that were obtained in this way.
    print_elsewhere : with the verdict `from print`, of other columns.
    table_3_from_table_1 : numbers of Table 3 that follow from Table 1 with the decimals that it prints.

    claims : claims.csv as text.
    """
    rows = claims[(claims["kind"] == "computed") & claims["verdict"].isin(HOLDING)]
    agrees = {
        name: rows["agrees"].str.split(SEPARATOR).map(lambda routes, w=words: w in routes)
        for name, words in ROUTE_NAMES.items()
    }
    judged = {name: rows["judged"] == words for name, words in ROUTE_NAMES.items()}
    elsewhere = _made_otherwise(claims).loc[rows.index]
    simulation = agrees["as_published"] & elsewhere
    printed = agrees["from_print"] & ~agrees["as_published"]
    counted = {
        "exact": agrees["exact"] & ~elsewhere,
        "simulation": simulation,
        "simulation_reproduced": simulation & (rows["verdict"] == REPRODUCED.name),
        "print": printed & judged["from_print"],
        "print_elsewhere": printed & ~judged["from_print"] & ~agrees["exact"],
        "table_3_from_table_1": agrees["from_print"] & (rows["id"].map(part_of) == "table3"),
    }
    return {name: int(rows_of.sum()) for name, rows_of in counted.items()}


def free_choices(case: Case) -> dict[str, dict[str, Any]]:
    """List the rules of the configuration that were chosen in view of the printed digits and are not null.

    continuous : the step.   discrete : all others; the sample at which a begins is one for each level. The decimals of
    `tabulated` are those that Table 1 prints, and no choice; its other rules are those of `two_point`.
    """
    numerics = case.numerics
    starts = {f"slip_samples.{level}": n for level, n in enumerate(numerics.slip_samples or (), 1)}
    rules = {
        "scheme": numerics.scheme,
        "cycles": numerics.cycles,
        "c_over_m_decimals": numerics.c_over_m_decimals,
        "k_over_m_decimals": numerics.k_over_m_decimals,
        **starts,
        **{k: rule for k, rule in numerics.tabulated.items() if not k.endswith("_decimals")},
        **numerics.two_point,
        "phase": case.phase,
        "sign": "plus",
    }
    discrete = {name: rule for name, rule in rules.items() if rule is not None}
    return {"continuous": {"step_s": numerics.step_s}, "discrete": discrete}


def inputs_of_table_3(case: Case, numbers: Numbers) -> dict[str, Any]:
    """Move each input behind Table 3 by its smallest step and count the printed numbers that are then missed.

    moved : input → numbers missed with the input one step less and one step more, or with the other sign.
    moved_X : the fewest and the most that a step of one X misses.
    inputs : their number.   given : numbers of Table 3 that the inputs give.
    given_by_exact_X : those given with X read off the exact solution by the same rule.

    numbers : with what is printed (`numbers.with_claims`).
    """
    rules, omega = ReadOut.from_config(case.numerics.two_point), case.omega("omega1")
    exact, unrounded = (
        features_of(numbers, route, "omega1", omega) for route in ("exact", "unrounded")
    )
    read = rules.common(unrounded)
    table_3 = {
        key: Printed(row["printed"])
        for key, row in numbers.items()
        if row["printed"] and (key.kind, key.sharing) == ("pair", "common")
    }

    def given(features: Features, minus: bool = False) -> int:
        """Return how many numbers of Table 3 the features give."""
        table = of_estimates("omega1", estimates(features, features, replace(case, pairs=PAIRS)))
        count = 0
        for key, of_print in table_3.items():
            row = CORRECTED if minus and key.approach == "V_s" else key.approach
            value = table.get(key._replace(approach=row), math.nan)
            count += bool(abs(value - of_print.value) <= HALF * of_print.unit)
        return count

    def with_X(X: np.ndarray) -> Features:
        return read.replaced(X=X, X_s=read.X_s - (X - read.X))

    def missed(*moved: Features) -> list[int]:
        return [len(table_3) - given(features) for features in moved]

    def unit(decimals: int | None, usual: int) -> float:
        return 10.0 ** -(usual if decimals is None else decimals)

    X_unit, mark = unit(rules.X_decimals, 6), rules.X_s_mark or 1e-6
    steps: Mapping[str, tuple[str, float]] = {
        "X + X_s": ("X_s", mark),
        "t_s": ("t_s", unit(rules.common_t_s_decimals, 4)),
        "phi": ("phi", unit(rules.common_phi_decimals, 3)),
    }
    moved = {
        f"X_{level}": missed(*(with_X(read.X + sign * X_unit * axis) for sign in (-1.0, 1.0)))
        for level, axis in enumerate(np.eye(len(read)), 1)
    }
    for name, (field, step) in steps.items():
        values = (getattr(read, field) + sign * step for sign in (-1.0, 1.0))
        moved[name] = missed(*(read.replaced(**{field: value}) for value in values))
    moved["sign"] = [len(table_3) - given(read, minus=True)]
    return {
        "inputs": len(moved),
        "moved": moved,
        "moved_X": [end(end(moved[f"X_{n + 1}"]) for n in range(len(read))) for end in (min, max)],
        "given": given(read),
        "given_by_exact_X": given(with_X(rules.apply(exact).X)),
    }
