"""Figure 3 for the page: acceleration against displacement and velocity, with every value at hand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...figures.cycle import Onset, branches, first_onset, right_end, whole
from ...motion.orbit import Orbit
from .charts import Axis, Chart, Spec, Table, Value
from .colours import variable

ACCELERATION = "acceleration ẍ (m/s²)"
DISPLACEMENT, VELOCITY = "displacement x (mm)", "velocity ẋ (m/s)"
_SAYS = (
    Value("level", "base amplitude Y", "mm"),
    Value("phase", "phase"),
    Value("t", "time since −X", "ms"),
    Value("x", "x", "mm"),
    Value("v", "ẋ", "m/s"),
    Value("acc", "ẍ", "m/s²"),
)


def figure3_charts(orbits: Sequence[Orbit]) -> list[Chart]:
    """The four panels of Figure 3, those that enlarge left out where nothing slips.

    orbits : the responses of one frequency, one per level. Raises ValueError when there is none.
    """
    onset = first_onset(orbits)
    table = _table(orbits, "orbits")
    whole = (
        ("figure3-a", "x", DISPLACEMENT, "(a) against displacement, all levels"),
        ("figure3-c", "v", VELOCITY, "(c) against velocity, all levels"),
    )
    a, c = (
        Chart(
            id=name,
            title=title,
            description=f"Acceleration {title[4:]}: closed loops, growing with the base amplitude.",
            table=table,
            x=Axis(column, x_title, limits=_around(table, column)),
            y=Axis("acc", ACCELERATION, limits=_around(table, "acc")),
            layers=(_loops(), _level_names(orbits, column)),
            says=_SAYS,
            nearest="xy",
        )
        for name, column, x_title, title in whole
    )
    if onset is None:
        return [a, c]
    one = _table([onset.orbit], "orbit")
    return [a, _microstick_line(one, onset), c, _corner(one, onset)]


def _table(orbits: Sequence[Orbit], name: str) -> Table:
    """One row per instant: level, phase and branch, time since the reversal at −X in ms, x in mm, ẋ, ẍ."""
    words: dict[str, list[str | int]] = {n: [] for n in ("level", "phase", "branch")}
    times, states = [], []
    for orbit in orbits:
        cycle = branches(orbit)
        states.append(whole(cycle))
        for place, branch in enumerate(cycle):
            count = len(branch.t)
            times.append(1e3 * branch.t)
            words["level"] += [f"{1e3 * orbit.motion.Y:g}"] * count
            words["phase"] += ["microstick" if branch.stick else "slip"] * count
            words["branch"] += [place] * count
    numbers = {
        "t": np.concatenate(times),
        "x": np.concatenate([1e3 * state.x for state in states]),
        "v": np.concatenate([state.v for state in states]),
        "acc": np.concatenate([state.acceleration for state in states]),
    }
    # 2 Z_m, some micrometres, must be seen on displacements of some millimetres: seven digits for x.
    return Table(name, {**words, **numbers}, digits={"x": 7, "t": 6})


def _loops(width: float = 1.6) -> Spec:
    """All levels: a line per phase of the motion, microstick in its own colour."""
    return {
        "mark": {"type": "line", "strokeWidth": width, "clip": True},
        "encoding": {
            "detail": [
                {"field": "level", "type": "nominal"},
                {"field": "branch", "type": "nominal"},
            ],
            "order": {"field": "i", "type": "quantitative"},
            "color": {
                "field": "phase",
                "type": "nominal",
                "scale": {
                    "domain": ["slip", "microstick"],
                    "range": [variable("slip"), variable("stick")],
                },
                "legend": None,
            },
        },
    }


def _level_names(orbits: Sequence[Orbit], column: str) -> Spec:
    """The base amplitude of each loop, mm: above its right end over x, inside it over ẋ."""
    places = []
    for orbit in orbits:
        if column == "x":
            across, up = right_end(orbit)
        else:
            states = whole(branches(orbit))
            far = int(np.argmax(states.v))
            across, up = states.v[far], states.acceleration[far]
        name = f"{1e3 * orbit.motion.Y:g}"
        places.append({column: float(f"{across:.6g}"), "acc": float(f"{up:.6g}"), "name": name})
    beside = {"align": "center", "dy": -10} if column == "x" else {"align": "right", "dx": -5}
    return {
        "data": {"values": places},
        "mark": {"type": "text", "baseline": "middle", **beside},
        "encoding": {"text": {"field": "name", "type": "nominal"}},
    }


def _microstick_line(table: Table, onset: Onset) -> Chart:
    """Panel (b): the line from −X to X_s of the weakest level that slips, of length 2 Z_m."""
    level, length = f"{1e3 * onset.orbit.motion.Y:g} mm", f"{1e3 * onset.length:.4g} µm"
    marks = list(zip(("−X", "Xₛ"), onset.x, onset.acceleration, strict=True))
    return Chart(
        id="figure3-b",
        title=f"(b) the microsticking line at Y = {level}",
        description=f"The steep line from −X to X_s at Y = {level}, {length} long.",
        table=table,
        x=Axis("x", DISPLACEMENT, limits=onset.x_limits),
        y=Axis("acc", ACCELERATION, limits=onset.acceleration_limits),
        layers=(_loops(2.2), *_rings("x", marks, f"2 Zₘ = {length}")),
        says=_SAYS,
        nearest="xy",
    )


def _corner(table: Table, onset: Onset) -> Chart:
    """Panel (d): the corner where microstick gives way to slip, at V_s."""
    level = f"{1e3 * onset.orbit.motion.Y:g} mm"
    return Chart(
        id="figure3-d",
        title=f"(d) the corner at slip onset, Y = {level}",
        description=f"The corner at the velocity V_s = {onset.V_s:.4g} m/s of slip onset at Y = {level}.",
        table=table,
        x=Axis("v", VELOCITY, limits=onset.v_limits),
        y=Axis("acc", ACCELERATION, limits=onset.acceleration_limits),
        layers=(_loops(2.2), *_rings("v", [("Vₛ", onset.V_s, onset.acceleration[1])], "")),
        says=_SAYS,
        nearest="xy",
    )


def _around(table: Table, column: str) -> tuple[float, float]:
    """Limits a little wider than the values of a column."""
    values = np.asarray(table.columns[column])
    margin = 0.08 * float(values.max() - values.min())
    return float(values.min()) - margin, float(values.max()) + margin


def _rings(column: str, marks: Sequence[tuple[str, float, float]], below: str) -> list[Spec]:
    """Rings on the curve with their symbols, and a remark below the last."""
    values = [{column: x, "acc": y, "name": name} for name, x, y in marks]
    data = {"data": {"values": values}}
    ring = {
        "type": "point",
        "size": 60,
        "filled": True,
        "fill": variable("paper"),
        "stroke": variable("ink"),
        "strokeWidth": 1.4,
        "opacity": 1,
        "clip": True,
    }
    words = {"type": "text", "align": "left", "dx": 9, "dy": 9, "fontSize": 13, "clip": True}
    named = {"encoding": {"text": {"field": "name", "type": "nominal"}}}
    layers: list[Spec] = [{**data, "mark": ring}, {**data, "mark": words, **named}]
    if below:
        remark = {"data": {"values": [values[-1] | {"name": below}]}}
        layers.append({**remark, "mark": words | {"dy": 27, "fontSize": 11.5}, **named})
    return layers
