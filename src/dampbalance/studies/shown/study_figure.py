"""The figure of a study: errors along one axis, errors over many runs, or what `maps` draws."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter

from ...arrays import Array, Integers
from ...balance import takes_phase
from ...figures.grid import ROOM, clear_labels, decades_axis, grid, logarithmic_ticks
from ...figures.looks import HARMONIC_LOOK, Look, bounded_label, in_maths, label_of, look_of
from ...figures.series import COMMON, EXACT, INDIVIDUAL, SHARINGS, decades, is_logarithmic
from ...figures.style import DASHED, DOTTED, FAINT, PAPER_COLOUR, note, omega_of, styled
from ...project.wording import in_figure, listed
from ...solver import NORMAL_95
from ..case_files import CasesLike, column_of, terms_of
from ..parameters import parameter
from ..study_file import YARDSTICKS, Estimator, Study, selected
from .maps import error_map
from .shown_as import shown_as
from .statistics import spread_of, worst_errors

FEW = 24  # cases on a curve up to which each is marked
MARKS = 6  # on a curve of more
BRIEF = 0.08  # of a curve
# of a curve, points; of one on which another lies, so that both are seen
_WIDTH, _BENEATH = 0.9, 2.6
_APART = 0.05  # decades: less than half a millimetre in a panel of five, so that curves lie upon each other
HARMONIC = "harmonic"  # the curve that stands for all approaches that take a phase
PHASE_WORDS = {
    "reversal": "phase of the velocity reversal",
    "zero_crossing": "phase of the zero crossing",
    "fundamental": "phase of the fundamental",
}
_COVERAGE, _GAP = 24.0, 3.0  # heights in a row of panels of many runs, mm
_CONFIDENCE = 95.0  # %
_TRAITS = ("phase", "sharing", "contact", "weights", "kind")


def study_figure(study: Study, cases: CasesLike) -> Figure:
    """Draw the figure that the study's file asks for, from its table of cases."""
    return FIGURES[study.figure["kind"]](study, cases)


def alternative_text(study: Study) -> str:
    """Return what the figure shows, in one sentence."""
    figure = study.figure
    symbols = dict.fromkeys(s for fit in study.fits_of(figure) for s in fit.identified)
    by = f" by {label_of(figure['approach'])}" if "approach" in figure else ""
    identified = f"the identified {listed([*symbols])}{by}"
    x, y = (parameter(figure.get(axis, figure["x"])).meaning for axis in ("x", "y"))
    shown = {
        "curves": f"size of the error of {identified} against {x}, with filled marks where it is too large",
        "map": f"error of {identified} over {x} and {y}, with lines at powers of ten",
        "scatter": f"size that 95 % of the errors of {identified} do not exceed, and coverage, against {x}",
    }
    return f"{study.title}: {shown[figure['kind']]}."


# --- errors along one axis ---------------------------------------------------------------------------


