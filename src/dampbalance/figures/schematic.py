"""Figure 1: the oscillator, its moving base, and the compliant friction contact."""

from __future__ import annotations

from functools import partial

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from .style import COOL, FAINT, GREY, INK, SINGLE_COLUMN, STICK, WARM, arrow, page, place, styled

SCHEMATIC_HEIGHT = 46.5  # mm
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
    """Draw figure 1: base-excited oscillator with viscous damping and a compliant friction contact (Jenkins element).

    The spring k joins the mass to the base, which moves by y; the damper c joins it to the ground; the contact
    spring K_z, of deflection z, joins it to a slider that the ground holds back by a friction force f of at most
    F_k:  m ẍ + c ẋ + k x + f = k y, f = K_z z, |f| ≤ F_k, Eqs. (1)–(3).
    """
    figure = page(SINGLE_COLUMN, SCHEMATIC_HEIGHT)
    axes = place(figure, 0.0, 0.0, SINGLE_COLUMN, SCHEMATIC_HEIGHT)
    axes.set(
        xlim=(0.0, SINGLE_COLUMN), ylim=(0.0, SCHEMATIC_HEIGHT)
    )  # the unit of the drawing is the mm
    axes.set_axis_off()
    text = partial(axes.text, ha="center", va="center")

    def line(x: list[float], y: list[float], colour: str = INK, width: float = LINE) -> None:
        axes.plot(x, y, color=colour, lw=width, solid_capstyle="round", solid_joinstyle="round")

    def block(faces: tuple[float, float], low: float, top: float, fill: str, edge: str) -> None:
        size = faces[1] - faces[0], top - low
        axes.add_patch(Rectangle((faces[0], low), *size, fc=fill, ec=edge, lw=LINE))

    def spring(
        left: float, right: float, level: float, coils: int, colour: str
    ) -> tuple[float, float]:
        lead = 0.14 * (right - left)
        zigzag = np.linspace(left + lead, right - lead, 2 * coils + 1)
        heights = level + 1.7 * np.array([0.0, *((-1.0) ** np.arange(2 * coils - 1)), 0.0])
        line([left, *zigzag, right], [level, *heights, level], colour)
        return 0.5 * (left + right), level

    def named_arrow(x: float, level: float, label: str, colour: str = INK) -> None:
        arrow(axes, (x, level), (x + 7.0, level), colour)
        text(x + 7.8, level, label, ha="left")

    # the ground that carries everything, and the wall that holds the damper
    top = DAMPER_LEVEL + 6.0
    line([3.0, WALL], [GROUND, GROUND])
    line([WALL, WALL], [GROUND, top])
    for corner, size in (((3.0, GROUND - 2.6), (WALL, 2.6)), ((WALL, GROUND), (3.0, top - GROUND))):
        axes.add_patch(Rectangle(corner, *size, fc="none", ec=FAINT, lw=0.0, hatch="//////"))
    # the moving base, and the mass: plates on rollers
    for (left, right), low, inset, fill in ((BASE, 6.7, 1.1, GREY), (MASS, MASS_BOTTOM, 4.5, COOL)):
        block((left, right), low, MASS_TOP, fill, INK)
        radius = 0.5 * (low - GROUND)
        for x in (left + inset, right - inset):
            axes.add_patch(Circle((x, GROUND + radius), radius, fc="white", ec=INK, lw=LINE))
    middle = 0.5 * (MASS[0] + MASS[1])
    text(middle, 0.5 * (MASS_BOTTOM + MASS_TOP), "$m$", size=12)
    x, level = spring(BASE[1], MASS[0], SPRING_LEVEL, 7, INK)
    text(x, level + 2.9, "$k$", va="bottom")
    # the damper: a piston on the left in a pot on the right
    back, open_end, piston = (MASS[1] + share * (WALL - MASS[1]) for share in (0.62, 0.40, 0.52))
    level, half = DAMPER_LEVEL, 2.2
    line([open_end, back, back, open_end], [level + half, level + half, level - half, level - half])
    line([back, WALL], [level, level])
    line([MASS[1], piston], [level, level])
    line([piston, piston], [level - 0.75 * half, level + 0.75 * half])
    text(MASS[1] + 0.51 * (WALL - MASS[1]), level + half + 1.0, "$c$", va="bottom")
    x, level = spring(MASS[1], SLIDER[0], CONTACT_LEVEL, 5, STICK)
    text(x, level - 2.7, "$K_z$", va="top")
    # the slider that the ground holds back by friction; force f and deflection z of the contact
    left, right = SLIDER
    top = CONTACT_LEVEL + 3.0
    block(SLIDER, GROUND, top, WARM, STICK)
    text(0.5 * (left + right), 0.5 * (GROUND + top), "$F_k$")
    line([left - 1.0, right + 1.0], [GROUND, GROUND], STICK, 2.2)  # where it rubs
    arrow(axes, (left - 0.8, GROUND + 2.5), (left - 6.5, GROUND + 2.5), STICK)
    text(left - 7.2, GROUND + 2.5, "$f(t)$", ha="right")
    named_arrow(MASS[1], CONTACT_LEVEL + 4.4, "$z(t)$", STICK)
    # the coordinates: thin marks above the parts that move
    for x, label in ((BASE[1], "$y(t)$"), (middle, "$x(t)$")):
        line([x, x], [MASS_TOP + 1.0, TOP_LEVEL + 1.2], FAINT, 0.6)
        named_arrow(x, TOP_LEVEL, label)
    return figure
