"""Where does each approach stay within 1 % of the true coefficient, over ten million oscillators?

Each oscillator is one draw of ω/ω_n, F_k/(kY), ζ, K_z/k and the ratio of two levels of excitation, evenly in their
logarithms over RANGES. F_k and c are identified from the exact features of the two levels.

    cd trials && python -m oscillators [--count N] [--output DIR]

It writes `oscillators.json` and `oscillators.svg`, which the article shows, into the folder of its supplement.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from dampbalance import steady_orbits
from dampbalance.arrays import Array
from dampbalance.balance import APPROACHES
from dampbalance.features import of_orbits
from dampbalance.figures.grid import clear_labels, grid, logarithmic_ticks
from dampbalance.figures.looks import in_maths, label_of
from dampbalance.figures.style import DOUBLE_COLUMN, PAPER_COLOUR, note, place, save_svg, styled
from dampbalance.project.files import write_json
from dampbalance.project.progress import followed
from dampbalance.project.wording import percent
from dampbalance.solver import solve
from dampbalance.studies.parameters import parameter
from dampbalance.studies.shown.maps import SIZES
from dampbalance.studies.study_file import Range, Sampled

RANGES = {
    "omega_over_omega_n": Range(0.5, 3.0, "log"),
    "F_k_over_kY": Range(0.003, 0.3, "log"),  # Y of the lower level
    "zeta": Range(0.01, 1.0, "log"),
    "K_z_over_k": Range(10.0, 1000.0, "log"),
    "level_ratio": Range(1.2, 3.0, "log"),  # of the paper's levels, 12/10 to 12/4
}
WITHIN = 0.01
PHASES = ("reversal", "fundamental")  # of the paper, and the one that suits harmonic motion best
BINS = 60, 48  # along ω/ω_n and F_k/(kY): about 3,500 of ten million oscillators each
_BLOCK = 131_072  # oscillators in memory at a time, some 100 MB
SUPPLEMENT = Path(__file__).parents[1] / "paper/article/supplement"
"""Where the article takes the numbers and the figure from."""

_ALT = (
    "Maps of the drive frequency and the friction force: the share of oscillators for which each approach finds the "
    "friction force, and the damping, within 1 %."
)

Key = tuple[str, str, str]
"""Coefficient, approach, and phase, "" where the approach takes none."""


def errors_of(sampled: Sampled, numbers: Any) -> tuple[dict[str, Any], dict[Key, Array]]:
    """Return the parameters of some oscillators of a sample, and the sizes of their relative errors."""
    of = sampled.at(numbers)
    omega, c, F_k = of["omega_over_omega_n"], 2.0 * of["zeta"], of["F_k_over_kY"]  # m = k = Y = 1
    Y = np.stack([np.ones_like(omega), of["level_ratio"]])
    orbits = steady_orbits(m=1.0, k=1.0, c=c, K_z=of["K_z_over_k"], F_k=F_k, omega=omega, Y=Y)
    features, errors = of_orbits(orbits, Y, omega), {}
    for approach in APPROACHES.values():
        for phase in PHASES if approach.takes_phase else ("",):
            seen = features.with_phase(phase) if phase else features
            values = solve(approach(seen, np.ones_like(omega))).values
            for symbol, true in (("F_k", F_k), ("c", c)):
                errors[symbol, approach.name, phase] = np.abs(values[symbol] / true - 1.0)
    return of, errors


def counted(count: int, seed: int = 2010) -> tuple[dict[str, Any], dict[Key, Array]]:
    """Return the numbers of the article, in %, and the share of each bin that is within 1 %, rows along F_k/(kY).

    An oscillator for which an approach has no answer counts as one that is not within 1 %.
    """
    sampled = Sampled(RANGES, "random", count, seed)
    places, size = dict(zip(list(RANGES)[:2], BINS, strict=True)), BINS[0] * BINS[1]
    cases, good, worst = Counter[str](), Counter[tuple[str, Key]](), dict[Key, float]()
    all_of, shares = np.zeros(size), dict[Key, Any]()
    for first in followed(range(0, count, _BLOCK), count / _BLOCK, "blocks"):
        of, errors = errors_of(sampled, np.arange(first, min(first + _BLOCK, count)))
        i, j = (np.searchsorted(_edges(name)[1:-1], of[name], "right") for name in places)
        at, ratio = j * BINS[0] + i, of["omega_over_omega_n"]
        all_of += np.bincount(at, minlength=size)
        bands = {
            "all": ratio > 0.0,
            "resonance": np.abs(ratio - 1.0) <= 0.05,
            "above": ratio >= 1.5,
        }
        cases.update({band: int(mask.sum()) for band, mask in bands.items()})
        for key, error in errors.items():
            within = error <= WITHIN  # False for NaN
            shares[key] = shares.get(key, 0.0) + np.bincount(at[within], minlength=size)
            worst[key] = max(worst.get(key, 0.0), float(np.nanmax(error)))
            good.update({(band, key): int(within[mask].sum()) for band, mask in bands.items()})
    numbers: dict[str, Any] = {
        "count": count,
        "seed": seed,
        "ranges": _by_name(
            {
                (name, end): getattr(of, end)
                for name, of in RANGES.items()
                for end in ("low", "high")
            }
        ),
        "largest": _by_name({key: 100.0 * of for key, of in worst.items()}),
    }
    for band, of_band in cases.items():
        numbers[band] = _by_name({key: 100.0 * good[band, key] / of_band for key in worst})
    all_of[all_of == 0.0] = np.nan  # no share where no oscillator fell
    return numbers, {key: (of / all_of).reshape(BINS[::-1]) for key, of in shares.items()}


def _edges(name: str) -> Array:
    return RANGES[name].at(np.linspace(0.0, 1.0, BINS[list(RANGES).index(name)] + 1))


def _by_name(values: Mapping[tuple[str, ...], float]) -> dict[str, float]:
    """Return the values by the parts of their keys, as F_k.X_s.reversal and F_k.fourier."""
    return {".".join(filter(None, key)): value for key, value in values.items()}


@styled()
def figure(numbers: Mapping[str, Any], shares: Mapping[Key, Array]) -> Figure:
    """Draw the share of the oscillators in each bin that are within 1 %, with lines at 50 and 90 %.

    Rows: coefficients with each phase. Columns: approaches that take a phase; the others are within 1 % everywhere.
    """
    rows = [(symbol, phase) for symbol in ("F_k", "c") for phase in PHASES]
    names = [name for name, approach in APPROACHES.items() if approach.takes_phase]
    x, y = (_edges(name) for name in list(RANGES)[:2])
    panels, lowest = grid(len(rows), len(names), right=17.0, most=34.0), []
    for column, name in enumerate(names):
        for row, (symbol, phase) in enumerate(rows):
            axes, share = panels.panel(row, column), 100.0 * shares[symbol, name, phase]
            axes.pcolormesh(x, y, share, cmap=SIZES, vmin=0, vmax=100, rasterized=True, linewidth=0)
            middle = np.sqrt(x[1:] * x[:-1]), np.sqrt(y[1:] * y[:-1])
            axes.contour(*middle, share, [50.0, 90.0], colors=PAPER_COLOUR, linewidths=[0.5, 1.2])
            logarithmic_ticks(axes, "x", x[0], x[-1])
            logarithmic_ticks(axes, "y", y[0], y[-1])
            axes.set(xlim=x[[0, -1]], ylim=y[[0, -1]])
            axes.tick_params(labelbottom=row == len(rows) - 1, labelleft=column == 0)
            percent_of = numbers["all"][f"{symbol}.{name}.{phase}"]
            text = f"${symbol}$, {phase}: {percent(percent_of / 100.0)}"
            note(axes, text, (0.0, 1.0), (0.0, 2.0), size=7.5, xycoords="axes fraction")
            if row == 0:
                axes.set_title(in_maths(label_of(name)), pad=14.0)
            if column == 0:
                panels.name_row(axes, parameter("F_k_over_kY").label)
        lowest.append(axes)
    clear_labels(lowest)
    panels.text_below(parameter("omega_over_omega_n").label)
    panels.text_below(
        "Above each panel: share of all oscillators within 1 %. Lines: 50 %, and 90 % (thick).",
        level=4.0,
    )
    bar = place(panels.figure, DOUBLE_COLUMN - 15.0, panels.bottom, 3.0, panels.tall(len(rows)))
    panels.figure.colorbar(axes.collections[0], cax=bar).set_label("share within 1 % (%)")
    return panels.figure


def main(arguments: list[str] | None = None) -> None:
    """Count the oscillators, and write the numbers and the figure of the article."""
    parser = argparse.ArgumentParser(prog="oscillators", description=__doc__)
    parser.add_argument("--count", type=int, default=10_000_000, help="oscillators (10⁷)")
    parser.add_argument("--output", type=Path, default=SUPPLEMENT)
    options = parser.parse_args(arguments)
    numbers, shares = counted(options.count)
    write_json(options.output / "oscillators.json", numbers)
    save_svg(figure(numbers, shares), options.output / "oscillators.svg", _ALT)


if __name__ == "__main__":
    main()