@styled()
def error_curves(study: Study, cases: CasesLike) -> Figure:
    """Draw the size of the relative error, %, along the axis x; a row of panels per term, a curve per approach.

    Columns of panels: phase definitions, or the values of another axis. Solid: φ and t_s common to the levels, where
    it has such curves; dashed: of each level. Filled marks: too large; open marks: too small. Where the harmonic
    approaches agree, one curve stands for them all. Where a curve stands for several fits (all pairs) it is the worst.
    A curve on which another lies is wider, so that both are seen. An approach of which every curve is exact is named
    below the panels, with the bound of its error, and not drawn.
    """
    figure, of_x = study.figure, shown_as(study, study.figure["x"])
    x = of_x.factor * column_of(cases, figure["x"])
    fits, places = study.fits_of(figure), np.unique(x)
    identified = {fit.approach: fit.identified for fit in fits}
    symbols = [s for s in terms_of(cases) if any(s in of for of in identified.values())]
    harmonic = [name for name in identified if name not in YARDSTICKS and takes_phase(name)]
    sharings = [name for name in SHARINGS if any(fit.sharing == name for fit in fits)]
    looks = {HARMONIC: HARMONIC_LOOK} | {approach: look_of(approach) for approach in identified}
    shown = list(_panels(study, cases))
    panels = grid(len(symbols), len(shown))
    exact: dict[str, float] = {}
    marks: dict[
        str, set[bool]
    ] = {}  # of each curve drawn: whether it has filled ones, and open ones
    for row, symbol in enumerate(symbols):
        here, sizes = [], []
        for column, (title, phase, those) in enumerate(shown):
            here.append(axes := panels.panel(row, column))
            curves: dict[str, dict[str, Array]] = {}
            for approach in (name for name in identified if symbol in identified[name]):
                for sharing in sharings if approach in harmonic else [""]:
                    which = {"of": symbol, "approach": approach, "sharing": sharing}
                    which |= {"phase": phase} if phase else {}
                    error = 100.0 * worst_errors(study, cases, {**figure, **which})[those]
                    largest = float(np.nanmax(np.abs(error), initial=0.0))
                    if largest < EXACT:
                        exact[approach] = max(largest, exact.get(approach, 0.0))
                        continue
                    curves.setdefault(sharing, {})[approach] = error
                    sizes.append(np.abs(error))
            drawn = [
                (name, sharing == INDIVIDUAL and len(sharings) > 1, error)
                for sharing, errors in curves.items()
                for name, error in _with_common_curve(errors, harmonic).items()
            ]
            for place, (name, dashed, error) in enumerate(drawn):
                offset = ([*looks].index(name) + 0.3 + 0.4 * dashed) / len(looks)
                hidden = any(_agree(error, later) for _, _, later in drawn[place + 1 :])
                width = _BENEATH if hidden else _WIDTH
                fills = _draw_size(axes, x[those], error, looks[name], dashed, offset, width)
                marks.setdefault(name, set()).update(fills)
            if row == 0 and title:
                axes.set_title(title, pad=12.0 if figure.get("marks") else 4.0)
        # %: a larger error is not drawn
        low, high = decades(sizes, EXACT, 1e3, cut=0.02)
        for column, axes in enumerate(here):
            _x_axis(axes, figure["x"], places, last=column == len(shown) - 1)
            decades_axis(axes, (low, ROOM * high))
            axes.tick_params(labelbottom=row == len(symbols) - 1, labelleft=column == 0)
            _marks(axes, study, of_x.factor, label=row == 0)
        panels.name_row(here[0], f"error of ${symbol}$ (%)")
    clear_labels(here)
    bounds = [
        bounded_label(name, bound)
        for name, bound in exact.items()
        if name not in marks and not (name in harmonic and HARMONIC in marks)
    ]
    undrawn = f"; exact, and not drawn: {listed(bounds)}" if bounds else ""
    panels.text_below(of_x.label + undrawn)
    # the approaches by colour; φ and t_s by the line; the sign
    label_of_common = ", ".join(in_maths(label_of(name)) for name in harmonic)
    shown_looks = {name: look for name, look in looks.items() if name in marks}
    entries: dict[str, Line2D | tuple[Line2D, ...]] = {}
    for name, look in shown_looks.items():
        label = label_of_common if name == HARMONIC else in_maths(label_of(name))
        entries[label] = Line2D([], [], color=look.colour, lw=1.2, marker=look.marker, ms=3.6)
    for name, style in ((COMMON, "-"), (INDIVIDUAL, DASHED)) if len(sharings) > 1 else ():
        entries[SHARINGS[name]] = Line2D([], [], color=FAINT, lw=0.9, ls=style)
    for label, filled in (("too large", True), ("too small", False)):
        of_sign = [look for name, look in shown_looks.items() if filled in marks[name]]
        if of_sign:
            entries[label] = tuple(Line2D([], [], **_mark(look, filled)) for look in of_sign)
    panels.legend_below(
        [*entries.values()],
        labels=[*entries],
        handler_map={tuple: HandlerTuple(ndivide=None, pad=0.2)},
        columnspacing=1.2,
        handlelength=1.8,
        handletextpad=0.5,
    )
    return panels.figure


