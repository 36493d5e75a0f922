"""The figure of a parameter study for the page: errors along an axis, or against the step of fixed-step schemes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...balance import takes_phase
from ...model import Oscillator
from ...motion.fixed_step import SCHEMES
from ...project.wording import frequency_name, plain, power_of_ten
from ...studies.parameters import PARAMETERS
from ...studies.settings import Study, chosen
from ...studies.shown.drawing import CEILING, EXACT, FLOOR, PHASE_NAMES, SCHEME_LOOKS
from ...studies.shown.facts import worst_errors
from ...studies.shown.logarithmic import is_logarithmic
from ...studies.stretches import column_of
from .charts import Array, Axis, Chart, Scale, Spec, Table, Value, curve, decades, mark_at
from .colours import series_colour, variable
from .error_levels import Figure, approach_name

WIDTHS = {"X_s": 3.0, "t_s": 1.9, "V_s": 1.0}  # where curves coincide, all can be seen
SCHEME_COLOURS = dict(zip(SCHEME_LOOKS, ("t-s", "X-s", "other", "V-s", "direct"), strict=True))


@dataclass(frozen=True, slots=True)
class _Series:
    """One curve of a panel: its column, approach and sharing, and the size of its error, %."""

    column: str
    approach: str
    sharing: str
    error: Array


@dataclass(frozen=True, slots=True)
class _Panel:
    """Which cases a panel shows, and by which phase."""

    title: str
    phase: str
    kept: NDArray[np.bool_]


def study_charts(study: Study, cases: str | Path) -> Figure:
    """The charts of a study whose figure is of the kind `curves` or `steps`, from its table of cases.

    Raises KeyError for another kind.
    """
    kinds = {"curves": error_curves, "steps": error_of_steps}
    return kinds[study.figure["kind"]](study, cases)


def error_curves(study: Study, cases: str | Path) -> Figure:
    """Size of the error of F_k and c, %, along the axis x of the study: a chart per quantity and panel.

    As in `studies.drawing.error_curves`: solid with φ and t_s of each level, dashed with common ones; where several
    fits are meant, the worst. Every case is drawn; values keep five digits.
    """
    x = column_of(cases, study.figure["x"])
    panels = list(_panels(study, cases))
    exact: dict[str, float] = {}
    found: dict[tuple[str, int], list[_Series]] = {}
    for quantity in ("F_k", "c"):
        for n, panel in enumerate(panels):
            drawn = []
            for one in _series(study, cases, quantity, panel):
                known = one.error[np.isfinite(one.error)]
                worst = float(known.max()) if known.size else 0.0
                if worst < 100.0 * EXACT:
                    exact[one.approach] = max(worst, exact.get(one.approach, 0.0))
                else:
                    drawn.append(one)
            found[quantity, n] = drawn
    charts = []
    for quantity in ("F_k", "c"):
        sizes = [s.error for n in range(len(panels)) for s in found[quantity, n]]
        limits = decades(sizes, FLOOR, CEILING)
        for n, panel in enumerate(panels):
            drawn = found[quantity, n]
            charts.append(
                _chart(study, f"{quantity} {n}", x[panel.kept], drawn, limits, panel, quantity)
            )
    shown = [s for series in found.values() for s in series]
    return Figure(
        tuple(charts),
        tuple(dict.fromkeys(s.approach for s in shown)),
        tuple(name for name in ("individual", "common") if any(s.sharing == name for s in shown)),
        {key: power_of_ten(bound) for key, bound in exact.items()},
    )


def error_of_steps(study: Study, cases: str | Path) -> Figure:
    """Size of the error of c, N s/m, by direct integration against the step h of each scheme, beside m ω² h."""
    h, scheme = column_of(cases, "step_s"), column_of(cases, "scheme")
    relative = worst_errors(study, cases, {"of": "c", "approach": "direct"})
    m, c, k, omega = (
        column_of(cases, name) for name in ("m_kg", "c_N_s_per_m", "k_N_per_m", "omega_rad_per_s")
    )
    error = np.abs(relative * c)
    steps = np.unique(h)
    osc = Oscillator(m=m[0], c=c[0], k=k[0], K_z=1.0, F_k=0.0)
    euler = SCHEMES["backward-euler"]
    columns: dict[str, Any] = {
        "step_s": steps,
        "line": np.array([abs(euler.balance_bias(osc, omega[0], step)) for step in steps]),
    }
    says = [Value("step_s", "step h", "s"), Value("line", "m ω² h", "N s/m")]
    layers = [curve("line", variable("edge"), 5.0)]
    for name, (label, *_) in SCHEME_LOOKS.items():
        kept = scheme == name
        if not kept.any():
            continue
        column = name.replace("-", "_")
        at = dict(zip(h[kept].tolist(), error[kept].tolist(), strict=True))
        columns[column] = np.array([at.get(step, np.nan) for step in steps.tolist()])
        says.append(Value(column, label, "N s/m"))
        layers.append(_with_points(curve(column, variable(SCHEME_COLOURS[name]))))
    limits = decades([np.asarray(v) for n, v in columns.items() if n != "step_s"], 1e-12, 1e3)
    span = (float(steps[0]) / 1.15, float(steps[-1]) * 1.15)
    chart = Chart(
        id="study-step-size-c",
        title="error of c by direct integration",
        description="Error of c against the step, for each scheme, beside the line mω²h.",
        table=Table("study-step-size-c", columns),
        x=Axis("step_s", "step h (s)", "log", span),
        y=Axis("line", "error of c (N s/m)", "log", limits),
        layers=(*layers, *_marks(study, span, "log")),
        says=tuple(says),
    )
    return Figure((chart,), (), (), {})


def _series(study: Study, cases: str | Path, quantity: str, panel: _Panel) -> Iterator[_Series]:
    """The curves of a panel."""
    settings = {"fit": "least_squares"} | dict(study.figure)
    fits = chosen(study.fits, settings)
    sharings = [n for n in ("individual", "common") if any(fit.sharing == n for fit in fits)]
    for approach in dict.fromkeys(fit.approach for fit in fits):
        for sharing in ("",) if not takes_phase(approach) else sharings:
            spec = settings | {"of": quantity, "approach": approach, "sharing": sharing}
            spec |= {"phase": panel.phase} if panel.phase else {}
            error = 100.0 * np.abs(worst_errors(study, cases, spec)[panel.kept])
            yield _Series(f"{approach}_{sharing}".strip("_"), approach, sharing, error)


def _chart(
    study: Study,
    place: str,
    x: Array,
    drawn: list[_Series],
    limits: tuple[float, float],
    panel: _Panel,
    quantity: str,
) -> Chart:
    name = study.figure["x"]
    order = np.argsort(x, kind="stable")
    parameter = PARAMETERS[name]
    unit = "" if parameter.unit in ("", "1") else parameter.unit
    scale: Scale = "log" if not parameter.whole and is_logarithmic(np.unique(x)) else "linear"
    margin = 0.3 if parameter.whole else 0.0
    span = (float(x.min()) - margin, float(x.max()) + margin)
    meaning = plain(parameter.meaning.split(", ")[0])
    few = len(x) <= 24
    layers = [
        curve(
            s.column, series_colour(s.approach), WIDTHS.get(s.approach, 1.6), s.sharing == "common"
        )
        for s in drawn
    ]
    key = f"study-{study.name}-{place}".replace("_", "-").replace(" ", "-")
    return Chart(
        id=key,
        title=f"{plain(quantity)}" + (f", {panel.title}" if panel.title else ""),
        description=f"Error of {plain(quantity)} in % over {parameter.meaning}, a curve per approach.",
        table=Table(key, {name: x[order], **{s.column: s.error[order] for s in drawn}}),
        x=Axis(name, meaning + (f" ({unit})" if unit else ""), scale, span),
        y=Axis(
            drawn[0].column if drawn else name, f"error of {plain(quantity)} (%)", "log", limits
        ),
        layers=(*(map(_with_points, layers) if few else layers), *_marks(study, span, scale)),
        says=(
            Value(name, meaning, unit),
            *(Value(s.column, _series_name(s), "%") for s in drawn),
        ),
    )


def _series_name(series: _Series) -> str:
    sharing = {"individual": ", individual φ, tₛ", "common": ", common φ, tₛ", "": ""}
    return approach_name(series.approach) + sharing[series.sharing]


def _panels(study: Study, cases: str | Path) -> Iterator[_Panel]:
    """The panels of the study's figure: its phases, or the values of another axis."""
    everything = np.ones(study.cases, dtype=bool)
    by = study.figure.get("panels")
    phase = str(study.figure.get("phase", ""))
    if by is None:
        yield _Panel("", phase, everything)
    elif by == "phase":
        for name in dict.fromkeys(fit.phase for fit in study.fits if fit.phase):
            yield _Panel(PHASE_NAMES[name], name, everything)
    else:
        values = column_of(cases, by)
        parameter = PARAMETERS[by]
        unit = "" if parameter.unit in ("", "1") else f" {parameter.unit}"
        symbol = _PLAIN.get(by, parameter.meaning.split(", ")[0])
        for value in dict.fromkeys(values.tolist()):
            shown = value if isinstance(value, str) else f"{value:.4g}"
            yield _Panel(f"{symbol} = {shown}{unit}", phase, values == value)


_PLAIN = {"frequency_hz": "f"}


def _with_points(layer: Spec) -> Spec:
    """The curve with a mark at each value."""
    point = {
        "filled": True,
        "size": 34,
        "fill": variable("paper"),
        "stroke": layer["mark"]["color"],
    }
    return {**layer, "mark": {**layer["mark"], "point": point | {"strokeWidth": 1.4, "opacity": 1}}}


def _marks(study: Study, span: tuple[float, float], scale: Scale) -> list[Spec]:
    """Places on x that the study's figure names."""
    layers = []
    for name, value in study.figure.get("marks", {}).items():
        low, high, at = np.log((*span, value)) if scale == "log" else np.array((*span, value))
        layers += mark_at(value, frequency_name(name), bool((at - low) / (high - low) > 0.8))
    return layers
