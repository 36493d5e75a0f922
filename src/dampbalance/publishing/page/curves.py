"""The figure of a parameter study for the page: errors along an axis, or against the step of fixed-step schemes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...figures.looks import SCHEME_LOOKS, label_of, look_of
from ...figures.series import decades
from ...project.wording import frequency_name, plain, power_of_ten
from ...studies.parameters import PARAMETERS
from ...studies.settings import Study
from ...studies.shown import error_curves as curves_of
from .charts import (
    Axis,
    Chart,
    ChartSet,
    Scale,
    Spec,
    Table,
    Value,
    curve,
    mark_at,
    signed_axis,
    with_points,
)
from .colours import series_colour, variable
from .legend import line, of_approaches
from .words import italic

LAW = "*m*ω²*h*"
"""The damping that backward Euler adds, as a legend names it."""


def study_charts(study: Study, cases: str | Path) -> ChartSet:
    """The charts of a study whose figure is of the kind `curves` or `steps`, from its table of cases.

    Raises KeyError for another kind.
    """
    return {"curves": error_curves, "steps": error_of_steps}[study.figure["kind"]](study, cases)


def error_curves(study: Study, cases: str | Path) -> ChartSet:
    """Error of each coefficient, %, with its sign, along the axis x of the study: a chart per term and panel.

    The curves are those of `curves_of.error_curves`: solid with φ and t_s of each level, dashed with common ones. Every
    case is drawn; values keep five digits.
    """
    shown = curves_of.error_curves(study, cases)
    drawn = [one for curves in shown.curves.values() for one in curves]
    return ChartSet(
        tuple(_chart(study, shown, *place) for place in shown.curves),
        tuple(
            of_approaches(
                dict.fromkeys(one.approach for one in drawn),
                dict.fromkeys(one.sharing for one in drawn if one.sharing),
                marks=False,
            )
        ),
        {key: power_of_ten(bound) for key, bound in shown.exact.items()},
    )


def error_of_steps(study: Study, cases: str | Path) -> ChartSet:
    """Size of the error of c, N s/m, by direct integration against the step h of each scheme, beside m ω² h."""
    shown = curves_of.error_of_steps(study, cases)
    steps = shown.steps
    columns: dict[str, Any] = {"step_s": steps, "line": shown.line(steps)}
    says = [Value("step_s", "step *h*", "s"), Value("line", LAW, "N s/m")]
    layers = [curve("line", variable("edge"), 6.0)]
    legend = [line(LAW, variable("edge"), 6.0)]
    for name, (of_scheme, errors) in shown.errors.items():
        label, look = SCHEME_LOOKS[name]
        column = name.replace("-", "_")
        at = dict(zip(of_scheme.tolist(), errors.tolist(), strict=True))
        columns[column] = np.array([at.get(step, np.nan) for step in steps.tolist()])
        says.append(Value(column, label, "N s/m"))
        layers.append(with_points(curve(column, variable(look.series), look.page_width)))
        legend.append(line(label, variable(look.series), look.page_width))
    sizes = [values for name, values in columns.items() if name != "step_s"]
    span = (float(steps[0]) / 1.15, float(steps[-1]) * 1.15)
    chart = Chart(
        id="study-step-size-c",
        title="error of *c* by direct integration",
        description="Error of c against the step, for each scheme, beside the line mω²h.",
        table=Table("study-step-size-c", columns),
        x=Axis("step_s", "step *h* (s)", "log", span),
        y=Axis("line", "error of *c* (N s/m)", "log", decades(sizes, 1e-12, 1e3, cut=0.02)),
        layers=(*layers, *_marks(study, span, "log")),
        says=tuple(says),
    )
    return ChartSet((chart,), tuple(legend))


def _chart(study: Study, shown: curves_of.ErrorCurves, symbol: str, number: int) -> Chart:
    """The errors of one term in one panel."""
    panel, curves = shown.panels[number], shown.curves[symbol, number]
    layers, says, errors = [], [], {}
    for one in curves:
        column = f"{one.approach}_{one.sharing}".strip("_")
        colour, width = series_colour(one.approach), look_of(one.approach).page_width
        layers.append(curve(column, colour, width, dashed=one.sharing == "common"))
        shared = f", {one.sharing} phi, t_s" if one.sharing else ""
        says.append(Value(column, label_of(one.approach) + shared, "%"))
        errors[column] = one.error
    name, unit = shown.name, curves_of.unit_of(shown.name)
    parameter = PARAMETERS[name]
    meaning = _short(parameter.meaning)
    scale: Scale = "log" if shown.is_logarithmic else "linear"
    margin = 0.3 if parameter.whole else 0.0
    span = (float(shown.places[0]) - margin, float(shown.places[-1]) + margin)
    key = f"study-{study.name}-{symbol}-{number}".replace("_", "-")
    title = f"error of {italic(symbol)} (%)"
    return Chart(
        id=key,
        title=", ".join(part for part in (italic(symbol), _title(panel)) if part),
        description=f"Error of {plain(symbol)} in % over {parameter.meaning}, a curve per approach.",
        table=Table(key, {name: panel.x, **errors}),
        x=Axis(name, meaning + (f" ({unit})" if unit else ""), scale, span),
        y=signed_axis(next(iter(errors), name), title, shown.scale(symbol)),
        layers=(*(map(with_points, layers) if panel.few else layers), *_marks(study, span, scale)),
        says=(Value(name, meaning, unit), *says),
    )


def _title(panel: curves_of.Panel) -> str:
    if panel.axis is None:
        return panel.value
    symbol = panel.axis.symbol
    in_tex = not symbol or "\\" in symbol
    return f"{_short(panel.axis.meaning) if in_tex else italic(symbol)} = {panel.value}"


def _short(meaning: str) -> str:
    """What a parameter means, without what follows a comma."""
    return meaning.split(", ")[0]


def _marks(study: Study, span: tuple[float, float], scale: Scale) -> list[Spec]:
    """Places on x that the study's figure names."""
    layers = []
    for name, value in study.figure.get("marks", {}).items():
        low, high, at = np.log((*span, value)) if scale == "log" else np.array((*span, value))
        layers += mark_at(value, frequency_name(name), bool((at - low) / (high - low) > 0.8))
    return layers
