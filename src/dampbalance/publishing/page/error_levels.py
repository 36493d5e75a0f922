"""How wrong each approach is, at which pair of levels and at which frequency: charts for the page."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import pandas as pd

from ...figures import series
from ...figures.looks import label_of, look_of
from ...figures.series import COMMON, INDIVIDUAL, SHARINGS
from ...model import Oscillator
from ...project.wording import frequency_name, plain, power_of_ten
from .charts import Axis, Chart, ChartSet, Spec, Table, Value, coded, signed_axis
from .colours import series_colour, variable
from .legend import of_approaches
from .words import italic


def error_charts(
    estimates: Mapping[str, pd.DataFrame],
    oscillator: Oscillator,
    frequencies_hz: Mapping[str, float],
    levels_m: Sequence[float],
) -> ChartSet:
    """Error of each term's coefficient, %, with its sign, of every pair of levels and of all: a chart per frequency.

    The arguments are those of `figures.series.errors_by_level`. An approach nowhere worse than rounding is named, not
    drawn.
    """
    shown = series.errors_by_level(estimates, oscillator, frequencies_hz, levels_m)
    exact = shown.exact
    drawn = [key for key in shown.approaches if key not in exact]
    places = itertools.product(shown.terms, frequencies_hz.items())
    return ChartSet(
        tuple(_chart(of_term, name, hz, shown) for of_term, (name, hz) in places),
        tuple(of_approaches(drawn, (INDIVIDUAL, COMMON), marks=True)),
        {key: power_of_ten(bound) for key, bound in exact.items()},
    )


def _chart(
    of_term: series.ErrorsOfTerm, name: str, hz: float, shown: series.ErrorsByLevel
) -> Chart:
    """The errors of one coefficient at one frequency."""
    symbol, where = of_term.term.symbol, f"{frequency_name(name)}, {hz:g} Hz"
    named = italic(symbol)
    drawn = [key for key in shown.approaches if key not in of_term.exact]
    rows = _rows(of_term.errors[name], drawn, shown)
    table = Table(f"error-{symbol}-{name}".replace("_", ""), rows)
    limits = (-0.6, len(shown.names) - 0.4)
    return Chart(
        id=table.id,
        title=f"{named} at {where}",
        description=f"Error of {symbol} at {hz:g} Hz by approach and pair of excitation levels.",
        table=table,
        x=Axis("at", "levels of the pair (mm)", limits=limits, labels=shown.names),
        y=signed_axis("error", f"error of {named} (%)", of_term.scale),
        layers=tuple(_points(drawn, filled) for filled in (True, False)),
        says=(
            Value("name", "approach"),
            Value("sharing", "phi and t_s"),
            Value("pair", "levels", "mm"),
            Value("error", "error", "%"),
        ),
        nearest="xy",
    )


def _rows(
    errors: series.Errors, drawn: Sequence[str], shown: series.ErrorsByLevel
) -> dict[str, list[object]]:
    """A row per estimate: where it stands, what it is, and its error."""
    rows: dict[str, list[object]] = {
        n: [] for n in ("at", "error", "approach", "name", "sharing", "pair")
    }
    step = min(0.16, 0.8 / max(1, len(drawn)))  # of an approach from the next, in places
    for (approach, sharing, pair), error in errors.items():
        if approach not in drawn:
            continue
        place = shown.places.index(pair)
        at = place + step * (drawn.index(approach) - 0.5 * (len(drawn) - 1))
        what = (approach, plain(label_of(approach)), SHARINGS[sharing], shown.names[place])
        for column, value in zip(rows, (at, error, *what), strict=True):
            rows[column].append(value)
    return rows


def _points(drawn: Sequence[str], filled: bool) -> Spec:
    """Estimates with common (filled) or individual (open) φ and t_s."""
    colours = coded("approach", {key: series_colour(key) for key in drawn})
    mark = {"type": "point", "size": 46, "opacity": 1, "strokeWidth": 1.6, "clip": True}
    encoding = {
        "shape": coded("approach", {key: look_of(key).shape for key in drawn}),
        "stroke": colours,
        "fill": colours if filled else {"value": variable("paper")},
    }
    test = f"datum.sharing === '{SHARINGS[COMMON]}'"
    chosen = [{"filter": test if filled else f"!({test})"}]
    return {"transform": chosen, "mark": mark, "encoding": encoding}