def _with_common_curve(curves: Mapping[str, Array], harmonic: Sequence[str]) -> dict[str, Array]:
    """Replace the harmonic curves by one, their median, where they have the same sign and sizes that agree.

    A stretch shorter than BRIEF where they do not, as around a change of sign, is not shown. The curves of single
    approaches reach to the first place where they agree, so that no gap remains.
    """
    from scipy.ndimage import binary_closing  # slow to import

    names = [name for name in curves if name in harmonic]
    if len(names) < 2:
        return dict(curves)
    errors = np.array([curves[name] for name in names])
    spread = np.ptp(np.log10(np.maximum(np.abs(errors), EXACT)), axis=0)
    alike = (spread < _APART) & (np.ptp(np.sign(errors), axis=0) == 0.0)
    brief = 1 + 2 * int(0.5 * BRIEF * alike.size)
    alike = binary_closing(np.pad(alike, brief, mode="edge"), np.ones(brief, bool))[brief:-brief]
    alike &= np.isfinite(errors).all(axis=0)
    padded = np.pad(alike | np.isnan(errors).all(axis=0), 1, constant_values=True)
    replaced = padded[:-2] & padded[1:-1] & padded[2:]
    common = np.where(alike, np.median(errors, axis=0), np.nan)
    separate = {name: np.where(replaced & (name in names), np.nan, e) for name, e in curves.items()}
    return {
        name: error
        for name, error in {HARMONIC: common, **separate}.items()
        if np.isfinite(error).any()
    }


def _agree(error: Array, other: Array) -> bool:
    """Return whether two curves would lie upon each other over half of their length."""
    with np.errstate(divide="ignore", invalid="ignore"):
        alike = np.abs(np.log10(np.abs(error / other))) < _APART
    return bool(alike.sum() > 0.5 * np.isfinite(error).sum())


