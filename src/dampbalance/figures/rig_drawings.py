"""The rigs whose records are identified, in rows of two: what holds the contact, what moves, and what is measured."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from .style import COOL, FAINT, GREY, INK, STICK, WARM, arrow, page, place, styled

_WIDTH, _HEIGHT, _CAPTION = 36.0, 45.0, 11.0  # of a panel and of what is said below it, mm
_ABREAST = 2  # a phone shows as many in full size
_LINE = 0.8  # points
_SPRING, _DAMPER, _CONTACT = 33.0, 25.5, 18.0  # heights at which they are drawn
_LOW, _HIGH = 14.5, 37.5  # of masses and walls
_WALL = 31.5


def _box(axes: Axes, left: float, right: float, fill: str, name: str = "") -> None:
    """Draw a part that moves as a whole."""
    size = right - left, _HIGH - _LOW
    axes.add_patch(Rectangle((left, _LOW), *size, fc=fill, ec=INK, lw=_LINE))
    axes.text(0.5 * (left + right), 0.5 * (_LOW + _HIGH), name, ha="center", va="center")


def _wall(axes: Axes) -> None:
    """Draw the ground, on the right."""
    axes.plot([_WALL, _WALL], [_LOW, _HIGH], color=INK, lw=_LINE)
    size = 2.5, _HIGH - _LOW
    axes.add_patch(Rectangle((_WALL, _LOW), *size, fc="none", ec=FAINT, lw=0.0, hatch="//////"))


def _spring(axes: Axes, left: float, right: float, level: float, name: str, colour: str) -> None:
    inner = np.linspace(left + 0.15 * (right - left), right - 0.15 * (right - left), 9)
    up = 1.3 * np.array([0, 1, -1, 1, -1, 1, -1, 1, 0])
    axes.plot([left, *inner, right], level + np.array([0, *up, 0]), color=colour, lw=_LINE)
    axes.text(0.5 * (left + right), level + 1.6, name, ha="center", va="bottom", color=colour)


def _damper(axes: Axes, left: float, right: float, name: str) -> None:
    back, front, piston = (left + share * (right - left) for share in (0.65, 0.35, 0.5))
    pot = [_DAMPER + of for of in (1.4, 1.4, -1.4, -1.4)]
    axes.plot([front, back, back, front], pot, color=INK, lw=_LINE)
    axes.plot([back, right], [_DAMPER, _DAMPER], color=INK, lw=_LINE)
    axes.plot([left, piston], [_DAMPER, _DAMPER], color=INK, lw=_LINE)
    axes.plot([piston, piston], [_DAMPER - 1.0, _DAMPER + 1.0], color=INK, lw=_LINE)
    axes.text(0.5 * (left + right), _DAMPER + 1.7, name, ha="center", va="bottom")


def _contact(axes: Axes, left: float, right: float) -> None:
    """Draw the spring K_z of the contact, in series with the slider that holds F_k."""
    slider = right - 5.2
    _spring(axes, left, slider, _CONTACT, "$K_z$", STICK)
    axes.add_patch(Rectangle((slider, _CONTACT - 2.2), 4.8, 4.4, fc=WARM, ec=STICK, lw=_LINE))
    axes.text(slider + 2.4, _CONTACT, "$F_k$", ha="center", va="center", size=8.5)
    axes.plot([slider - 0.4, right], [_CONTACT - 2.3] * 2, color=STICK, lw=1.6)


def _motion(axes: Axes, x: float, name: str) -> None:
    """Draw an arrow above the rig, from x on, and its name."""
    arrow(axes, (x, 40.0), (x + 5.5, 40.0), INK)
    axes.text(x + 6.3, 40.0, name, va="center")


def _all_between(axes: Axes, left: float, right: float) -> None:
    _spring(axes, left, right, _SPRING, "$k$", INK)
    _damper(axes, left, right, "$c$")
    _contact(axes, left, right)


def _ground(axes: Axes) -> None:
    _box(axes, 1.0, 4.0, GREY)
    _spring(axes, 4.0, 12.0, _SPRING, "$k$", INK)
    _box(axes, 12.0, 19.0, COOL, "$m$")
    _damper(axes, 19.0, _WALL, "$c$")
    _contact(axes, 19.0, _WALL)
    _wall(axes)
    _motion(axes, 1.0, "$y$")
    _motion(axes, 14.0, "$x$")


def _mount(axes: Axes) -> None:
    _box(axes, 3.0, 6.0, GREY)
    _all_between(axes, 6.0, 22.0)
    _box(axes, 22.0, 31.0, COOL, "$m$")
    _motion(axes, 3.0, "$y$")
    _motion(axes, 25.0, "$x$")


def _load_cell(axes: Axes) -> None:
    middle = 0.5 * (_LOW + _HIGH)
    arrow(axes, (0.5, middle), (4.5, middle), INK)
    axes.text(2.2, middle + 1.2, "$f$", ha="center", va="bottom")
    axes.add_patch(Rectangle((4.6, middle - 2.5), 2.6, 5.0, fc="white", ec=INK, lw=_LINE))
    _box(axes, 7.2, 11.0, GREY, "$m_f$")
    _box(axes, 11.0, 17.0, COOL, "$m$")
    _all_between(axes, 17.0, _WALL)
    _wall(axes)


def _release(axes: Axes) -> None:
    _box(axes, 9.0, 15.0, COOL, "$m$")
    size = 6.0, _HIGH - _LOW
    axes.add_patch(Rectangle((2.5, _LOW), *size, fc="none", ec=FAINT, lw=_LINE, ls=(0, (3, 2))))
    _all_between(axes, 15.0, _WALL)
    _wall(axes)
    arrow(axes, (2.5, 40.0), (8.5, 40.0), INK)
    axes.text(9.5, 40.0, "let go", va="center")


def _blow(axes: Axes) -> None:
    middle = 0.5 * (_LOW + _HIGH)
    _box(axes, 9.0, 16.0, COOL, "$m$")
    _all_between(axes, 16.0, _WALL)
    _wall(axes)
    axes.add_patch(Rectangle((3.4, middle - 1.6), 4.6, 3.2, fc=GREY, ec=INK, lw=_LINE))
    axes.plot([5.0, 2.5], [middle - 1.6, middle - 11.0], color=INK, lw=1.6)


TO_GROUND, MOUNT, LOAD_CELL, RELEASE = (
    "Contact to the ground",
    "Mount on a table",
    "Load cell with a fixture",
    "Release",
)
"""Names of rigs."""

_RIGS: dict[str, tuple[str, Callable[[Axes], None]]] = {
    TO_GROUND: ("base motion or force", _ground),
    MOUNT: ("--contact-to base", _mount),
    LOAD_CELL: ("--fixture-mass", _load_cell),
    RELEASE: ("one free decay", _release),
    "Blow of a hammer": ("one free decay", _blow),
}


@styled()
def rigs(*names: str) -> Figure:
    """Draw the rigs that are covered: what drives, what holds spring, damper and contact, and what to give.

    names : of those to draw; default, all.
    """
    drawn = names or tuple(_RIGS)
    rows = math.ceil(len(drawn) / _ABREAST)
    figure = page(_WIDTH * min(len(drawn), _ABREAST), _HEIGHT * rows)
    for i, name in enumerate(drawn):
        given, draw = _RIGS[name]
        row, column = divmod(i, _ABREAST)
        axes = place(figure, column * _WIDTH, (rows - 1 - row) * _HEIGHT, _WIDTH, _HEIGHT)
        axes.set(xlim=(0.0, _WIDTH), ylim=(0.0, _HEIGHT))  # in mm
        axes.set_axis_off()
        draw(axes)
        axes.text(0.5 * _WIDTH, _CAPTION - 1.0, name, ha="center", va="top", weight="bold")
        axes.text(0.5 * _WIDTH, _CAPTION - 6.0, given, ha="center", va="top", color=FAINT)
    return figure
