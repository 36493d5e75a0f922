"""What the figure, the facts and the text of a study refer to, checked before anything runs: a dry build of them."""

from __future__ import annotations

import math
import string
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ..project.documents import Key, Problem
from ..project.wording import shortened
from .axes import Listed, is_value
from .parameters import PARAMETERS
from .plan import columns_of
from .routes import LAWS
from .settings import BANDS, CHOICES, OF_INTERVALS, SPREADS, Study
from .sizes import extent

MOST_POINTS = 50_000
"""Cases on the curves of a figure; more are drawn as a map."""

MOST_PANELS, MOST_PLACES, MOST_GROUPS = 8, 500, 1000
"""Columns of panels, listed values along an axis of a map or a scatter, groups in a summary."""

FAR = 100.0
"""A mark may lie beside the axis, which is then drawn up to it, by this factor at most."""


def wrong_references(study: Study) -> Iterator[Problem]:
    """Everything that a figure, a fact, the text or the summary speaks of and that the study lacks."""
    if study.route == LAWS:
        yield from _wrong_of_laws(study)
        yield from _wrong_text(study)
        return
    groups = 1
    for i, axis in enumerate(study.summary_by):
        if axis not in study.axis_names:
            yield ("summary_by", i), f"{shortened(axis)} is not an axis of this study"
        else:
            groups *= _count(study, axis)
    if groups > MOST_GROUPS:
        text = f"{groups:,} groups are more than {MOST_GROUPS}; take axes of few values"
        yield ("summary_by",), text
    if study.figure:
        yield from _wrong_figure(study, study.figure)
    for fact, spec in study.facts.items():
        yield from _wrong_fact(study, ("facts", fact), spec)
    yield from _wrong_text(study)


def _wrong_of_laws(study: Study) -> Iterator[Problem]:
    """What the figure and the facts of a study of laws have that they cannot show."""
    if study.figure and (study.figure["kind"], study.figure["x"]) != ("confusion", "law"):
        yield ("figure",), "a study of laws has the figure {kind: confusion, x: law}"
    for fact, spec in study.facts.items():
        if spec["of"] != "law" or spec["take"] not in CHOICES:
            text = f"of a study of laws, take {', '.join(CHOICES)} of law"
            yield ("facts", fact), text
        yield from _wrong_selection(study, ("facts", fact), spec)


def _wrong_text(study: Study) -> Iterator[Problem]:
    try:
        fields = [field for field in string.Formatter().parse(study.shows) if field[1] is not None]
    except ValueError as error:
        yield ("shows",), f"{error}: write {{name}} for a fact, and {{{{ or }}}} for a brace"
        return
    for _, name, form, conversion in fields:
        if name not in (*study.facts, "cases"):
            known = ", ".join(study.facts) or "none"
            yield ("shows",), f"{{{name}}} is not among the facts: {known}"
        elif form or conversion:
            yield ("shows",), f"write {{{name}}} with nothing else in the braces: facts are words"


def _wrong_figure(study: Study, figure: Mapping[str, Any]) -> Iterator[Problem]:
    if figure["kind"] == "confusion":
        yield ("figure", "kind"), "a confusion is that of laws, which the route laws alone compares"
        return
    kind, places = figure["kind"], ["x", "y"] if figure["kind"] == "map" else ["x"]
    if kind == "map" and "y" not in figure:
        yield ("figure", "y"), "missing; a map has two axes, x and y"
        return
    wrong = [(("figure", part), text) for part in places if (text := _not_drawn(study, part))]
    yield from wrong
    if not study.fits_of(figure):
        yield ("figure",), "no fit of this study is meant: see estimation"
    if wrong:
        return
    if kind == "map" and figure["x"] == figure["y"]:
        yield ("figure", "y"), f"{figure['y']} is the axis x already; take another"
    if kind == "steps":
        yield from _wrong_steps(study, figure)
    if "at" in figure and kind != "curves":
        yield ("figure", "at"), f"is for curves; a figure of {kind} takes all cases"
    yield from _wrong_selection(study, ("figure",), {"at": figure.get("at", {})})
    if kind == "curves" and study.cases > MOST_POINTS:
        text = f"{study.cases:,} cases are more than curves can show, {MOST_POINTS:,}; take a map"
        yield ("figure", "kind"), text
    if "panels" in figure and kind in ("curves", "scatter"):
        yield from _wrong_panels(study, figure, kind)
    low, high = extent(study, figure["x"])
    for name, value in figure.get("marks", {}).items():
        lowest, highest = low / FAR if low > 0.0 else FAR * min(low, -high), FAR * max(high, -low)
        if not lowest <= value <= highest:
            text = f"{value:g} is far from the axis x, from {low:g} to {high:g}"
            yield ("figure", "marks", name), text


