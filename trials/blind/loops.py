"""Measured loops of contacts on a test machine, from time stepping that uses nothing of the package.

The contacts are Jenkins's element, Iwan's distribution of them (uniform in the force at which each yields), Bouc and
Wen's model with n = 1 and 2, and a slider whose friction falls with the speed (Stribeck). Motions are sines of one or
two amplitudes and triangles; forces have an offset, a drift, noise of 1 % and, of a half of them, the other sign; a
fixture may have a backlash.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from dampbalance import identify_loops
from dampbalance.project.wording import markdown_table

_LOOPS = 46  # so that the draws are not those of other sets
CONTACTS = ("Jenkins", "backlash", "triangle", "Iwan", "Bouc-Wen 1", "Bouc-Wen 2", "Stribeck")
NOISE = 0.01
_FINE = 8  # steps of the generator for each sample
_WRONG = (
    0.05  # of a number that is called usable: further off, and outside of its interval, is silent
)


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a number whose logarithm is uniform."""
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def _force(contact: str, x: np.ndarray, step: float, F: float, K: float, X: float) -> np.ndarray:
    """Return the force of a contact by time stepping, N."""
    z, force = 0.0, np.empty(x.size)
    shares = (np.arange(60) + 0.5) / 30.0  # of Iwan: forces at which they yield over the mean one
    many, gap, speed = np.zeros(60), 0.1 * X, 0.3 * X * 2.0 * math.pi
    power = 2 if contact == "Bouc-Wen 2" else 1
    for i, dx in enumerate(np.diff(x, prepend=x[0])):
        if contact == "Iwan":
            many = np.clip(many + K * dx, -F * shares, F * shares)
            force[i] = many.mean()
        elif contact.startswith("Bouc"):
            # ż = ẋ (1 − |z|ⁿ (½ + ½ sgn(zẋ))), by the midpoint rule in small steps
            middle = z
            for part in (0.5, 1.0):
                grows = 0.5 + 0.5 * math.copysign(1.0, middle * dx)
                middle = z + part * K / F * dx * (1.0 - abs(middle) ** power * grows)
            z = middle
            force[i] = F * z
        elif contact == "backlash":
            reach = F / K + gap
            z = min(max(z + dx, -reach), reach)
            force[i] = K * math.copysign(max(abs(z) - gap, 0.0), z)
        else:
            top = F
            if contact == "Stribeck":
                top = F * (1.0 + 0.4 * math.exp(-((dx / step / speed) ** 2)))
            z = min(max(z + K * dx, -top), top)
            force[i] = z
    return force


def outcome(run: tuple[int, int]) -> list[dict[str, object]]:
    """Identify one set, by its number and the seed; a row for each number."""
    index, seed = run
    rng = np.random.default_rng([_LOOPS, seed, index])
    contact = CONTACTS[index % len(CONTACTS)]
    F, X = _log_uniform(rng, 1.0, 1e4), _log_uniform(rng, 1e-4, 1e-2)
    Z = X * rng.uniform(0.1, 0.3)
    K, hertz = F / Z, _log_uniform(rng, 0.5, 5.0)
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
