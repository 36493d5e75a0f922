"""Measured loops of contacts on a test machine, from time stepping that uses nothing of the package.

The contacts are Jenkins's element, one behind a backlash, those of `gradual.py`, and a slider whose friction falls with
the speed (Stribeck). Motions are sines of one or two amplitudes and triangles; forces have an offset, a drift, noise of
1 % and, of a half of them, the other sign.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from numba import njit

from dampbalance import identify_loops
from dampbalance.project.wording import markdown_table

from .gradual import CONTACTS as GRADUAL
from .other_motion import moved, one_slider
from .truths import log_uniform

_LOOPS = 46  # so that the draws are not those of other sets
CONTACTS = ("Jenkins", "backlash", "triangle", "Stribeck", *GRADUAL)
NOISE = 0.01
_FINE = 8  # steps of the generator for each sample
# of a number that is called usable: further off, and outside of its interval, is silent
_WRONG = 0.05


@njit(cache=True)
def _followed(x, step, elements, gap, falling, speed):
    """Return the force of elements that follow x after a backlash of ± gap, friction higher at rest by a part."""
    forces, force, z = np.zeros(len(elements)), np.zeros(x.size), 0.0
    for i in range(1, x.size):
        dx, before = x[i] - x[i - 1], z
        if gap > 0.0:
            reach = elements[0, 1] / elements[0, 0] + gap
            z = min(max(z + dx, -reach), reach)
            dx = math.copysign(max(abs(z) - gap, 0.0), z)
            dx -= math.copysign(max(abs(before) - gap, 0.0), before)
        higher = 1.0 + falling * math.exp(-((dx / step / speed) ** 2))
        for j in range(len(elements)):
            K, F, kind = elements[j]
            forces[j] = moved(forces[j], dx, (K, higher * F, kind))
        force[i] = forces.sum()
    return force


def _force(contact: str, x: np.ndarray, step: float, F: float, K: float, X: float) -> np.ndarray:
    """Return the force of a contact by time stepping, N."""
    elements = GRADUAL.get(contact, one_slider)(K, F)
    gap, falling = 0.1 * X * (contact == "backlash"), 0.4 * (contact == "Stribeck")
    return _followed(x, step, elements, gap, falling, 0.3 * X * 2.0 * math.pi)


def outcome(run: tuple[int, int]) -> list[dict[str, object]]:
    """Identify one set, by its number and the seed; a row for each number."""
    index, seed = run
    rng = np.random.default_rng([_LOOPS, seed, index])
    contact = CONTACTS[index % len(CONTACTS)]
    spread = log_uniform(rng)
    F, X = spread(1.0, 1e4), spread(1e-4, 1e-2)
    Z = X * rng.uniform(0.1, 0.3)
    K, hertz = F / Z, spread(0.5, 5.0)
    k = rng.uniform(0.0, 0.2) * F / X
    c = rng.uniform(0.02, 0.2) * F / (2.0 * math.pi * hertz * X)
    c *= contact != "triangle"
    levels = [X] if rng.random() < 0.5 or contact == "triangle" else [X, 0.6 * X]
    records = []
    for level in levels:
        rate, cycles = rng.integers(200, 500), rng.integers(12, 30)
        turn = np.arange(rate * cycles * _FINE) / (rate * _FINE)
        shape = np.cos(2.0 * math.pi * turn)
        if contact == "triangle":
            shape = 2.0 * np.arcsin(shape) / math.pi
        x, step = level * shape, 1.0 / (hertz * rate * _FINE)
        f = _force(contact, x, step, F, K, X) + k * x + c * np.gradient(x, step)
        f, x, t = (of[::_FINE] for of in (f, x, turn / hertz))
        f = f + F * (rng.normal() * 0.3 + rng.normal() * 0.05 * t / t[-1])
        f = f + NOISE * F * rng.normal(size=f.size)
        sign = rng.choice([-1.0, 1.0])
        records.append({"time_s": t, "displacement_m": x, "force_N": sign * f})
    found = identify_loops(records)
    truths = {"F_k": F, "c": c, "K_z": K}
    if contact == "triangle":
        del truths["c"]
    rows: list[dict[str, object]] = []
    for symbol, true in truths.items():
        value, (low, high) = found.values[symbol], found.intervals[symbol]
        verdict, inside = found.verdicts[symbol].verdict, low <= true <= high
        error = value / true - 1.0
        row: dict[str, object] = {"set": index, "contact": contact, "symbol": symbol}
        row |= {"true": true, "value": value, "error": error, "inside": inside, "verdict": verdict}
        rows.append(row | {"silent": verdict == "usable" and not inside and abs(error) > _WRONG})
    return rows


def table(rows: pd.DataFrame) -> str:
    """Return the table of contacts and numbers: median and 95th percentile of the error, coverage, silent errors."""
    lines = []
    for (contact, symbol), own in rows.groupby(["contact", "symbol"], sort=False):
        valued = own[own["error"].notna()]
        size = 100.0 * valued["error"].abs()
        usable = valued[valued["verdict"] == "usable"]
        lines.append(
            [
                *(contact, symbol, str(len(own)), str(len(usable))),
                f"{size.median():.2f}",
                f"{size.quantile(0.95):.2f}",
                f"{100.0 * usable['inside'].mean():.0f}",
                str(int(own["silent"].sum())),
            ]
        )
    head = [
        "contact",
        "number",
        "sets",
        "usable",
        "median error, %",
        "95th, %",
        "inside, %",
        "silent",
    ]
    return markdown_table(head, lines)