def _draw_size(
    axes: Axes, x: Array, error: Array, look: Look, dashed: bool, offset: float, width: float
) -> set[bool]:
    """Draw the size of an error as a curve with marks, filled where it is positive and open where it is negative, and
    return which of the two there are: True for filled ones, False for open ones.

    Few cases are marked each; of more, marks are spread over each stretch of one sign.   offset : of the marks from
    those of other curves, as a share of their distance.   width : of the curve, points.
    """
    axes.plot(x, np.abs(error), color=look.colour, lw=width, ls=DASHED if dashed else "-")
    fills = set()
    known = np.flatnonzero(np.isfinite(error))
    ends = (np.diff(known) > 1) | (np.diff(np.sign(error[known])) != 0.0)
    step = 1 if len(x) <= FEW else len(x) // MARKS
    for stretch in np.split(known, np.flatnonzero(ends) + 1):
        marked = stretch[int(offset * step) :: step]
        if not marked.size and stretch.size > step // 4:
            marked = stretch[[stretch.size // 2]]
        if marked.size:
            fills.add(filled := bool(error[stretch[0]] > 0.0))
            axes.plot(x[marked], np.abs(error[marked]), **_mark(look, filled))
    return fills


def _mark(look: Look, filled: bool) -> dict[str, Any]:
    """Return how the marks of an approach are drawn."""
    fill = look.colour if filled else PAPER_COLOUR
    mark = {"marker": look.marker, "ms": 3.6, "mew": 0.7, "mfc": fill, "ls": ""}
    return mark | {"color": look.colour}


def _panels(study: Study, cases: CasesLike) -> Iterator[tuple[str, str, Integers]]:
    """Yield the panels that the figure asks for: title, phase of all its errors ("" for any), and cases by ascending
    x."""
    at, by = study.figure.get("at", {}), study.figure.get("panels")
    order = np.argsort(column_of(cases, study.figure["x"]), kind="stable")
    here = {name: column_of(cases, name) for name in ("case", *at)}
    order = order[selected(here, {"at": at})[order]]
    phase = str(study.figure.get("phase", ""))
    if by is None:
        yield "", phase, order
    elif by == "phase":
        for name in dict.fromkeys(fit.phase for fit in study.fits if fit.phase):
            yield PHASE_WORDS[name], name, order
    else:
        values, of = column_of(cases, by), shown_as(study, by)
        for value in dict.fromkeys(values.tolist()):
            yield of.titled(value), phase, order[values[order] == value]


def _x_axis(axes: Axes, name: str, places: Array, last: bool) -> None:
    (low, high), few = places[[0, -1]], len(places) <= FEW  # marks at the ends are shown whole
    if parameter(name).whole and few:
        axes.set_xticks(places)
        axes.minorticks_off()
        low, high = low - 0.4, high + 0.4
    elif not parameter(name).whole and is_logarithmic(places):
        logarithmic_ticks(axes, "x", low, high, ends=last)
        room = (high / low) ** 0.03 if few else 1.0
        low, high = low / room, high * room
    axes.set_xlim(low, high)


def _marks(axes: Axes, study: Study, factor: float, label: bool) -> None:
    """Mark the places on x that the study's figure names, above the frame.   factor : of values on x."""
    low, high = axes.get_xlim()
    marks = {name: factor * value for name, value in study.figure.get("marks", {}).items()}
    for name, value in ((name, value) for name, value in marks.items() if low <= value <= high):
        axes.axvline(value, color=FAINT, lw=0.6, ls=DOTTED, zorder=0)
        if label:
            text = f"${omega}$" if (omega := omega_of(name)) else in_figure(name)
            at = ("data", "axes fraction")
            above: dict[str, Any] = {"size": 7.5, "color": FAINT, "xycoords": at}
            note(axes, text, (value, 1.0), (0.0, 1.5), "center", **above)


# --- errors over many runs ---------------------------------------------------------------------------


@styled()
def errors_of_runs(study: Study, cases: CasesLike) -> Figure:
    """Draw, over the runs along the axis x, the size that 95 % of the errors do not exceed, %, and below it, where the
    study has intervals, the share of the 95 % intervals that hold the true value, %.

    A row of panels per term, a column per value of another axis, a line per fit. Bars: the uncertainty
    from the number of runs, 1.96 standard errors of the size, and the 95 % interval of the coverage.
    """
    name = study.figure["x"]
    of_x = shown_as(study, name)
    lines, intervals = _lines(study), "intervals" in study.columns
    along, shown = column_of(cases, name), list(_panels(study, cases))
    symbols, low = terms_of(cases), _COVERAGE + _GAP if intervals else 0.0
    panels = grid(len(symbols), len(shown), height=low + 40.0)
    for row, symbol in enumerate(symbols):
        drawn = []
        for column, (title, _, those) in enumerate(shown):
            places, first = np.unique(along[those], return_index=True)
            x, runs = of_x.factor * places, np.split(those, first[1:])
            errors = panels.panel(row, column, low)
            below = [panels.panel(row, column, 0.0, _COVERAGE)] if intervals else []
            for axes, what in zip([errors, *below], ("errors", "coverage"), strict=False):
                axes.set_label(f"{symbol} {title} {what}")
                _axis_of_runs(axes, x)
                axes.tick_params(labelbottom=False, labelleft=column == 0)
            axes.tick_params(labelbottom=row == len(symbols) - 1)
            styles = _line_styles(lines, _between(x))
            for (label, fit), (shift, style) in zip(lines.items(), styles, strict=True):
                of = pd.DataFrame([spread_of(study, cases, symbol, fit, rows) for rows in runs])
                style |= {"label": label}
                size = 100.0 * of["p95"].to_numpy()
                reach = np.nan_to_num(100.0 * NORMAL_95 * of["p95_error"].to_numpy())
                bars = [np.minimum(reach, 0.9 * size), reach]  # of a logarithmic axis
                errors.errorbar(shift * x, np.where(size > 0.0, size, np.nan), yerr=bars, **style)
                for axes in below:
                    share = 100.0 * of["coverage"].to_numpy()
                    ends = 100.0 * of[["coverage_low", "coverage_high"]].to_numpy().T
                    axes.axhline(_CONFIDENCE, color=FAINT, lw=0.5, zorder=0)
                    axes.set_ylim(-6.0, 106.0)
                    axes.set_yticks([0.0, 50.0, _CONFIDENCE])
                    # without lines, which would cross each other
                    missed = share == 0.0
                    reach = np.where(missed, np.nan, np.abs(share - ends))
                    marked = np.flatnonzero(~missed).tolist()
                    axes.errorbar(
                        shift * x, share, yerr=reach, **style | {"ls": "", "markevery": marked}
                    )
                    # at zero only a short line, so that marks do not hide each other
                    tick: dict[str, Any] = {"marker": "|", "ls": "", "ms": 4.0}
                    axes.plot(shift * x[missed], share[missed], color=style["color"], **tick)
            drawn.append(errors)
            if column == 0:
                panels.name_row(errors, f"95 % of errors of ${symbol}$ below (%)")
                for axes in below:
                    panels.name_row(axes, "coverage (%)")
            if row == 0 and title:
                errors.set_title(title, pad=4.0)
        sizes = [np.asarray(line.get_ydata(), float) for axes in drawn for line in axes.lines]
        for axes in drawn:
            decades_axis(axes, decades(sizes))
    panels.text_below(of_x.label)
    handles = []
    for label, (_, style) in zip(lines, _line_styles(lines), strict=True):
        del style["elinewidth"]
        handles.append(Line2D([], [], label=label, **style))
    panels.legend_below(handles, columnspacing=1.2, handlelength=2.4, handletextpad=0.5)
    return panels.figure


def _lines(study: Study) -> dict[str, Estimator]:
    """Return the fits to draw, by the label in the legend: the one given, or the approach and how it differs from
    others."""
    fits = study.fits_of(study.figure)
    if "lines" in study.figure:
        labels = [in_maths(in_figure(label)) for label in study.figure["lines"]]
        return dict(zip(labels, fits, strict=True))
    differing = [key for key in _TRAITS if len({getattr(fit, key) for fit in fits} - {""}) > 1]
    named_fits = {}
    for fit in fits:
        traits = [getattr(fit, key).replace("_", " ") for key in differing]
        named_fits[", ".join([in_maths(label_of(fit.approach)), *filter(None, traits)])] = fit
    return named_fits


def _line_styles(
    lines: Mapping[str, Estimator], between: float = math.inf
) -> Iterator[tuple[float, dict[str, Any]]]:
    """Yield the ratio by which each line is moved along x, and its style. The lines of one approach have its colour:
    the first has filled marks, the second open ones, the third crosses.   between : least ratio of neighbouring
    places."""
    looks: list[dict[str, Any]] = [
        {"ls": "-"},
        {"ls": DASHED, "mfc": "white"},
        {"ls": DOTTED, "marker": "x"},
    ]
    # ratio by which neighbouring lines are moved apart along x, so that their bars do not overlap
    apart = min(1.13, between ** (0.7 / len(lines)))
    seen: list[str] = []
    for index, fit in enumerate(lines.values()):
        look = look_of(fit.approach)
        style: dict[str, Any] = {"color": look.colour, "marker": look.marker, "ms": 3.4, "mew": 0.7}
        style |= {"lw": 0.6, "elinewidth": 0.7} | looks[min(seen.count(fit.approach), 2)]
        seen.append(fit.approach)
        yield apart ** (index - 0.5 * (len(lines) - 1)), style


def _axis_of_runs(axes: Axes, places: Array) -> None:
    """Make a logarithmic axis with a tick at each place."""
    axes.set_xscale("log")
    axes.set_xticks(places, [f"{place:g}" for place in places])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(axis="x", which="minor", bottom=False, top=False)
    margin = min(1.8, _between(places) ** 0.6)
    axes.set_xlim(places.min() / margin, places.max() * margin)


def _between(places: Array) -> float:
    """Return the least ratio of neighbouring places."""
    ordered = np.unique(places)
    return float(np.min(ordered[1:] / ordered[:-1], initial=10.0))


FIGURES: Mapping[str, Callable[[Study, CasesLike], Figure]] = {
    "curves": error_curves,
    "map": error_map,
    "scatter": errors_of_runs,
}
"""Functions that draw each kind of figure that a study's file can ask for."""
