"""How much of the information in records `identify` uses: many records of the same truths against the Cramér–Rao bound.

The truths are the paper's oscillator at its three frequencies and five levels, base displacement and displacement being
measured. The bound knows neither the mass nor the phase, the amplitude and the offsets of any record.
"""

from __future__ import annotations

import itertools
import math

import pandas as pd

from dampbalance import BaseMotion, Oscillator
from dampbalance.identification.forced import identify_readings
from dampbalance.project.wording import markdown_table
from dampbalance.signals.mean_harmonics import read_features
from dampbalance.studies.bound import fit_at_truth
from paper_case import FREQUENCIES_HZ, LEVELS, PAPER

from .records import levels, records
from .score import HELD, SYMBOLS, held, numbers
from .truths import NOISE, SEED, Truth

_PER_CYCLE, _CYCLES = 100.37, 100.0
_POWERS = {"K_z": -0.5}

TRUTHS = [
    Truth(
        index=index,
        kind="model",
        m=PAPER.m,
        c=PAPER.c,
        k=PAPER.k,
        K_z=PAPER.K_z,
        F_k=PAPER.F_k,
        Y=tuple(LEVELS),
        omega=2.0 * math.pi * hertz,
        cycles=(_CYCLES,) * len(LEVELS),
        start=(0.0,) * len(LEVELS),
        rate_hz=_PER_CYCLE * hertz,
        drive="base_displacement",
        answers=("displacement",),
        noise=noise,
        equal=equal,
    )
    for index, (hertz, noise, equal) in enumerate(
        itertools.product(FREQUENCIES_HZ.values(), NOISE, (False, True))
    )
]


def replicate(run: tuple[int, int]) -> list[dict[str, object]]:
    """Return rows of one drawing of the noise, as of `score.outcome`.   run : place in TRUTHS, and number."""
    place, drawing = run
    truth = TRUTHS[place]
    measurements = records(truth, (SEED, drawing))
    result = identify_readings([read_features(one, truth.k) for one in measurements], truth.k)
    own = {"truth": place, "replicate": drawing}
    return [own | row for row in numbers(result, truth)]


def bound(truth: Truth) -> dict[str, float]:
    """Return standard errors that no unbiased estimate falls below, by symbol, SI; the mass is not known."""
    oscillator = Oscillator(truth.m, truth.c, truth.k, truth.K_z, truth.F_k)
    # the errors of a Fourier coefficient of n samples: σ √(2/n)
    part = math.sqrt(2.0 / round(_CYCLES * truth.rate_hz * 2.0 * math.pi / truth.omega))
    errors = [
        (part * level.sigma("base_displacement"), part * level.sigma("displacement"))
        for level in levels(truth)
    ]
    fit = fit_at_truth(oscillator, [BaseMotion(Y, truth.omega) for Y in truth.Y], errors, given=())
    assert fit is not None  # the paper's oscillator slips at every level
    return dict(zip(SYMBOLS, (fit.error("F_k"), fit.error("c"), fit.K_z_error), strict=True))


def table(rows: pd.DataFrame) -> str:
    """Return efficiency (variance of the bound over the mean square error), bias in standard errors, and coverage.

    Those of K_z are of K_z^{−1/2}, in which it is nearly normal; 0 stands for a lower limit.
    """
    drawn = rows["replicate"].nunique()
    heads = ["Hz", "noise, %", "of levels", "approach", "efficiency, %: F_k / c / K_z", "bias"]
    heads += ["coverage, %", "without K_z"]
    lines = []
    chosen = _in_bounds(rows[rows["approach"].isin(HELD)])
    for (place, approach), group in chosen.groupby(["truth", "approach"]):
        truth = TRUTHS[int(place)]
        hertz, levels = truth.omega / (2 * math.pi), "equal" if truth.equal else "relative"
        drawing = (f"{hertz:.4g}", f"{100 * truth.noise:g}", levels)
        lines.append([*drawing, approach, *_cells(group)])
    for approach, group in chosen.groupby("approach"):
        lines.append(["all", "", "", approach, *_cells(group)])
    return (
        f"{drawn} drawings of each: an efficiency is good to {100 * math.sqrt(2 / drawn):.0f} % of itself, a bias to "
        f"{1 / math.sqrt(drawn):.2f} standard errors, a coverage to {100 * math.sqrt(0.05 * 0.95 / drawn):.1f} %.\n\n"
        f"{markdown_table(heads, lines)}\n"
    )


def _in_bounds(rows: pd.DataFrame) -> pd.DataFrame:
    """Return rows with their error in standard errors of the bound (size), and whether the interval holds the truth."""
    rows = rows.copy()
    bounds = {place: bound(TRUTHS[place]) for place in rows["truth"].unique()}
    power = rows["symbol"].map(_POWERS).fillna(1.0)
    least = [bounds[i].get(s, math.nan) for i, s in zip(rows["truth"], rows["symbol"], strict=True)]
    error = rows["value"] ** power - rows["true"] ** power
    rows["size"] = error / (least * power.abs() * rows["true"] ** (power - 1.0))
    return rows.assign(held=held(rows))


def _cells(group: pd.DataFrame) -> list[str]:
    """Return efficiency, bias and coverage of F_k, c and K_z, and how often there is no K_z."""
    shown = []
    for symbol in SYMBOLS:
        part = group[(group["symbol"] == symbol) & group["value"].notna()]
        size, share = part["size"], 100 * part["held"].mean()
        three = f"{100 / (size**2).mean():.0f} {size.mean() / size.std():+.2f} {share:.0f}"
        shown.append(["–", "–", "–"] if part.empty else three.split())
    K_z = group.loc[group["symbol"] == "K_z", "value"]
    return [*map(" / ".join, zip(*shown, strict=True)), f"{int(K_z.isna().sum())} of {len(K_z)}"]
