"""Another way from measurements to F_k, c and K_z, on three sets of the blind set, compared with `identify`.

It is what many would write: simulate the records with `solve_ivp` until the motion repeats, and let
`scipy.optimize.least_squares` fit m, c, F_k and K_z to all samples, from a start 30 % off. It is given the frequency.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

from dampbalance.identification.forced import identify_readings
from dampbalance.project.wording import markdown_table
from dampbalance.records.record import Record
from dampbalance.signals.mean_harmonics import read_features

from .records import records
from .score import HELD, SYMBOLS, numbers
from .truths import Truth, draw

SETS = (198, 424, 485)
"""Displacement and base displacement, 1 % noise, one slip per half cycle: ζ = 0.43, 0.13 and 0.025."""

Found = dict[str, tuple[float, float]]
"""Value and standard error by symbol, SI; NaN for what a way cannot tell."""

_STEADY = 1e-5  # of the displacement: change over a period at which the simulation stops
_MOST_PERIODS = 400
_RTOL, _POINTS = 1e-6, 2000
_OFF = np.array([1.3, 0.7, 1.3, 0.7])  # the start of m, c, F_k, K_z, over the truth


def simulated(
    p: np.ndarray, k: float, omega: float, drive: complex, phase: np.ndarray
) -> np.ndarray:
    """Return steady x of one level at phases ωt under y = Re(drive e^{iωt})."""
    m, c, F_k, K_z = p
    Y, lead, Z_m = abs(drive), math.atan2(drive.imag, drive.real), F_k / K_z

    def rate(t: float, q: np.ndarray) -> tuple[float, float, float]:
        x, v, z = q
        moves = abs(z) < Z_m or z * v < 0.0
        z = min(max(z, -Z_m), Z_m)
        force = k * Y * math.cos(omega * t + lead) - c * v - k * x - K_z * z
        return v, force / m, v if moves else 0.0

    period = 2.0 * math.pi / omega
    q, grid = np.zeros(3), np.linspace(0.0, period, _POINTS + 1)
    for _ in range(_MOST_PERIODS):
        options = {"rtol": _RTOL, "atol": 1e-9 * Y, "max_step": period / 50}
        run = solve_ivp(rate, (0.0, period), q, t_eval=grid, **options)
        after = run.y[:, -1]
        after[2] = min(max(after[2], -Z_m), Z_m)
        change, q = abs(after[0] - q[0]), after
        if change < _STEADY * np.abs(run.y[0]).max():
            break
    return np.interp(np.mod(phase, 2.0 * math.pi), omega * grid, run.y[0])


def simulated_fit(truth: Truth, measured: list[Record]) -> Found:
    """Return all samples fitted by a simulation."""
    parts = []
    for one in measured:
        phase = truth.omega * one["base_displacement"].t
        turn = np.exp(1j * phase)
        columns = np.column_stack([turn.real, -turn.imag, np.ones(turn.size)])
        y = np.linalg.lstsq(columns, one["base_displacement"].values, rcond=None)[0]
        x = one["displacement"].values
        parts.append((complex(y[0], y[1]), phase, x - x.mean()))

    def residuals(p: np.ndarray) -> np.ndarray:
        off = []
        for drive, phase, x in parts:
            model = simulated(p, truth.k, truth.omega, drive, phase)
            off.append((model - model.mean() - x) / x.std())
        return np.concatenate(off)

    start = np.array([truth.m, truth.c, truth.F_k, truth.K_z]) * _OFF
    fit = least_squares(
        lambda p: residuals(p * start), np.ones(4), bounds=(0.01, 100.0), diff_step=1e-3
    )
    variance = 2.0 * fit.cost / (fit.fun.size - start.size)
    errors = np.sqrt(variance * np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))
    _, c, F_k, K_z = zip(fit.x * start, errors * start, strict=True)
    return {"F_k": F_k, "c": c, "K_z": K_z}


def identified(approach: str) -> Callable[[Truth, list[Record]], Found]:
    """Return an approach of `identify`."""

    def run(truth: Truth, measured: list[Record]) -> Found:
        result = identify_readings([read_features(one, truth.k) for one in measured], truth.k)
        rows = [row for row in numbers(result, truth) if row["approach"] == approach]
        return {row["symbol"]: (row["value"], row["standard_error"]) for row in rows}

    return run


def compared(index: int) -> list[dict[str, object]]:
    """Return rows of the ways on one set."""
    truth = draw(index)
    measured = records(truth)
    ways = {f"identify, {approach}": identified(approach) for approach in HELD}
    next(iter(ways.values()))(truth, measured)  # compiles its kernels
    ways["simulated response, least_squares"] = simulated_fit
    rows: list[dict[str, object]] = []
    for name, way in ways.items():
        began = time.process_time()
        found = way(truth, measured)
        lasted = time.process_time() - began
        for symbol in SYMBOLS:
            value, error = found.get(symbol, (math.nan, math.nan))  # the check has no K_z
            row = {"set": index, "way": name, "seconds": lasted, "symbol": symbol}
            row |= {"true": truth.parameter(symbol), "value": float(value)}
            rows.append(row | {"standard_error": float(error)})
    return rows


def table(rows: pd.DataFrame) -> str:
    """Return Error ± standard error in %, and processor time, in markdown."""
    lines = []
    for (index, way), group in rows.groupby(["set", "way"], sort=False):
        truth = draw(int(index))
        cells = []
        for symbol in SYMBOLS:
            row = group[group["symbol"] == symbol].iloc[0]
            error, scale = row["value"] / row["true"] - 1.0, row["standard_error"] / row["true"]
            known = math.isfinite(row["value"])
            cells.append(f"{100 * error:+.2g} ± {100 * scale:.2g} %" if known else "none")
        named = f"{index}: ζ = {truth.zeta:.2g}, K_z/k = {truth.K_z / truth.k:.2g}"
        lines.append([named, way, *cells, f"{group['seconds'].iloc[0]:.2g}"])
    return markdown_table(["set", "way", *SYMBOLS, "processor time, s"], lines) + "\n"
