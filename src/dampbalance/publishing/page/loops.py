"""Figure 3 for the page: acceleration against displacement and velocity, with every value at hand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...figures.cycle import branches, first_onset, right_end, whole
from ...motion.orbit import Orbit
from .charts import NAMED, Axis, Chart, Spec, Table, Value, coded, nominal, quantitative
from .colours import variable

ACCELERATION = "acceleration *ẍ* (m/s²)"
DISPLACEMENT, VELOCITY = "displacement *x* (mm)", "velocity *ẋ* (m/s)"
_SAYS = (
    Value("level", "base amplitude *Y*", "mm"),
    Value("phase", "phase"),
    Value("t", "time since −*X*", "ms"),
    Value("x", "*x*", "mm"),
    Value("v", "*ẋ*", "m/s"),
    Value("acc", "*ẍ*", "m/s²"),
)


def figure3_charts(orbits: Sequence[Orbit]) -> list[Chart]:
    """The four panels of Figure 3, those that enlarge left out where nothing slips.

    orbits : the responses of one frequency, one per level. Raises ValueError when there is none.
    """
    onset = first_onset(orbits)
    table = _table(orbits, "orbits")
    words = "closed loops, growing with the base amplitude."
    a, c = (
        _panel(
            f"({letter}) {title}",
            f"Acceleration {title}: {words}",
            table,
            Axis(column, x_title, limits=_around(table, column)),
            _around(table, "acc"),
            (_loops(), _level_names(orbits, column)),
        )
        for letter, column, x_title, title in (
            ("a", "x", DISPLACEMENT, "against displacement, all levels"),
            ("c", "v", VELOCITY, "against velocity, all levels"),
        )
    )
    if onset is None:
        return [a, c]
    one = _table([onset.orbit], "orbit")
    level, length = f"{1e3 * onset.orbit.motion.Y:g} mm", f"{1e3 * onset.length:.4g} µm"
    ends = list(zip(("−X", "Xₛ"), onset.x, onset.acceleration, strict=True))
    b = _panel(
        f"(b) the microsticking line at *Y* = {level}",
        f"The steep line from −X to X_s at Y = {level}, {length} long.",
        one,
        Axis("x", DISPLACEMENT, limits=onset.x_limits),
        onset.acceleration_limits,
        (_loops(2.2), *_rings("x", ends, f"X + Xₛ = {length}")),
    )
    d = _panel(
        f"(d) the corner at slip onset, *Y* = {level}",
        f"The corner at the velocity V_s = {onset.V_s:.4g} m/s of slip onset at Y = {level}.",
        one,
        Axis("v", VELOCITY, limits=onset.v_limits),
        onset.acceleration_limits,
        (_loops(2.2), *_rings("v", [("Vₛ", onset.V_s, onset.acceleration[1])], "")),
    )
    return [a, b, c, d]


def _panel(
    title: str,
    description: str,
    table: Table,
    x: Axis,
    y_limits: tuple[float, float],
    layers: tuple[Spec, ...],
) -> Chart:
    """One panel of Figure 3, named after the letter that its title begins with."""
    y = Axis("acc", ACCELERATION, limits=y_limits)
    name = f"figure3-{title[1]}"
    return Chart(name, title, description, table, x, y, layers, _SAYS, nearest="xy")


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
    x, v, acceleration, _ = (np.concatenate(parts) for parts in zip(*states, strict=True))
    numbers = {"t": np.concatenate(times), "x": 1e3 * x, "v": v, "acc": acceleration}
    # 2 Z_m, some micrometres, must be seen on displacements of some millimetres: seven digits for x.
    return Table(name, {**words, **numbers}, digits={"x": 7, "t": 6})


def _loops(width: float = 1.6) -> Spec:
    """All levels: a line per phase of the motion, microstick in its own colour."""
    colours = {"slip": variable("slip"), "microstick": variable("stick")}
    return {
        "mark": {"type": "line", "strokeWidth": width, "clip": True},
        "encoding": {
            "detail": [nominal("level"), nominal("branch")],
            "order": quantitative("i"),
            "color": coded("phase", colours),
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
    mark = {"type": "text", "baseline": "middle", **beside}
    return {"data": {"values": places}, "mark": mark, **NAMED}


def _around(table: Table, column: str) -> tuple[float, float]:
    """Limits a little wider than the values of a column."""
    values = np.asarray(table.columns[column])
    margin = 0.08 * float(values.max() - values.min())
    return float(values.min()) - margin, float(values.max()) + margin


def _rings(column: str, marks: Sequence[tuple[str, float, float]], below: str) -> list[Spec]:
    """Rings on the curve with their symbols, and a remark below the last."""
    values = [{column: x, "acc": y, "name": name} for name, x, y in marks]
    data = {"data": {"values": values}}
    ring = {"type": "point", "size": 60, "filled": True, "fill": variable("paper")}
    ring |= {"stroke": variable("ink"), "strokeWidth": 1.4, "opacity": 1, "clip": True}
    words = {"type": "text", "align": "left", "dx": 9, "dy": 9, "fontSize": 13, "clip": True}
    symbols = words | {"fontStyle": "italic"}
    layers: list[Spec] = [{**data, "mark": ring}, {**data, "mark": symbols, **NAMED}]
    if below:
        remark = {"data": {"values": [values[-1] | {"name": below}]}}
        layers.append({**remark, "mark": words | {"dy": 27, "fontSize": 11.5}, **NAMED})
    return layers
