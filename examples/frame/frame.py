"""Identify the friction of a base-driven frame at four loads, and predict cycles that were not used.

Run it as `python frame.py DATA RESULTS`, two folders.

A plate on leaf springs rubs against a wall that stands still. The friction force against the speed comes from the loops
of the first five cycles of each record, by two laws that do the same work in a cycle:

    constant   F = F_k
    linear     F = F_0 + F_1 |ẋ|,   F_0 = F_k − F_1 ∮ẋ² dt / ∮|ẋ| dt,   F_1 by least squares where the plate slides

The other five cycles are predicted from their initial displacement and velocity and from the measured base motion.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import jinja2
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from dampbalance import Result, friction_loops, identify, read_records

LOADS = {f"{g} g": g / 1000.0 for g in (250, 350, 450, 550)}  # kg
# N/m, kg, N s/m and Hz: nominal values, from the script of the authors of the records
STIFFNESS, MASS, DAMPER, DRIVE = 1191.0, 3.0799, 0.669, 1.001
CYCLES = 5  # half of each record
GRAVITY = 9.80665  # m/s²
SLIDING = 0.25  # of the largest speed: the ends of slip, where 31 harmonics ring, are left out
DRIFTS = 3.2  # standard errors: 5 % for four records together (Bonferroni), by Student's t of eight degrees of freedom
STEPS = 40  # of a sample, 0.1 ms: the error of a predicted displacement is 1.4e-3 of its amplitude


def records_in(folder: Path) -> dict[str, pd.DataFrame]:
    """Return the records by their load: base_displacement_m and displacement_m, indexed by the time in s."""
    records = {}
    for load in LOADS:
        name = f"s_b_{load.replace(' ', '')}"
        channels = {
            "base_displacement": {"file": f"{name}_y.mat", "channel": "y", "unit": "mm"},
            "displacement": {"channel": "x", "unit": "mm"},
        }
        mapping = {"channels": channels, "time": {"channel": "t", "unit": "s"}, "level": load}
        (record,) = read_records(folder / f"{name}_x.mat", mapping=mapping)
        records[load] = record.to_frame()
        records[load].attrs["name"] = load
    return records


def halves_of(record: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the first cycles of a record, with the sample that ends the last of them, and the cycles that follow."""
    t, period = record.index, 1.0 / DRIVE
    middle = t[0] + CYCLES * period
    end = middle + 2.0 * (t[1] - t[0])
    return record[t < end], record[(t >= middle) & (t < middle + CYCLES * period)]


def identified(records: dict[str, pd.DataFrame]) -> Result[Any]:
    """Identify a friction force for each record by direct integration of the energy balance; the damper is given."""
    return identify(
        list(records.values()),
        stiffness=STIFFNESS,
        mass=MASS,
        frequency=DRIVE,
        terms="F_k,c_r",
        given={"c_r": DAMPER},
        groups={"F_k": list(records)},
    )


def line_through(forces: list[float]) -> dict[str, Any]:
    """Return the straight line through friction forces, N, over the load, with intervals of 95 % by Student's t."""
    load = np.array([*LOADS.values()])
    line = stats.linregress(load, forces)
    reach = stats.t.ppf(0.975, load.size - 2) * np.array([-1.0, 1.0])
    return {
        "slope_N_per_kg": line.slope,
        "slope_interval_N_per_kg": (line.slope + reach * line.stderr).tolist(),
        "intercept_N": line.intercept,
        "intercept_interval_N": (line.intercept + reach * line.intercept_stderr).tolist(),
        "coefficient": line.slope / GRAVITY,
        "off_line": (1.0 - (line.intercept + line.slope * load) / forces).tolist(),
    }


def loop_in_slip(loop: pd.DataFrame) -> tuple[NDArray[Any], NDArray[Any], float]:
    """Return speed and friction force where the plate slides, and the level taken off the force so that friction does
    the same work in both directions: a record does not determine the zeros of its transducers."""
    v, f = loop["v_m_per_s"].to_numpy(), loop["f_N"].to_numpy()
    level = float(np.average(f, weights=np.abs(v)))
    sliding = np.abs(v) > SLIDING * np.abs(v).max()
    return np.abs(v[sliding]), (np.sign(v) * (f - level))[sliding], level


def speed_law(loop: pd.DataFrame, F_k: float) -> tuple[float, float]:
    """Return F_0, N, and F_1, N s/m, of the linear law that does the work of F_k."""
    speed, force, _ = loop_in_slip(loop)
    v = loop["v_m_per_s"].to_numpy()
    mean = float(v @ v / np.abs(v).sum())
    F_1 = float((speed - mean) @ (force - F_k) / ((speed - mean) @ (speed - mean)))
    return F_k - F_1 * mean, F_1


def predicted(record: pd.DataFrame, d: float, v: float, F_0: float, F_1: float) -> NDArray[Any]:
    """Return the displacement under the measured base motion, m, from the first sample and its velocity v, m/s.

    d : difference of the zeros of the transducers, m.

    Each step first applies springs and damper, then friction, which stops the plate but never reverses it (time
    stepping for a rigid contact, Moreau 1988; error in proportion to the step).
    """
    t, x = record.index.to_numpy(), float(record["displacement_m"].iloc[0])
    times = np.linspace(t[0], t[-1], STEPS * (t.size - 1) + 1)
    step = times[1] - times[0]
    y = np.interp(times, t, record["base_displacement_m"])
    w = np.interp(times, t, np.gradient(record["base_displacement_m"], t))
    out = [x]
    for base, speed in zip(y[1:].tolist(), w[1:].tolist(), strict=True):
        free = v + step * (STIFFNESS * (base - x + d) - DAMPER * (v - speed)) / MASS
        v = np.copysign(max(abs(free) - step * (F_0 + F_1 * abs(free)) / MASS, 0.0), free)
        x += step * v
        out.append(x)
    return np.array(out[::STEPS])


