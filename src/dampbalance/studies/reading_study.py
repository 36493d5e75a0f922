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
from ..project.documents import (
    ConfigurationError,
    KeyPath,
    Problem,
    against_schema,
    in_lines,
    read_schema,
    read_yaml,
)
from ..project.wording import listed, shortened
from ..replication.fixed_step import MOST_STEPS
from .cases import PART, case_columns
from .parameters import PARAMETERS, in_si, mechanical, objection, of_law, parameter, synonyms
from .study_file import (
    PAPER_CASE,
    STUDY_ROUTES,
    Listed,
    Sampled,
    Study,
    is_value,
    selected,
    spread_values,
)

STUDY_SCHEMA = Path(__file__).parents[1] / "project/schemas/study.schema.yaml"

MOST_POINTS = 50_000
"""Cases on the curves of a figure; more are drawn as a map."""

MOST_PANELS, MOST_AXIS_PLACES, MOST_GROUPS = 8, 500, 1000
"""Columns of panels, listed values along an axis of a map or a scatter, groups in a summary."""

FARTHEST_MARK = 100.0
"""A mark may lie outside the axis, which is then drawn up to it, by this factor at most."""

MOST_SAMPLES_READ = 1_000_000
"""Samples of a record that is read; the reader holds a few arrays as long."""

MOST_NUMBERS = 200_000_000
"""Numbers that a job holds at a time: cases × columns, or × replicates × levels × features."""

_FEATURES = 20  # numbers that a replicate has
_USUAL_PANELS = 6  # more values are drawn along an axis, not as panels


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
    wrong = wrong or [*_wrong_axes(document["axes"]), *_wrong_values(document)]
    for check in (_contradictions, _wrong_sizes, _wrong_references):
        wrong = wrong or list(check(document, Study.of("", document, paper)))
    return wrong


# --- axes and values ---------------------------------------------------------------------------------


def _wrong_axes(axes: Sequence[Mapping[str, Any]]) -> Iterator[Problem]:
    seen: set[str] = set()
    for i, block in enumerate(axes):
        key: KeyPath = ("axes", i)
        over, sizes, sample = block, {}, block.get("sample", {})
        if sample:
            over, key = sample["over"], (*key, "sample", "over")
        for name, spec in over.items():
            yield from _wrong_axis((*key, name), name, spec)
            sizes[name] = len(spec.get("values", ())) or spec.get("count")
            if spec.get("also") and len(over) > 1:
                text = "cannot be paired with another axis; list the values of both"
                yield (*key, name, "also"), text
            for other in seen.intersection(synonyms(name)):
                reason = "twice" if other == name else f"together with {other}, the same quantity"
                yield ("axes", i), f"{name} is set {reason}; keep one"
            seen.add(name)
        if len(set(sizes.values())) > 1:
            text = ", ".join(f"{name} has {size}" for name, size in sizes.items())
            yield key, f"paired axes need the same number of values: {text}"


def _wrong_axis(key: KeyPath, name: str, spec: Mapping[str, Any]) -> Iterator[Problem]:
    """Yield what is wrong with the values or the range of an axis."""
    given = [(key, spec.get("values", [])), ((*key, "also"), spec.get("also", []))]
    given += [((*key, end), [spec[end]]) for end in ("from", "to") if end in spec]
    wrong = [
        (where, text) for where, values in given for x in values if (text := objection(name, x))
    ]
    yield from wrong
    if "from" not in spec:
        return
    low, high = spec["from"], spec["to"]
    if low >= high:
        yield key, f"from must lie below to, got {low!r} and {high!r}"
    elif spec.get("spacing") == "log" and low <= 0.0:
        yield (*key, "from"), "a logarithmic range begins above zero"
    elif "count" in spec and not wrong:
        values = spread_values({part: value for part, value in spec.items() if part != "also"})
        if len(set(values)) < len(values):
            text = f"its ends are too close for {len(values):,} different values; take fewer"
            yield key, text
        elif parameter(name).whole and any(value != int(value) for value in values):
            yield key, f"{parameter(name).meaning} must be whole numbers; list the values"


