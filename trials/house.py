"""Draw the house, the rooms of the package and what they import, and count its rooms, arrows and floors.

A room is a module at the root of the package, or a folder. It stands on the floor above the highest room that it
imports. An arrow that follows from others is counted but not drawn.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from dampbalance.figures.style import COOL, GREY, INK, arrow, page, place, save_svg, styled
from folders import ROOT

SOURCE = ROOT / "src"
PACKAGE = SOURCE / "dampbalance"
PICTURE = ROOT / "paper/figures/house.svg"
MODULES = {
    ".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__"): path
    for path in sorted(PACKAGE.rglob("*.py"))
}
FACE = {"dampbalance"}  # the face of the package, from which others take the version alone

# Where a room stands on its floor, from the left: chosen so that no arrow crosses a room.
_PLACES = {
    **dict.fromkeys(("model", "law", "features", "balance", "solver", "estimates", "replication"), 0.0),
    **dict.fromkeys(("arrays", "arguments", "motion", "fit", "studies"), 1.0),
    **dict.fromkeys(("record", "records", "joints", "identification"), 2.0),
    **dict.fromkeys(("project", "figures", "loops"), 3.0),
    "signals": 1.5, "publishing": 0.5, "measured": 2.5, "commands": 2.5,
}  # fmt: skip
_WIDTH, _HEIGHT, _FLOOR, _COLUMN = 23.0, 5.0, 9.5, 30.0  # of a room, and from one to the next, mm


def imported(module: str, path: Path, text: str | None = None) -> set[str]:
    """Return the modules of the package that a module imports, anywhere in it."""
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    names = set()
    for node in ast.walk(ast.parse(text or path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.ImportFrom):
            continue
        base = package[: len(package) - node.level + 1] if node.level else []
        start = ".".join([*base, *([node.module] if node.module else [])])
        for alias in node.names:
            inner = f"{start}.{alias.name}"
            names.add(inner if inner in MODULES else start)
    return {name for name in names if name in MODULES} - {module}


@cache
def graph() -> dict[str, set[str]]:
    """Return the modules that each module imports."""
    return {module: imported(module, path) for module, path in MODULES.items()}


def rooms() -> dict[str, set[str]]:
    """Return the rooms that each room imports."""
    of: dict[str, set[str]] = {}
    for module, others in graph().items():
        if module not in (*FACE, "dampbalance.__main__"):
            room = module.split(".")[1]
            names = {other.split(".")[1] for other in others - FACE}
            of[room] = of.get(room, set()) | names - {room}
    return of


def reached(start: Iterable[str], imports: Mapping[str, set[str]]) -> set[str]:
    """Return what these modules, or rooms, import, directly or through others, and themselves."""
    found, waiting = set[str](), set(start)
    while waiting:
        found |= waiting
        waiting = {other for name in waiting for other in imports[name]} - found
    return found


def floor(room: str) -> int:
    """Return the floor of a room: 0 for one that imports no other."""
    return 1 + max(map(floor, rooms()[room]), default=-1)


def direct(room: str) -> set[str]:
    """Return the rooms to which an arrow is drawn: those that no other imported room reaches."""
    of = rooms()
    return of[room] - reached({next for other in of[room] for next in of[other]}, of)


def drawing() -> Figure:
    """Draw each room on its floor, with arrows to what it imports; a folder is tinted."""
    floors = {room: floor(room) for room in rooms()}
    wide, high = 3.0 * _COLUMN + _WIDTH + 2.0, max(floors.values()) * _FLOOR + _HEIGHT + 2.0
    with styled():
        figure = page(wide, high)
        axes = place(figure, 0.0, 0.0, wide, high)
        axes.set(xlim=(0.0, wide), ylim=(0.0, high))
        axes.axis("off")
        at = {
            room: (
                1.0 + _WIDTH / 2.0 + _COLUMN * _PLACES[room],
                1.0 + _HEIGHT / 2.0 + _FLOOR * level,
            )
            for room, level in floors.items()
        }
        for room, (x, y) in at.items():
            for other in sorted(direct(room)):
                arrow(
                    axes, (x, y - _HEIGHT / 2.0), (at[other][0], at[other][1] + _HEIGHT / 2.0), INK
                )
            corner, colour = (
                (x - _WIDTH / 2.0, y - _HEIGHT / 2.0),
                COOL if (PACKAGE / room).is_dir() else GREY,
            )
            axes.add_patch(
                FancyBboxPatch(
                    corner,
                    _WIDTH,
                    _HEIGHT,
                    "round,pad=0,rounding_size=1",
                    fc=colour,
                    ec=INK,
                    lw=0.6,
                )
            )
            axes.text(x, y, room, ha="center", va="center")
    return figure


def described() -> str:
    """Return what the drawing shows, in words: each room and the rooms to which its arrows lead."""
    return "; ".join(
        f"{room} imports {', '.join(sorted(direct(room))) or 'none'}" for room in sorted(rooms())
    )


if __name__ == "__main__":
    save_svg(drawing(), PICTURE, described())
    print(
        f"{len(rooms())} rooms, {sum(map(len, rooms().values()))} arrows, {1 + max(map(floor, rooms()))} floors"
    )