def held_out(
    first: pd.DataFrame, second: pd.DataFrame, loop: pd.DataFrame, F_k: float
) -> dict[str, NDArray[Any]]:
    """Return the displacement of the second cycles, m, as each law predicts it, and that of the first, repeated."""
    x = first["displacement_m"]
    period = first.index < first.index[0] + CYCLES / DRIVE
    zero = (x - first["base_displacement_m"])[period].mean() - loop_in_slip(loop)[2] / STIFFNESS
    start = np.gradient(second["displacement_m"], second.index)[0]
    return {
        "constant": predicted(second, zero, start, F_k, 0.0),
        "linear": predicted(second, zero, start, *speed_law(loop, F_k)),
        "repeated": np.interp(second.index - CYCLES / DRIVE, x.index, x),
    }


def results_of(
    records: dict[str, pd.DataFrame],
) -> tuple[dict[str, Any], Result[Any], dict[str, Any]]:
    """Return all numbers of the page, the identification of whole records, and the predictions by their load."""
    whole = identified(records)
    halves = {load: halves_of(record) for load, record in records.items()}
    early, late = (identified({load: h[i] for load, h in halves.items()}) for i in (0, 1))
    loops, motions = friction_loops(early, MASS), {}
    rows: list[dict[str, Any]] = []
    for load, (first, second) in halves.items():
        key, x = f"F_k[{load}]", second["displacement_m"].to_numpy()
        verdict, F_k = whole.verdicts[key], early.values[key]
        # of the scatter alone: what a distorted drive does to both is no drift
        errors = [half.estimates["direct"].standard_errors[key] for half in (early, late)]
        motions[load] = held_out(first, second, loops[load], F_k)
        speed, force, _ = loop_in_slip(loops[load])
        rows.append(
            {
                "load": load,
                "F_k_N": whole.values[key],
                "interval_N": list(whole.intervals[key]),
                "verdict": verdict.verdict,
                "within": verdict.within,
                "reason": verdict.reason,
                "halves_N": [F_k, late.values[key]],
                "halves_error_N": errors,
                "drifts": abs(late.values[key] - F_k) > DRIFTS * math.hypot(*errors),
                "F_0_N": speed_law(loops[load], F_k)[0],
                "F_1_N_s_per_m": speed_law(loops[load], F_k)[1],
                "off_in_slip": float(np.sqrt(np.average((force / F_k - 1.0) ** 2, weights=speed))),
                "rms": {
                    law: float(np.sqrt(np.mean((of - x) ** 2)) / (0.5 * np.ptp(loops[load]["x_m"])))
                    for law, of in motions[load].items()
                },
            }
        )
    numbers = {"line": line_through([row["F_k_N"] for row in rows]), "loads": rows}
    return numbers | {"limits": whole.in_sentences(whole.findings)}, whole, motions


def draw(
    numbers: dict[str, Any], records: dict[str, pd.DataFrame], motions: dict[str, Any], file: Path
) -> None:
    """Draw the friction force against the load, and the first cycles that were predicted at each load."""
    plt.rcParams["svg.hashsalt"] = "frame"  # the same bytes each time
    figure, axes = plt.subplots(1, 1 + len(LOADS), figsize=(12.0, 3.0), layout="constrained")
    load, line = np.array([0.0, *LOADS.values()]), numbers["line"]
    F_k = np.array([row["F_k_N"] for row in numbers["loads"]])
    ends = np.array([row["interval_N"] for row in numbers["loads"]]).T
    axes[0].errorbar(load[1:], F_k, yerr=np.abs(ends - F_k), fmt="o", capsize=2.0)
    axes[0].plot(load, line["intercept_N"] + line["slope_N_per_kg"] * load, color="0.6")
    axes[0].set(xlabel="load (kg)", ylabel="$F_k$ (N)")
    for panel, (name, of) in zip(axes[1:], motions.items(), strict=True):
        second = halves_of(records[name])[1]
        t = second.index - second.index[0]
        panel.plot(t, 1e3 * second["displacement_m"], "k", label="measured")
        for law in ("constant", "linear"):
            panel.plot(t, 1e3 * of[law], "--", label=f"predicted, {law} friction")
        panel.set(xlabel="time (s)", ylabel="$x$ (mm)", title=name, xlim=(0.0, 2.0 / DRIVE))
    figure.legend(*axes[-1].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def main(data: Path, results: Path) -> None:
    """Write page, numbers and pictures."""
    records = records_in(data)
    numbers, whole, motions = results_of(records)
    whole.save(results / "identification", overwrite=True)
    draw(numbers, records, motions, results / "frame.svg")
    (results / "frame.json").write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")
    template = Path(__file__).with_name("frame.md.j2").read_text(encoding="utf-8")
    environment = jinja2.Environment(
        trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    page = environment.from_string(template).render(**numbers, files=whole.document()["records"])
    (results / "frame.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
