"""Reads the YAML file of a study, finds faults before anything runs, and chooses the figure of a file without one.

The schema (study.schema.yaml) says which keys there are, and what each may hold. This module checks
what takes more than one key to see: axes that contradict each other, a route that lacks a parameter, a figure
of something that the study does not have, numbers that cannot be solved or held in memory.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from ..balance import APPROACHES
from ..law.law import Law
from ..motion.orbit import MOST_EVENTS, RANGES
from ..project import wording
from ..project.documents import (
    ConfigurationError,
    KeyPath,
    Problem,
    against_schema,
    in_lines,
    read_schema,
    read_yaml,
)
from ..project.wording import shortened
from ..replication.fixed_step import MOST_STEPS
from .cases import PART, case_columns
from .parameters import PARAMETERS, STUDY_SCHEMA, in_si, mechanical, parameter, synonyms
from .study_file import PAPER_CASE, Listed, Sampled, Study, is_value, selected

MOST_POINTS = 50_000
"""Cases on the curves of a figure; more are drawn as a map."""

MOST_PANELS, MOST_AXIS_PLACES, MOST_GROUPS = 8, 500, 1000
"""Columns of panels, listed values along an axis of a map or a scatter, groups in a summary."""

MOST_SAMPLES_READ = 1_000_000
"""Samples of a record that is read; the reader holds a few arrays as long."""

MOST_NUMBERS = 200_000_000
"""Numbers that a job holds at a time: cases × columns, or × replicates × levels × features."""


def read_study(path: str | Path, paper: Mapping[str, Any] = PAPER_CASE) -> Study:
    """Return the study of a YAML file, named after the file.

    Without a figure, it gets the first of the usual ones that can be drawn. Its text is the template next to the
    file, NAME.md.j2, if there is one.

    paper : oscillator, frequency and levels that stand for what the study leaves out, as `paper_defaults` has them.

    Raises ConfigurationError listing every problem, a line each: file, key, what is wrong, what would be right.
    """
    document = read_yaml(path)
    if wrong := problems(document, read_schema(STUDY_SCHEMA), paper):
        raise ConfigurationError(in_lines(wrong, {str(path): document}))
    text = Path(path).with_suffix(".md.j2")
    study = Study.of(Path(path).stem, document, paper, text if text.exists() else None)
    return study if "figure" in document else with_usual_figure(study)


def with_usual_figure(study: Study, kind: str = "") -> Study:
    """Return the study with the first of the usual figures, of a kind where it is named, that can be drawn, if any."""
    figures = (figure for figure in _usual_figures(study) if kind in ("", figure["kind"]))
    drawn = (replace(study, figure=figure) for figure in figures)
    return next((figure for figure in drawn if not any(_wrong_figure(figure))), study)


def problems(
    document: Any, schema: Mapping[str, Any], paper: Mapping[str, Any]
) -> Sequence[Problem]:
    """Return everything that is wrong with a study's document, (key, text) each; nothing if it can be run.

    One kind after the other: what is wrong with the axes would make nonsense of what the figure refers to.
    """
    wrong = against_schema(document, schema, APPROACHES)
    for check in (_wrong_axes, _contradictions, _wrong_sizes, _wrong_references):
        wrong = wrong or list(check(document, Study.of("", document, paper)))
    return wrong


# --- axes, levels, route, estimation -----------------------------------------------------------------


def _wrong_axes(document: Mapping[str, Any], study: Study) -> Iterator[Problem]:
    """Yield ranges without extent, values that coincide or are not whole, and quantities that are set twice."""
    seen: list[str] = []
    for i, (over, block) in enumerate(zip(document["axes"], study.blocks, strict=True)):
        key: KeyPath = ("axes", i)
        if isinstance(block, Sampled):
            over, key = over["sample"]["over"], (*key, "sample", "over")
        for name, spec in over.items():
            values = study.values_of(name)
            if "from" in spec and spec["from"] >= spec["to"]:
                text = f"from must lie below to, got {spec['from']!r} and {spec['to']!r}"
                yield (*key, name), text
            elif len(set(values)) < len(values):
                text = f"its ends are too close for {len(values):,} different values; take fewer"
                yield (*key, name), text
            elif parameter(name).whole and any(value != int(value) for value in values):
                text = f"{parameter(name).meaning} must be whole numbers; list the values"
                yield (*key, name), text
            for other in (other for other in seen if other in synonyms(name)):
                reason = "twice" if other == name else f"together with {other}, the same quantity"
                yield ("axes", i), f"{name} is set {reason}; keep one"
            seen.append(name)
        sizes = {name: len(study.values_of(name)) for name in over}
        if len(set(sizes.values())) > 1:
            text = ", ".join(f"{name} has {size}" for name, size in sizes.items())
            yield key, f"paired axes need the same number of values: {text}"
    for section in ("base", "route", "read_out"):
        given = [name for name in document.get(section, {}) if name in PARAMETERS]
        for name in given:
            for other in (other for other in synonyms(name)[1:] if other in given and other > name):
                yield (section, name), f"not together with {other}; keep one"


def _contradictions(document: Mapping[str, Any], study: Study) -> Iterator[Problem]:
    """Yield what does not go together: levels, route, parameters, fits, terms of the balance."""
    estimation, route, used = document.get("estimation", {}), study.route, study.parameters
    given = {*document.get("base", {}), *study.axis_names} & {"Y_m", "F_k_over_kY"}
    if given and not study.levels_relative:
        text = "with Y_m or F_k_over_kY give the levels as multiples of Y_m: levels_of_Y: [1, 2, 3]"
        yield ("levels_m" if "levels_m" in document else "axes",), text
    for names in route.needs:
        if used.isdisjoint(names):
            yield ("route",), f"{route.kind} needs {' or '.join(names)}, here or as an axis"
    for name in sorted(used):
        if not route.takes(name):
            text = f"is not used by the route {route.kind}; leave it out, or take another route"
            yield _place(document, study, name), text
    for i, fit in enumerate(estimation.get("fits", [])):
        if fit != "least_squares" and max(fit) > len(study.levels):
            yield ("estimation", "fits", i), f"there are only {len(study.levels)} levels"
    for i, terms in enumerate(estimation.get("terms", [])):
        text = ""
        try:
            Law(tuple(terms)).require([1.0] * len(study.levels))  # a case has one frequency
        except ValueError as error:
            text = str(error)
        if not text and len(terms) > 2 and any(fit.levels for fit in study.fits):
            text = f"a pair of levels identifies two terms, not {len(terms)}: take fits: [least_squares]"
        if text:
            yield ("estimation", "terms", i), text


def _place(document: Mapping[str, Any], study: Study, name: str) -> KeyPath:
    """Return the key that sets a parameter, an axis before the other sections."""
    axes: list[KeyPath] = [
        ("axes", i, name) for i, of in enumerate(study.blocks) if name in of.axes
    ]
    sections = ("base", "route", "read_out")
    return [*axes, *((of, name) for of in sections if name in document.get(of, {}))][0]


# --- sizes -------------------------------------------------------------------------------------------


def _wrong_sizes(_: object, study: Study) -> Iterator[Problem]:
    """Yield what is too much: the numbers at the corners of the box that the axes span, the records, the chunks."""
    given = mechanical(study.parameters)
    corners = np.array(list(product(*map(study.extent, given)))).T
    si = in_si(dict(zip(given, corners, strict=True)))
    omega_n = np.sqrt(si["k"] / si["m"])
    stiffer, faster = si["K_z"] / si["k"], si["omega"] / omega_n
    groups = {"zeta": 0.5 * si["c"] / (si["m"] * omega_n), "K_z_over_k": stiffer}
    for name, values in (groups | {"omega_over_omega_n": faster}).items():
        low, high = RANGES[name]
        wrong = values[(values > high) | ((values < low) & (values > 0.0))]
        if wrong.size:
            text = f"reach to {parameter(name).meaning} = {wrong[0]:.3g}; the exact solution holds"
            yield ("axes",), f"{text} from {low:g} to {high:g}"
    events = np.max(np.sqrt(1.0 + stiffer) / faster)
    if events > MOST_EVENTS:
        times = f"{events:.3g} times that of the drive; {MOST_EVENTS:g} at most can be solved"
        yield ("axes",), f"reach to a natural frequency on the contact of {times}"
    # the longest record, of the longest period
    period, cycles = 2.0 * np.pi / float(np.min(si["omega"])), study.cycles
    kept, most = (
        (3, MOST_STEPS) if study.route.kind == "fixed_step" else (cycles, MOST_SAMPLES_READ)
    )
    for name in study.parameters.intersection(("step_s", "steps_per_cycle", "sampling_hz")):
        low, high = study.extent(name)
        samples = {"step_s": period / low, "sampling_hz": period * high}.get(name, high)
        if samples * kept > MOST_SAMPLES_READ or samples * cycles > most:
            text = f"{name} makes records of {samples * cycles:.3g} samples"
            yield ("route",), f"{text}; take fewer cycles, or samples further apart"
    each = len(case_columns(study))  # numbers in memory for a case
    if study.route.is_noisy:
        # 20 numbers of each replicate
        each = max(each, study.replicates * len(study.levels) * 20)
    part, enough = min(study.chunk_cases, study.cases, PART), max(1, MOST_NUMBERS // each)
    if part * each > MOST_NUMBERS:
        text = f"{part:,} cases at a time do not fit in memory; take {enough:,} at most"
        yield ("chunk_cases",), text


# --- what the summary and the figure refer to -----------------------------------------------------------


def _wrong_references(_: object, study: Study) -> Iterator[Problem]:
    """Yield what is no axis where it must be one, groups that are too many, and what the figure cannot show."""
    figure, phases = study.figure, study.figure.get("panels") == "phase"
    parts = ("x", "y") if phases and figure["kind"] == "curves" else ("x", "y", "panels")
    named: dict[KeyPath, str] = {("summary_by", i): axis for i, axis in enumerate(study.summary_by)}
    named |= {("figure", part): figure[part] for part in parts if part in figure}
    wrong = [key for key, name in named.items() if name not in study.axis_names]
    yield from ((key, f"{shortened(named[key])} is not an axis of this study") for key in wrong)
    if wrong:
        return
    groups = math.prod(block.count for block in map(study.block_of, study.summary_by) if block)
    if groups > MOST_GROUPS:
        text = f"{groups:,} groups are more than {MOST_GROUPS}; take axes of few values"
        yield ("summary_by",), text
    if figure:
        yield from _wrong_figure(study)


def _wrong_figure(study: Study) -> Iterator[Problem]:
    figure = study.figure
    kind, x, panels = figure["kind"], figure["x"], figure.get("panels")
    axes = {part: figure[part] for part in ("x", "y") if part in figure}
    undrawn = {part: text for part, name in axes.items() if (text := _not_drawn(study, name))}
    yield from ((("figure", part), text) for part, text in undrawn.items())
    if not study.fits_of(figure):
        yield ("figure",), "selects no fit of this study: see estimation"
    if x in (figure.get("y"), panels):
        part = "y" if "y" in figure else "panels"
        yield ("figure", part), f"{x} is the axis x already; take another"
    yield from wrong_selection(study, ("figure",), {"at": figure.get("at", {})})
    if kind == "curves" and study.cases > MOST_POINTS:
        text = f"{study.cases:,} cases are more than curves can show, {MOST_POINTS:,}; take a map"
        yield ("figure", "kind"), text
    if panels == "phase" and not any(fit.phase for fit in study.fits):
        yield ("figure", "panels"), "no approach of this study takes a phase; leave it out"
    elif panels not in (None, "phase") and not 0 < len(study.values_of(panels)) <= MOST_PANELS:
        text = f"{panels} must have {MOST_PANELS} listed values at most, a column of panels each"
        yield ("figure", "panels"), text


def _not_drawn(study: Study, name: str) -> str:
    """Return why the figure cannot be drawn along an axis; nothing if it can."""
    kind = study.figure["kind"]
    if parameter(name).is_word:
        return f"{name} has words as values: take an axis of numbers, and {name} for the panels"
    (low, high), values = study.extent(name), study.values_of(name)
    if not low < high:
        return f"{name} has one value; take an axis with two at least"
    if kind in ("map", "scatter") and len(values) > MOST_AXIS_PLACES:
        return f"{name} has more than {MOST_AXIS_PLACES} values; a {kind} shows no more"
    if kind == "scatter" and (low <= 0.0 or not values):
        return f"{name} must be listed values above zero: a scatter has a logarithmic axis"
    return ""


def _usual_figures(study: Study) -> Iterator[dict[str, Any]]:
    """Yield figures that suit the axes of a study, the most telling first, as its file would ask for them; some may be
    refused.

    Runs that differ by their noise: statistics of their errors along the noise, or another axis. One axis: curves along
    it. More: a map over the two with the most values, but where the others have few, curves along the longest with a
    panel for each value of the next; all further axes are then at the middle of their values.
    """
    # paired axes vary together: one of them stands for all
    blocks = [[*block.axes][: None if isinstance(block, Sampled) else 1] for block in study.blocks]
    values = {name: [*dict.fromkeys(study.values_of(name))] for names in blocks for name in names}
    sizes = {name: len(listed) or math.inf for name, listed in values.items() if len(listed) != 1}
    # more than six values are drawn along an axis, not as panels
    few = [name for name in sizes if sizes[name] <= 6]
    numbers = [name for name in sizes if not parameter(name).is_word]
    if study.route.is_noisy and "run" in sizes:
        for x in sorted(
            (name for name in numbers if name != "run"), key=lambda name: name != "noise"
        ):
            panels = ({"panels": name} for name in few if name not in (x, "run"))
            yield {"kind": "scatter", "x": x, **next(panels, {})}
    long = sorted(numbers, key=lambda name: -sizes[name])
    if len(long) > 1 and long[1] not in few:
        yield {"kind": "map", "x": long[0], "y": long[1]}
    if long:
        curves: dict[str, Any] = {"kind": "curves", "x": long[0]}
        if other := [name for name in few if name != long[0]]:
            at = {name: values[name][len(values[name]) // 2] for name in other[1:]}
            curves |= {"panels": other[0], **({"at": at} if at else {})}
        elif len({fit.phase for fit in study.fits} - {""}) > 1:
            curves["panels"] = "phase"
        yield curves


def wrong_selection(study: Study, key: KeyPath, spec: Mapping[str, Any]) -> Iterator[Problem]:
    """Yield what is wrong with the cases that a figure or a number selects by values of axes, or by bounds."""
    wrong = [
        ((*key, where, name), text)
        for where in ("at", "between")
        for name, wanted in spec.get(where, {}).items()
        if (text := _not_selected(study, name, wanted))
    ]
    yield from wrong
    axes = [block.axes for block in study.blocks if isinstance(block, Listed)]
    listed = [{name: np.asarray(values) for name, values in of.items()} for of in axes]
    if not wrong and not all(selected(values, spec).any() for values in listed):
        text = "paired axes vary together, and bounds must have a value between them"
        yield key, f"selects no case: {text}"


def _not_selected(study: Study, name: str, wanted: Any) -> str:
    """Return why cases cannot be chosen by a value of an axis, or by two bounds; nothing if they can."""
    if name not in study.axis_names:
        return "not an axis of this study"
    is_word, values = parameter(name).is_word, study.values_of(name)
    if isinstance(wanted, list):
        text = f"{shortened(wanted)} are not two bounds of {name}, the lower one first"
        return text if is_word or wanted[0] > wanted[1] else ""
    if is_word:
        text = f"{shortened(wanted)} is not among its values: {', '.join(map(str, values))}"
        return "" if wanted in values else text
    if isinstance(wanted, str):
        return f"{shortened(wanted)} is not a number"
    if not values:
        text = f"{wanted:g} is no value of {name}, which is sampled"
        return f"{text}: take the cases between two bounds"
    places = np.asarray(values, float)
    if is_value(places, wanted).any():
        return ""
    nearest = sorted(places[np.argsort(np.abs(places - wanted), kind="stable")[:2]])
    near = wording.listed([f"{x:.10g}" for x in nearest])
    are = f"{'is' if len(nearest) == 1 else 'are'} {near}"
    return (
        f"{wanted!r} is not among the {len(values)} values of {name}, whose nearest {are}; take one of them, "
        f"or add it to the axis, in values or as a further value, also: [{wanted!r}]"
    )