def _wrong_values(document: Mapping[str, Any]) -> Iterator[Problem]:
    for section in ("base", "route", "read_out"):
        for name, value in document.get(section, {}).items():
            if name in PARAMETERS and value is not None and (text := objection(name, value)):
                yield (section, name), text
    base = document.get("base", {})
    for name in base:
        for other in synonyms(name):
            if other in base and other > name:
                yield ("base", name), f"not together with {other}; keep one"


# --- levels, route, estimation -----------------------------------------------------------------------


def _contradictions(document: Mapping[str, Any], study: Study) -> Iterator[Problem]:
    """Yield what does not go together: levels, route, rules of reading, laws, fits, weights, terms of the balance."""
    estimation = document.get("estimation", {})
    given = {*document.get("base", {}), *study.axis_names} & {"Y_m", "F_k_over_kY"}
    if given and not study.levels_relative:
        text = "with Y_m or F_k_over_kY give the levels as multiples of Y_m: levels_of_Y: [1, 2, 3]"
        yield ("levels_m" if "levels_m" in document else "axes",), text
    yield from _wrong_route(document, study)
    if {"X_s_mark_m", "X_s_decimals"} <= study.parameters:
        yield ("read_out",), "X_s_mark_m and X_s_decimals both round X_s; keep one"
    for i, fit in enumerate(estimation.get("fits", [])):
        if fit != "least_squares" and max(fit) > len(study.levels):
            yield ("estimation", "fits", i), f"there are only {len(study.levels)} levels"
    if not study.route.any_law:
        text = f"needs the route exact, not {study.route.kind}"
        yield from ((("route",), f"{name} {text}") for name in of_law(study.parameters))
        if "terms" in estimation:
            yield ("estimation", "terms"), text
    for i, terms in enumerate(estimation.get("terms", [])):
        key: KeyPath = ("estimation", "terms", i)
        try:
            Law(tuple(terms)).require([1.0] * len(study.levels))  # a case has one frequency
        except ValueError as error:
            yield key, str(error)
            continue
        if len(terms) > 2 and any(fit.levels for fit in study.fits):
            text = f"a pair of levels identifies two terms, not {len(terms)}: take fits: [least_squares]"
            yield key, text