def _not_drawn(study: Study, part: str) -> str:
    """Why an axis of the figure cannot be drawn; nothing if it can."""
    name, kind = study.figure[part], study.figure["kind"]
    if name not in study.axis_names:
        return f"{shortened(name)} is not an axis of this study"
    if PARAMETERS[name].unit == "":
        return f"{name} holds words: take an axis of numbers, and {name} for the panels"
    low, high = extent(study, name)
    if not low < high:
        return f"{name} has one value; take an axis with two at least"
    if kind in ("map", "scatter") and _is_listed(study, name) and _count(study, name) > MOST_PLACES:
        return f"{name} has more than {MOST_PLACES} values; a {kind} shows no more"
    if kind == "scatter" and (low <= 0.0 or not _is_listed(study, name)):
        return f"{name} must be listed values above zero: a scatter has a logarithmic axis"
    return ""


def _wrong_steps(study: Study, figure: Mapping[str, Any]) -> Iterator[Problem]:
    if figure["x"] != "step_s" or "scheme" not in study.axis_names:
        text = (
            "steps shows the error against step_s for each scheme: both must be axes, step_s as x"
        )
        yield ("figure", "x"), text
    if "parameters" not in study.columns:
        yield ("columns",), "a figure of steps needs the columns of parameters"
    if not study.fits_of({"approach": "direct"}):
        yield ("figure",), "a figure of steps shows the approach direct: see estimation"


def _wrong_panels(study: Study, figure: Mapping[str, Any], kind: str) -> Iterator[Problem]:
    name, key = figure["panels"], ("figure", "panels")
    if name == "phase" and kind == "curves":
        if not any(fit.phase for fit in study.fits):
            yield key, "no approach of this study knows a phase; leave it out"
    elif name not in study.axis_names or name == figure["x"]:
        yield key, f"{shortened(name)} is not another axis of this study"
    elif not _is_listed(study, name) or _count(study, name) > MOST_PANELS:
        yield key, f"{name} must have {MOST_PANELS} listed values at most, a column of panels each"


def _wrong_fact(study: Study, key: Key, spec: Mapping[str, Any]) -> Iterator[Problem]:
    wrong = list(_wrong_selection(study, key, spec))
    yield from wrong
    take, fits = spec["take"], study.fits_of(spec)
    if spec["of"] == "law" or take in CHOICES:
        yield key, "is about laws, which the route laws alone compares"
        return
    if not fits:
        yield key, "no fit of this study is meant: see estimation"
    held = {column.name for column in columns_of(study)}
    if any(f"{spec['of']}_relative_error__{fit.label}" not in held for fit in fits):
        text = f"{spec['of']} is not identified, or the oscillator has none: see estimation.terms"
        yield (*key, "of"), text
    if take in SPREADS and len(fits) > 1:
        labels = ", ".join(fit.label for fit in fits)
        yield key, f"{take} is that of one fit, and {labels} are meant"
    if take in OF_INTERVALS and "intervals" not in study.columns:
        yield (*key, "take"), "needs the columns of intervals: columns: [errors, intervals]"
    if take in (*BANDS, "share") and "within" not in spec:
        yield (*key, "within"), f"missing; the bound of {take}, as a relative error"
    along = spec.get("along")
    if take in BANDS and not (_is_listed(study, along) and PARAMETERS[str(along)].unit):
        yield (*key, "along"), "must be an axis of this study whose values are listed numbers"
    elif (
        take in BANDS
        and "around" in spec
        and (text := _not_held(study, str(along), spec["around"]))
    ):
        yield (*key, "around"), text
    if take == "signed" and not wrong and (cases := _selected(study, spec)) > 1:
        text = (
            f"is the error of one case, and {cases:,} are selected; give a value of each axis in at"
        )
        yield (*key, "take"), text


