"""How far the axes of a study reach together: what cannot be solved, or held in memory, is refused."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from ..project.documents import Problem
from ..replication.feasibility import MOST_EVENTS, RANGES
from .axes import Listed
from .parameters import MECHANICAL, PARAMETERS, in_si
from .plan import PART, columns_of
from .settings import Study

MOST_SAMPLES = 1_000_000
"""Samples of a record that is read; the reader holds a few arrays as long."""

MOST_STEPS = 100_000_000
"""Steps of one simulation: about a second."""

MOST_NUMBERS = 200_000_000
"""Numbers that a job holds at a time: cases × columns, or × replicates × levels × features."""

_FEATURES = 20  # of a replicate


def extent(study: Study, name: str) -> tuple[float, float]:
    """The least and the largest value of a parameter, whether it is fixed or an axis."""
    if name in study.fixed:
        return (float(study.fixed[name]),) * 2
    block = next(block for block in study.blocks if name in block.names)
    if isinstance(block, Listed):
        values = [float(value) for value in block.values[name]]
        return min(values), max(values)
    return block.ranges[name].low, block.ranges[name].high


def wrong_sizes(study: Study) -> Iterator[Problem]:
    """What is too much: the numbers at the corners of the box that the axes span, the records, the chunks."""
    given = [name for name in MECHANICAL if name in (*study.fixed, *study.axis_names)]
    corners = np.array(list(product(*(extent(study, name) for name in given)))).T
    si = in_si(dict(zip(given, corners, strict=True)))
    omega_n = np.sqrt(si["k"] / si["m"])
    groups = {
        "zeta": 0.5 * si["c"] / (si["m"] * omega_n),
        "K_z_over_k": si["K_z"] / si["k"],
        "omega_over_omega_n": si["omega"] / omega_n,
    }
    for name, values in groups.items():
        low, high = RANGES[name]
        wrong = values[(values > high) | ((values < low) & (values > 0.0))]
        if wrong.size:
            text = f"reach to {PARAMETERS[name].meaning} = {wrong[0]:.3g}; the exact solution holds"
            yield ("axes",), f"{text} from {low:g} to {high:g}"
    events = np.max(np.sqrt(1.0 + groups["K_z_over_k"]) / groups["omega_over_omega_n"])
    if events > MOST_EVENTS:
        text = (
            f"reach to a natural frequency on the contact of {events:.3g} times that of the drive"
        )
        yield ("axes",), f"{text}; {MOST_EVENTS:g} at most can be solved"
    yield from _long_records(study, 2.0 * np.pi / float(np.min(si["omega"])))
    yield from _large_chunks(study)


def _long_records(study: Study, period: float) -> Iterator[Problem]:
    """period : the longest of the drive, s."""
    for name in ("step_s", "steps_per_cycle", "sampling_hz"):
        if study.route == "exact" or name not in (*study.fixed, *study.axis_names):
            continue
        low, high = extent(study, name)
        samples = {"step_s": period / low, "sampling_hz": period * high}.get(name, high)
        kept, most = (
            (3, MOST_STEPS) if study.route == "fixed_step" else (study.cycles, MOST_SAMPLES)
        )
        if samples * kept > MOST_SAMPLES or samples * study.cycles > most:
            text = f"{name} makes records of {samples * study.cycles:.3g} samples"
            yield ("route",), f"{text}; take fewer cycles, or samples further apart"


def _large_chunks(study: Study) -> Iterator[Problem]:
    held = len(columns_of(study))
    if study.route == "measured":
        held = max(held, study.replicates * len(study.levels) * _FEATURES)
    part = min(study.chunk_cases, study.cases, PART)
    if part * held > MOST_NUMBERS:
        enough = max(1, MOST_NUMBERS // held)
        text = f"{part:,} cases at a time do not fit in memory; take {enough:,} at most"
        yield ("chunk_cases",), text
