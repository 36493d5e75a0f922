"""The article at a glance: where the excess of c comes from, and what goes wrong off resonance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from .numerics import OTHER, PRINTED, REBUILT
from .style import DOUBLE_COLUMN, FAINT, INK, arrow, note, page, panel_letter, place, styled

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure

ALT = (
    "Left: on an axis of c, the true value; that plus the numerical dissipation of backward Euler; the value that the "
    "rebuilt simulation gives; and the printed one. The last three nearly coincide. Right: errors of the friction "
    "force at each drive frequency: large off resonance as in the paper's pairs, below one per cent at the highest "
    "frequency with the phase of the fundamental of each level, and far smaller by the Fourier energy balance."
)
LOOKS: Sequence[Mapping[str, Any]] = (
    {"marker": "o", "color": PRINTED["color"]},
    {"marker": "^", "color": OTHER},
    {"marker": "s", "color": REBUILT},
)
HEIGHT, BOTTOM, TOP = 36.0, 11.0, 6.0  # mm


class Damping(NamedTuple):
    """c, N s/m: the true value, what the scheme adds to it (mω²h), and what direct integration identifies by least
    squares from the rebuilt simulation and in print."""

    true: float
    added: float
    rebuilt: float
    printed: float


@styled()
def glance(
    damping: Damping, errors: Mapping[str, Sequence[float]], frequencies: Sequence[float]
) -> Figure:
    """Two panels: (a) the damping, true, with that of the scheme, rebuilt and printed; (b) errors of F_k.

    errors : label → error of F_k at each frequency, %, with sign; up to three labels.   frequencies : Hz.
    """
    figure = page(DOUBLE_COLUMN, BOTTOM + HEIGHT + TOP)
    left = place(figure, 28.0, BOTTOM, 62.0, HEIGHT)
    right = place(figure, 110.0, BOTTOM, 68.0, HEIGHT)
    rows = {
        "true $c$": (damping.true, {"marker": "D", "color": INK}),
        r"true $c + m\omega^2h$": (damping.true + damping.added, {"marker": "^", "color": FAINT}),
        "rebuilt": (damping.rebuilt, {"marker": "s", "color": REBUILT}),
        "printed": (damping.printed, {"marker": "o", "color": PRINTED["color"]}),
    }
    for n, (c, mark) in enumerate(rows.values()):
        left.plot([c], [n], gid="$c$", ls="none", ms=4.5, zorder=3, **mark)
        note(left, f"{c:.4f}", (c, n), (5.0, 0.0), "left", "center", size=8.0)
    arrow(left, (damping.true, 1.0), (damping.true + 0.96 * damping.added, 1.0), FAINT)
    left.axvline(damping.true, color=FAINT, lw=0.5, ls=":")
    left.axvline(damping.printed, color=PRINTED["color"], lw=0.5, ls=":")
    left.set_yticks(range(len(rows)), list(rows))
    left.set_ylim(len(rows) - 0.5, -0.6)
    left.set_xlim(damping.true - 0.25 * damping.added, damping.true + 1.6 * damping.added)
    left.ticklabel_format(axis="x", useOffset=False)
    left.locator_params(axis="x", nbins=4)
    left.tick_params(axis="y", length=0)
    left.set_xlabel("$c$ by direct integration, all levels (N s/m)")
    # (b) on an axis that is linear about zero, so that the sign shows
    for n, ((label, values), look) in enumerate(zip(errors.items(), LOOKS, strict=False)):
        places = [f + 0.28 * (n - 1) for f in range(len(frequencies))]
        right.vlines(places, 0.0, values, color=look["color"], lw=1.2)
        right.plot(places, values, ls="none", ms=4.5, label=label, gid=label, **look)
        for at in zip(places, values, strict=True):
            text = f"{at[1]:+#.2g}".rstrip(".").replace("-", "−")
            if (
                n == len(LOOKS) - 1
            ):  # to the right of the last mark, clear of the stems of the others
                note(right, text, at, (2.0, 3.0), "left", size=7.0)
            elif at[1] > 0.0:
                note(right, text, at, (0.0, 4.0), "center", "bottom", size=7.0)
            else:
                note(right, text, at, (0.0, -4.0), "center", "top", size=7.0)
    right.axhline(0.0, color=INK, lw=0.6)
    right.set_yscale("asinh", linear_width=0.05)
    right.set_ylim(-1500.0, 4000.0)
    ticks = [-100, -10, -1, 0, 1, 10, 100]
    right.set_yticks(ticks, [f"{tick:+d}".replace("-", "−") if tick else "0" for tick in ticks])
    right.minorticks_off()
    right.set_xlim(-0.5, len(frequencies) - 0.25)
    right.set_xticks(range(len(frequencies)), [f"{hz:g} Hz" for hz in frequencies])
    right.tick_params(axis="x", length=0)
    right.legend(loc="upper center", ncols=3, fontsize=7.2, handletextpad=0.1, columnspacing=0.7)
    right.set_ylabel("error of $F_k$ (%)", labelpad=1.0)
    for axes, letter in ((left, "a"), (right, "b")):
        panel_letter(axes, letter)
    return figure
