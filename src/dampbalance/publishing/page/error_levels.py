"""How wrong each approach is, at which pair of levels and at which frequency: charts for the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from ...figures.error_levels import EXACT, ROUNDING, Quantity, relative_errors
from ...model import Oscillator
from ...project.wording import frequency_name, plain, power_of_ten
from .charts import Axis, Chart, Spec, Table, Value, decades
from .colours import series_colour, variable

SHAPES = {
    "direct": "diamond",
    "X_s": "circle",
    "t_s": "square",
    "V_s": "triangle-up",
    "fourier": "cross",
}
NAMES = {"direct": "direct integration", "fourier": "Fourier"}
FLOOR, CEILING = 1e-4, 1e3  # %, the least and the largest error an axis reaches to
_UNKNOWNS = (("F_k", "F_k_N"), ("c", "c_N_s_per_m"))


@dataclass(frozen=True, slots=True)
class Figure:
    """Charts that share a legend and a remark. exact : approach → bound of its error, of those not drawn."""

    charts: tuple[Chart, ...]
    approaches: tuple[str, ...]
    sharings: tuple[str, ...]
    exact: Mapping[str, str]


def approach_name(key: str) -> str:
    """How an approach is called in a chart."""
    return NAMES.get(key, plain(key))


def error_charts(
    estimates: Mapping[str, pd.DataFrame],
    oscillator: Oscillator,
    frequencies_hz: Mapping[str, float],
    levels_m: Sequence[float],
) -> Figure:
    """Size of the error of F_k and c, %, of every pair of levels and of all: a chart per quantity and frequency.

    The arguments are those of `figures.estimation_error`. An approach nowhere worse than rounding is named, not drawn.
    """
    pairs = [p for p in dict.fromkeys(next(iter(estimates.values()))["pair"]) if p != "all"]
    labels = [*(_levels(pair, levels_m) for pair in pairs), "all"]
    places = {pair: n for n, pair in enumerate([*pairs, "all"])}
    approaches = tuple(dict.fromkeys(a for t in estimates.values() for a in t["approach"]))
    exact: dict[str, float] = {}
    charts = []
    for symbol, column in _UNKNOWNS:
        quantity = Quantity(column, symbol, getattr(oscillator, symbol))
        found = {name: relative_errors(estimates[name], quantity) for name in frequencies_hz}
        worst = {
            key: max(
                (e for one in found.values() for k, e in one.items() if k[0] == key), default=0.0
            )
            for key in approaches
        }
        drawn = [key for key in approaches if worst[key] >= EXACT]
        exact |= {k: max(worst[k], exact.get(k, ROUNDING)) for k in approaches if k not in drawn}
        sizes = [np.array([e for k, e in one.items() if k[0] in drawn]) for one in found.values()]
        limits = decades(sizes, FLOOR, CEILING)
        for name, hz in frequencies_hz.items():
            rows = _rows(found[name], drawn, places, labels)
            table = Table(f"error-{symbol}-{name}".replace("_", ""), rows)
            charts.append(_chart(symbol, name, hz, table, labels, limits, drawn))
    return Figure(
        tuple(charts),
        tuple(key for key in approaches if key not in exact),
        ("individual", "common"),
        {key: power_of_ten(bound) for key, bound in exact.items()},
    )


def _rows(
    errors: Mapping[tuple[str, str, str], float],
    drawn: Sequence[str],
    places: Mapping[str, int],
    labels: Sequence[str],
) -> dict[str, list[object]]:
    """A row per estimate: where it stands, what it is, and its error."""
    rows: dict[str, list[object]] = {
        n: [] for n in ("at", "error", "approach", "name", "sharing", "pair")
    }
    for (approach, sharing, pair), error in errors.items():
        if approach not in drawn:
            continue
        beside = 0.16 * (drawn.index(approach) - 0.5 * (len(drawn) - 1))
        kind = {"common": "common to all levels", "individual": "of each level"}[sharing]
        values = (places[pair] + beside, error, approach, approach_name(approach), kind)
        for column, value in zip(rows, (*values, labels[places[pair]]), strict=True):
            rows[column].append(value)
    return rows


def _chart(
    symbol: str,
    name: str,
    hz: float,
    table: Table,
    labels: Sequence[str],
    limits: tuple[float, float],
    drawn: Sequence[str],
) -> Chart:
    where = f"{frequency_name(name)}, {hz:g} Hz"
    return Chart(
        id=table.id,
        title=f"{plain(symbol)} at {where}",
        description=f"Error of {plain(symbol)} at {hz:g} Hz by approach and pair of excitation levels.",
        table=table,
        x=Axis("at", "levels of the pair (mm)", limits=(-0.6, len(labels) - 0.4), labels=labels),
        y=Axis("error", f"error of {plain(symbol)} (%)", "log", limits),
        layers=tuple(_points(drawn, filled) for filled in (True, False)),
        says=(
            Value("name", "approach"),
            Value("sharing", "φ and tₛ"),
            Value("pair", "levels", "mm"),
            Value("error", "error", "%"),
        ),
        nearest="xy",
    )


def _points(drawn: Sequence[str], filled: bool) -> Spec:
    """Estimates with common (filled) or individual (open) φ and t_s."""
    domain = list(drawn)
    colours = [series_colour(key) for key in drawn]
    shapes = [SHAPES.get(key, "triangle-down") for key in drawn]

    def by_approach(values: list[str]) -> Spec:
        return {
            "field": "approach",
            "type": "nominal",
            "scale": {"domain": domain, "range": values},
            "legend": None,
        }

    mark = {"type": "point", "size": 46, "opacity": 1, "strokeWidth": 1.6, "clip": True}
    encoding = {"shape": by_approach(shapes), "stroke": by_approach(colours)}
    encoding["fill"] = by_approach(colours) if filled else {"value": variable("paper")}
    test = "datum.sharing === 'common to all levels'"
    return {
        "transform": [{"filter": test if filled else f"!({test})"}],
        "mark": mark,
        "encoding": encoding,
    }


def _levels(pair: str, levels_m: Sequence[float]) -> str:
    """The pair "i-j" by its two excitation levels in mm."""
    return "–".join(f"{1e3 * levels_m[int(level) - 1]:g}" for level in pair.split("-"))