def _selected(study: Study, spec: Mapping[str, Any]) -> int:
    """How many cases the conditions on listed axes leave."""
    at, between = spec.get("at", {}), spec.get("between", {})
    left = 1
    for block in study.blocks:
        kept = np.ones(block.count, dtype=bool)
        for name, values in block.values.items() if isinstance(block, Listed) else ():
            held = np.asarray(values)
            if name in at:
                kept &= held == at[name] if held.dtype.kind == "U" else is_value(held, at[name])
            if name in between:
                kept &= (held >= between[name][0]) & (held <= between[name][1])
        left *= int(np.count_nonzero(kept))
    return left


def _wrong_selection(study: Study, key: Key, spec: Mapping[str, Any]) -> Iterator[Problem]:
    wrong = False
    for where in ("at", "between"):
        for name, wanted in spec.get(where, {}).items():
            if text := _not_selected(study, name, wanted):
                yield (*key, where, name), text
                wrong = True
    if not wrong and not _selected(study, spec):
        yield (
            key,
            "selects no case: paired axes go in step, and bounds must have a value between them",
        )


def _not_selected(study: Study, name: str, wanted: Any) -> str:
    """Why cases cannot be chosen by a value of an axis, or by two bounds; nothing if they can."""
    if name not in study.axis_names:
        return "not an axis of this study"
    words = PARAMETERS[name].unit == ""
    if isinstance(wanted, list):
        if words or wanted[0] > wanted[1]:
            return f"{shortened(wanted)} are not two bounds of {name}, the lower one first"
        return ""
    if words:
        values = next(block.values[name] for block in _listed(study, name))
        if wanted not in values:
            return f"{shortened(wanted)} is not among its values: {', '.join(map(str, values))}"
    elif isinstance(wanted, bool) or not isinstance(wanted, int | float):
        return f"{shortened(wanted)} is not a number"
    elif not math.isfinite(wanted):
        return f"{wanted!r} is not a finite number"
    else:
        return _not_held(study, name, wanted)
    return ""


def _not_held(study: Study, name: str, wanted: float) -> str:
    """Why an axis of numbers has no case at a value; nothing if it has."""
    if not _is_listed(study, name):
        return (
            f"{wanted:g} is no value of {name}, which is sampled: take the cases between two bounds"
        )
    values = next(np.asarray(block.values[name], float) for block in _listed(study, name))
    if is_value(values, wanted).any():
        return ""
    nearest = sorted(values[np.argsort(np.abs(values - wanted), kind="stable")[:2]])
    shown = " and ".join(f"{value:.10g}" for value in nearest)
    are = "nearest is" if len(nearest) == 1 else "nearest are"
    return (
        f"{wanted!r} is not among the {len(values)} values of {name}, whose {are} {shown}; take one of "
        f"them, or add it to the axis, in values or beside from, to and count as also: [{wanted!r}]"
    )


def _listed(study: Study, name: str) -> Iterator[Listed]:
    """The block that lists the values of an axis, if there is one."""
    return (b for b in study.blocks if isinstance(b, Listed) and name in b.names)


def _is_listed(study: Study, name: str | None) -> bool:
    return any(_listed(study, str(name)))


def _count(study: Study, name: str) -> int:
    """How many values an axis has."""
    return next(block.count for block in study.blocks if name in block.names)
