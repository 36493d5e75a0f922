"""Figure 1: the oscillator, its moving base, and the compliant friction contact."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from .style import COOL, FAINT, GREY, INK, SINGLE_COLUMN, STICK, WARM, arrow, page, place, styled

HEIGHT = 46.5  # mm
LINE = 1.0  # points, outlines of the parts

# Places on the page, mm. The ground carries everything; parts stand left to right.
GROUND = 4.5
BASE = (5.0, 10.0)  # left and right face of the moving base
MASS = (33.0, 53.0)  # left and right face of the mass
MASS_BOTTOM, MASS_TOP = 9.5, 35.5
WALL = 84.0  # left face of the wall that holds the damper
SLIDER = (73.5, 79.0)
SPRING_LEVEL, DAMPER_LEVEL, CONTACT_LEVEL = 22.5, 29.5, 16.5
TOP_LEVEL = 42.0  # of the arrows for y and x


@styled()
def schematic() -> Figure:
    """Figure 1: base-excited oscillator with viscous damping and a compliant friction contact (Jenkins element).

    The spring k joins the mass to the base, which moves by y; the damper c joins it to the ground; the contact
    spring K_z, of deflection z, joins it to a slider that the ground holds back by a friction force f of at most
    F_k:  m ẍ + c ẋ + k x + f = k y, f = K_z z, |f| ≤ F_k, Eqs. (1)–(3).
    """
    figure = page(SINGLE_COLUMN, HEIGHT)
    axes = place(figure, 0.0, 0.0, SINGLE_COLUMN, HEIGHT)
    axes.set(xlim=(0.0, SINGLE_COLUMN), ylim=(0.0, HEIGHT))  # the unit of the drawing is the mm
    axes.set_axis_off()

    # the ground that carries everything, and the wall that holds the damper
    top = DAMPER_LEVEL + 6.0
    _line(axes, [3.0, WALL], [GROUND, GROUND])
    _line(axes, [WALL, WALL], [GROUND, top])
    _hatch(axes, 3.0, GROUND - 2.6, WALL, 2.6)
    _hatch(axes, WALL, GROUND, 3.0, top - GROUND)
    # the moving base, and the mass: plates on rollers
    for (left, right), low, inset, fill in (
        (BASE, 6.7, 1.1, GREY),
        (MASS, MASS_BOTTOM, 4.5, COOL),
    ):
        _block(axes, (left, right), low, MASS_TOP, fill)
        radius = 0.5 * (low - GROUND)
        for x in (left + inset, right - inset):
            axes.add_patch(Circle((x, GROUND + radius), radius, fc="white", ec=INK, lw=LINE))
    middle = 0.5 * (MASS[0] + MASS[1])
    axes.text(middle, 0.5 * (MASS_BOTTOM + MASS_TOP), "$m$", ha="center", va="center", size=12)
    _spring(axes, BASE[1], MASS[0], SPRING_LEVEL, coils=7, label="$k$")
    _damper(axes, MASS[1], WALL, DAMPER_LEVEL, label="$c$")
    _spring(
        axes, MASS[1], SLIDER[0], CONTACT_LEVEL, coils=5, label="$K_z$", colour=STICK, below=True
    )
    # the slider that the ground holds back by friction; force f and deflection z of the contact
    left, right = SLIDER
    top = CONTACT_LEVEL + 3.0
    _block(axes, SLIDER, GROUND, top, WARM, STICK)
    axes.text(0.5 * (left + right), 0.5 * (GROUND + top), "$F_k$", ha="center", va="center")
    _line(axes, [left - 1.0, right + 1.0], [GROUND, GROUND], STICK, 2.2)  # where it rubs
    arrow(axes, (left - 0.8, GROUND + 2.5), (left - 6.5, GROUND + 2.5), STICK)
    axes.text(left - 7.2, GROUND + 2.5, "$f(t)$", ha="right", va="center")
    _named_arrow(axes, MASS[1], CONTACT_LEVEL + 4.4, "$z(t)$", STICK)
    # the coordinates: thin marks above the parts that move
    for x, label in ((BASE[1], "$y(t)$"), (middle, "$x(t)$")):
        _line(axes, [x, x], [MASS_TOP + 1.0, TOP_LEVEL + 1.2], FAINT, 0.6)
        _named_arrow(axes, x, TOP_LEVEL, label)
    return figure


def _spring(
    axes: Axes,
    left: float,
    right: float,
    level: float,
    coils: int,
    label: str,
    colour: str = INK,
    below: bool = False,
) -> None:
    """A zigzag between two points of one height, its label above or below."""
    lead, half = 0.14 * (right - left), 1.7
    zigzag = np.linspace(left + lead, right - lead, 2 * coils + 1)
    heights = level + half * np.array([0.0, *(((-1.0) ** n) for n in range(2 * coils - 1)), 0.0])
    _line(axes, [left, *zigzag, right], [level, *heights, level], colour)
    at, anchor = (level - half - 1.0, "top") if below else (level + half + 1.2, "bottom")
    axes.text(0.5 * (left + right), at, label, ha="center", va=anchor)


def _damper(axes: Axes, left: float, right: float, level: float, label: str) -> None:
    """A piston on the left in a pot on the right."""
    half, back, open_end, piston = 2.2, 0.62, 0.40, 0.52

    def at(share: float) -> float:
        return left + share * (right - left)

    pot = [level + half, level + half, level - half, level - half]
    _line(axes, [at(open_end), at(back), at(back), at(open_end)], pot)
    _line(axes, [at(back), right], [level, level])
    _line(axes, [left, at(piston)], [level, level])
    _line(axes, [at(piston), at(piston)], [level - 0.75 * half, level + 0.75 * half])
    axes.text(at(0.5 * (open_end + back)), level + half + 1.0, label, ha="center", va="bottom")


def _named_arrow(axes: Axes, x: float, level: float, label: str, colour: str = INK) -> None:
    arrow(axes, (x, level), (x + 7.0, level), colour)
    axes.text(x + 7.8, level, label, ha="left", va="center")


def _block(
    axes: Axes, faces: tuple[float, float], low: float, top: float, fill: str, edge: str = INK
) -> None:
    left, right = faces
    axes.add_patch(Rectangle((left, low), right - left, top - low, fc=fill, ec=edge, lw=LINE))


def _hatch(axes: Axes, left: float, bottom: float, width: float, height: float) -> None:
    where = (left, bottom), width, height
    axes.add_patch(Rectangle(*where, fc="none", ec=FAINT, lw=0.0, hatch="//////"))


def _line(
    axes: Axes, x: list[float], y: list[float], colour: str = INK, width: float = LINE
) -> None:
    axes.plot(x, y, color=colour, lw=width, solid_capstyle="round", solid_joinstyle="round")