def _wrong_route(document: Mapping[str, Any], study: Study) -> Iterator[Problem]:
    """Yield what does not fit the route: parameters and settings that are missing, or that mean nothing to it."""
    used, wanted, section = study.parameters, study.route, document.get("route", {})
    unused = f"is not used by the route {wanted.kind}"
    for names in wanted.needs:
        if used.isdisjoint(names):
            yield ("route",), f"{wanted.kind} needs {' or '.join(names)}, here or as an axis"
        elif used.issuperset(names) and len(names) > 1:
            yield ("route",), f"{' and '.join(names)} set the same quantity; keep one"
    taken = {*wanted.optional, *(name for names in wanted.needs for name in names)}
    for name in sorted(used):
        if parameter(name).kind == "numerics" and name not in taken:
            yield ("route",), f"{name} {unused}"
        if parameter(name).kind == "read_out" and wanted.is_noisy:
            yield ("read_out", name), f"{unused}: noise is its limit"
    others = {key for each in STUDY_ROUTES.values() for key in each.settings} - {*wanted.settings}
    for name in filter(others.__contains__, section):
        yield ("route", name), f"{unused}; leave it out"


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
        each = max(each, study.replicates * len(study.levels) * _FEATURES)
    part, enough = min(study.chunk_cases, study.cases, PART), max(1, MOST_NUMBERS // each)
    if part * each > MOST_NUMBERS:
        text = f"{part:,} cases at a time do not fit in memory; take {enough:,} at most"
        yield ("chunk_cases",), text


# --- what the summary and the figure refer to -----------------------------------------------------------


def _wrong_references(_: object, study: Study) -> Iterator[Problem]:
    groups = 1
    for i, axis in enumerate(study.summary_by):
        if block := study.block_of(axis):
            groups *= block.count
        else:
            yield ("summary_by", i), f"{shortened(axis)} is not an axis of this study"
    if groups > MOST_GROUPS:
        text = f"{groups:,} groups are more than {MOST_GROUPS}; take axes of few values"
        yield ("summary_by",), text
    if study.figure:
        yield from _wrong_figure(study)


def _wrong_figure(study: Study) -> Iterator[Problem]:
    figure = study.figure
    kind, x, y = figure["kind"], figure["x"], figure.get("y")
    axes = {"x": x, "y": y} if kind == "map" else {"x": x}
    undrawn = {part: text for part, name in axes.items() if (text := _not_drawn(study, name))}
    yield from ((("figure", part), text) for part, text in undrawn.items())
    if not study.fits_of(figure):
        yield ("figure",), "selects no fit of this study: see estimation"
    if undrawn:
        return
    if kind == "map" and x == y:
        yield ("figure", "y"), f"{y} is the axis x already; take another"
    yield from wrong_selection(study, ("figure",), {"at": figure.get("at", {})})
    if kind == "curves" and study.cases > MOST_POINTS:
        text = f"{study.cases:,} cases are more than curves can show, {MOST_POINTS:,}; take a map"
        yield ("figure", "kind"), text
    if kind in ("curves", "scatter") and (name := figure.get("panels")):
        if name == "phase" and kind == "curves":
            if not any(fit.phase for fit in study.fits):
                text = "no approach of this study takes a phase; leave it out"
                yield ("figure", "panels"), text
        elif name not in study.axis_names or name == x:
            yield ("figure", "panels"), f"{shortened(name)} is not another axis of this study"
        elif not 0 < len(study.values_of(name)) <= MOST_PANELS:
            text = f"{name} must have {MOST_PANELS} listed values at most, a column of panels each"
            yield ("figure", "panels"), text
    low, high = study.extent(x)
    lowest, highest = (
        low / FARTHEST_MARK if low > 0.0 else FARTHEST_MARK * min(low, -high),
        FARTHEST_MARK * max(high, -low),
    )
    for name, value in figure.get("marks", {}).items():
        if not lowest <= value <= highest:
            text = f"{value:g} is far from the axis x, from {low:g} to {high:g}"
            yield ("figure", "marks", name), text


def _not_drawn(study: Study, name: str) -> str:
    """Return why the figure cannot be drawn along an axis; nothing if it can."""
    kind = study.figure["kind"]
    if name not in study.axis_names:
        return f"{shortened(name)} is not an axis of this study"
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
    few = [name for name in sizes if sizes[name] <= _USUAL_PANELS]
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


def _selected(study: Study, spec: Mapping[str, Any]) -> int:
    """Return how many cases the conditions on listed axes leave."""
    cases = 1
    for block in study.blocks:
        points = block.count
        if isinstance(block, Listed):
            values = {name: np.asarray(listed) for name, listed in block.axes.items()}
            points = int(np.count_nonzero(selected(values, spec)))
        cases *= points
    return cases


def wrong_selection(study: Study, key: KeyPath, spec: Mapping[str, Any]) -> Iterator[Problem]:
    """Yield what is wrong with the cases that a figure or a number selects by values of axes, or by bounds."""
    wrong = [
        ((*key, where, name), text)
        for where in ("at", "between")
        for name, wanted in spec.get(where, {}).items()
        if (text := _not_selected(study, name, wanted))
    ]
    yield from wrong
    if not wrong and not _selected(study, spec):
        text = (
            "selects no case: paired axes vary together, and bounds must have a value between them"
        )
        yield key, text


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
    are = f"{'is' if len(nearest) == 1 else 'are'} {listed([f'{x:.10g}' for x in nearest])}"
    return (
        f"{wanted!r} is not among the {len(values)} values of {name}, whose nearest {are}; take one of them, "
        f"or add it to the axis, in values or as a further value, also: [{wanted!r}]"
    )
