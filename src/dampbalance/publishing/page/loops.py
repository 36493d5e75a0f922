"""Figure 3 for the page: acceleration against displacement and velocity, with every value at hand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...figures.cycle import branches
from ...motion.events import PHASE_T
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
    if not orbits:
        raise ValueError("Figure 3 needs at least one orbit: give the responses of one frequency")
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
    slipping = next((orbit for orbit in orbits if orbit.X_s > -orbit.X), None)
    if slipping is None:
        return [a, c]
    one = _table([slipping], "orbit")
    return [a, _microstick_line(one, slipping), c, _corner(one, slipping)]


def _table(orbits: Sequence[Orbit], name: str) -> Table:
    """One row per instant: level, phase and branch, time since the reversal at −X in ms, x in mm, ẋ, ẍ."""
    parts: dict[str, list[np.ndarray]] = {n: [] for n in ("t", "x", "v", "acc")}
    words: dict[str, list[str | int]] = {n: [] for n in ("level", "phase", "branch")}
    for orbit in orbits:
        for place, branch in enumerate(branches(orbit)):
            state = branch.state
            count = len(state.x)
            parts["t"].append(1e3 * _since_reversal(orbit, place, count))
            parts["x"].append(1e3 * state.x)
            parts["v"].append(state.v)
            parts["acc"].append(state.acceleration)
            words["level"] += [f"{1e3 * orbit.motion.Y:g}"] * count
            words["phase"] += ["microstick" if branch.stick else "slip"] * count
            words["branch"] += [place] * count
    numbers = {name: np.concatenate(values) for name, values in parts.items()}
    # 2 Z_m, some micrometres, must be seen on displacements of some millimetres: seven digits for x.
    return Table(name, {**words, **numbers}, digits={"x": 7, "t": 6})


def _since_reversal(orbit: Orbit, branch: int, count: int) -> np.ndarray:
    """Times since the reversal at −X of the points of a branch, s."""
    half = 0.5 * orbit.motion.period
    edges = np.append(orbit.phases[:, PHASE_T], half)
    turn, n = divmod(branch, len(orbit.phases))
    times: np.ndarray = turn * half + np.linspace(edges[n], edges[n + 1], count)
    return times


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
        states = [branch.state for branch in branches(orbit)]
        across = np.concatenate([1e3 * s.x if column == "x" else s.v for s in states])
        up = np.concatenate([s.acceleration for s in states])
        far = int(np.argmax(across))
        height = up[across > 0.98 * across[far]].max() if column == "x" else up[far]
        places.append(
            {
                column: float(f"{across[far]:.6g}"),
                "acc": float(f"{height:.6g}"),
                "name": f"{1e3 * orbit.motion.Y:g}",
            }
        )
    beside = {"align": "center", "dy": -10} if column == "x" else {"align": "right", "dx": -5}
    return {
        "data": {"values": places},
        "mark": {"type": "text", "baseline": "middle", **beside},
        "encoding": {"text": {"field": "name", "type": "nominal"}},
    }


def _microstick_line(table: Table, orbit: Orbit) -> Chart:
    """Panel (b): the line from −X to X_s of the weakest level that slips, of length 2 Z_m."""
    level = f"{1e3 * orbit.motion.Y:g} mm"
    reversal, slip = -1e3 * orbit.X, 1e3 * orbit.X_s
    length = slip - reversal
    top, bottom = _ends(orbit)
    marks = [("−X", reversal, top), ("Xₛ", slip, bottom)]
    return Chart(
        id="figure3-b",
        title=f"(b) the microsticking line at Y = {level}",
        description=f"The steep line from −X to X_s at Y = {level}, {1e3 * length:.4g} µm long.",
        table=table,
        x=Axis("x", DISPLACEMENT, limits=(reversal - 0.9 * length, slip + 2.4 * length)),
        y=Axis("acc", ACCELERATION, limits=_room(top, bottom)),
        layers=(_loops(2.2), *_rings("x", marks, f"2 Zₘ = {1e3 * length:.4g} µm")),
        says=_SAYS,
        nearest="xy",
    )


def _corner(table: Table, orbit: Orbit) -> Chart:
    """Panel (d): the corner where microstick gives way to slip, at V_s."""
    level = f"{1e3 * orbit.motion.Y:g} mm"
    top, bottom = _ends(orbit)
    return Chart(
        id="figure3-d",
        title=f"(d) the corner at slip onset, Y = {level}",
        description=f"The corner at the velocity V_s = {orbit.V_s:.4g} m/s of slip onset at Y = {level}.",
        table=table,
        x=Axis("v", VELOCITY, limits=(-1.6 * orbit.V_s, 3.2 * orbit.V_s)),
        y=Axis("acc", ACCELERATION, limits=_room(top, bottom)),
        layers=(_loops(2.2), *_rings("v", [("Vₛ", orbit.V_s, bottom)], "")),
        says=_SAYS,
        nearest="xy",
    )


def _around(table: Table, column: str) -> tuple[float, float]:
    """Limits a little wider than the values of a column."""
    values = np.asarray(table.columns[column])
    margin = 0.08 * float(values.max() - values.min())
    return float(values.min()) - margin, float(values.max()) + margin


def _ends(orbit: Orbit) -> tuple[float, float]:
    """Acceleration at the reversal at −X and at the slip onset that follows, m/s²."""
    reversal, slip = orbit.state([orbit.t_1, orbit.t_1 + orbit.t_s]).acceleration
    return float(reversal), float(slip)


def _room(top: float, bottom: float) -> tuple[float, float]:
    """Limits around both ends of the microstick phase."""
    drop = top - bottom
    return bottom - 0.6 * drop, top + 0.25 * drop


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
    layers: list[Spec] = [
        {**data, "mark": ring},
        {**data, "mark": words, "encoding": {"text": {"field": "name", "type": "nominal"}}},
    ]
    if below:
        remark = {"data": {"values": [values[-1] | {"name": below}]}}
        encoding = {"text": {"field": "name", "type": "nominal"}}
        layers.append(
            {**remark, "mark": words | {"dy": 27, "fontSize": 11.5}, "encoding": encoding}
        )
    return layers
