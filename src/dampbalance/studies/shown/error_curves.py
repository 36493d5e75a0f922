"""The numbers of a study's curves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...arrays import Array, Integers
from ...balance import takes_phase
from ...figures.looks import SCHEME_LOOKS, in_maths, label_of
from ...figures.series import EXACT, SHARINGS, SignedScale, signed_scale
from ...model import Oscillator
from ...motion.fixed_step import SCHEMES
from ..axes import selected
from ..outputs import column_of, terms_of
from ..parameters import PARAMETERS, SI_COLUMNS, Parameter
from ..settings import Study
from .facts import worst_errors
from .logarithmic import is_logarithmic

FLOOR, CEILING = 1e-3, 1e3  # %: a smaller error is drawn on a linear axis, a larger one not at all
FEW = 24  # cases on a curve up to which each is marked
PHASES = {
    "reversal": "phase of the velocity reversal",
    "zero_crossing": "phase of the zero crossing",
    "fundamental": "phase of the fundamental",
}


@dataclass(frozen=True, slots=True)
class Panel:
    """The cases that one panel shows.

    axis : the parameter that is constant in the panel, or None.   value : its value with unit, or the phase in words.
    phase : the definition that all errors use; "" for any.   x : of the cases, ascending.
    """

    axis: Parameter | None
    value: str
    phase: str
    x: Array
    cases: Integers

    @property
    def few(self) -> bool:
        """Whether each case can be marked."""
        return len(self.x) <= FEW


@dataclass(frozen=True, slots=True)
class Curve:
    """The error in the cases of a panel, %, with its sign. sharing : "" for an approach without a phase."""

    approach: str
    sharing: str
    error: Array


@dataclass(frozen=True, slots=True)
class ErrorCurves:
    """Errors along the axis x.

    places : values of x, ascending.   curves : (symbol of the term, number of the panel) → those to draw.
    exact : approaches of which no curve is drawn, because all are exact → bound of their error, %.
    approaches, sharings : of all curves, drawn or not.
    """

    name: str
    places: Array
    panels: tuple[Panel, ...]
    symbols: tuple[str, ...]
    curves: Mapping[tuple[str, int], Sequence[Curve]]
    exact: Mapping[str, float]
    approaches: tuple[str, ...]
    sharings: tuple[str, ...]

    @property
    def is_logarithmic(self) -> bool:
        """Whether the values of x ask for a logarithmic axis."""
        return not PARAMETERS[self.name].whole and is_logarithmic(self.places)

    def scale(self, symbol: str) -> SignedScale:
        """The axis of the errors of a term, the same in all panels, %."""
        curves = [curve for (of, _), some in self.curves.items() if of == symbol for curve in some]
        return signed_scale([curve.error for curve in curves], FLOOR, CEILING, cut=0.02)


class ErrorOfSteps(NamedTuple):
    """The error of c, N s/m, by direct integration against the step of fixed-step schemes.

    errors : scheme → (steps, s, ascending; errors).   oscillator, omega : of the line m ω² h.
    """

    errors: dict[str, tuple[Array, Array]]
    oscillator: Oscillator
    omega: float

    @property
    def steps(self) -> Array:
        """All steps, ascending, s."""
        return np.unique(np.concatenate([steps for steps, _ in self.errors.values()]))

    def line(self, steps: Array) -> Array:
        """The damping m ω² h, N s/m, that backward Euler adds to c and explicit Euler takes from it."""
        euler = SCHEMES["backward-euler"]
        return np.array([abs(euler.balance_bias(self.oscillator, self.omega, h)) for h in steps])


def unit_of(name: str) -> str:
    """The unit of a parameter, "" for a pure number and for a word."""
    return PARAMETERS[name].unit.removeprefix("1")


def symbol_of(name: str) -> str:
    """The symbol of a parameter, in TeX, or its meaning where it has none."""
    symbol = PARAMETERS[name].symbol
    return f"${symbol}$" if symbol else PARAMETERS[name].meaning


def axis_label(name: str) -> str:
    """Symbol and unit of a parameter."""
    unit = unit_of(name)
    return f"{symbol_of(name)} ({unit})" if unit and PARAMETERS[name].symbol else symbol_of(name)


def bounded_label(approach: str, bound: float) -> str:
    """The label of an exact approach with the power of ten that its errors stay below.   bound : of them, %."""
    power = math.ceil(math.log10(max(bound, 1e-14)))
    return rf"{in_maths(label_of(approach))} (below $10^{{{power}}}$ %)"


def with_unit(name: str, value: float | str, digits: int = 4) -> str:
    """A value of a parameter with its unit, e.g. 4.92 Hz."""
    shown = value if isinstance(value, str) else f"{value:.{digits}g}"
    return f"{shown} {unit_of(name)}".rstrip()


def error_curves(study: Study, cases: str | Path) -> ErrorCurves:
    """Relative error of each coefficient, %, along the axis x of the study, by panel and approach.

    Panels: phase definitions, or the values of another axis. Curves: the approaches, with φ and t_s of each level or
    common to the levels. Where a curve stands for several fits (all pairs) it is the worst.
    """
    fits = study.fits_of(study.figure)
    sharings = tuple(name for name in SHARINGS if any(fit.sharing == name for fit in fits))
    approaches = tuple(dict.fromkeys(fit.approach for fit in fits))
    panels = tuple(_panels(study, cases))
    identified = {fit.approach: fit.identified for fit in fits}
    symbols = tuple(s for s in terms_of(cases) if any(s in of for of in identified.values()))
    curves: dict[tuple[str, int], list[Curve]] = {}
    exact: dict[str, float] = {}
    for symbol in symbols:
        for number, panel in enumerate(panels):
            drawn = curves[symbol, number] = []
            for approach in approaches:
                if symbol not in identified[approach]:
                    continue
                for sharing in sharings if takes_phase(approach) else ("",):
                    which = {"of": symbol, "approach": approach, "sharing": sharing}
                    which |= {"phase": panel.phase} if panel.phase else {}
                    error = worst_errors(study, cases, {**study.figure, **which})
                    curve = Curve(approach, sharing, 100.0 * error[panel.cases])
                    worst = float(np.nanmax(np.abs(curve.error), initial=0.0))
                    if worst < EXACT:
                        exact[approach] = max(worst, exact.get(approach, 0.0))
                    else:
                        drawn.append(curve)
    somewhere = {curve.approach for drawn in curves.values() for curve in drawn}
    exact = {key: bound for key, bound in exact.items() if key not in somewhere}
    name = study.figure["x"]
    places = np.unique(column_of(cases, name))
    return ErrorCurves(name, places, panels, symbols, curves, exact, approaches, sharings)


def error_of_steps(study: Study, cases: str | Path) -> ErrorOfSteps:
    """The error of c by direct integration against the step, for each scheme of the study."""
    h, scheme = column_of(cases, "step_s"), column_of(cases, "scheme")
    relative = worst_errors(study, cases, {"of": "c", "approach": "direct"})
    m, c, k, omega = (column_of(cases, SI_COLUMNS[name][0]) for name in ("m", "c", "k", "omega"))
    errors = {}
    for name in SCHEME_LOOKS:
        those = np.flatnonzero(scheme == name)
        those = those[np.argsort(h[those])]
        if those.size:
            errors[name] = h[those], (relative * c)[those]
    return ErrorOfSteps(errors, Oscillator(m=m[0], c=c[0], k=k[0], K_z=1.0, F_k=0.0), omega[0])


def _panels(study: Study, cases: str | Path) -> Iterator[Panel]:
    """The panels that the study's figure asks for."""
    at = study.figure.get("at", {})
    x = column_of(cases, study.figure["x"])
    order = np.argsort(x, kind="stable")
    here = {name: column_of(cases, name) for name in ("case", *at)}
    order = order[selected(here, {"at": at})[order]]
    by, phase = study.figure.get("panels"), str(study.figure.get("phase", ""))
    if by is None:
        yield Panel(None, "", phase, x[order], order)
    elif by == "phase":
        for name in dict.fromkeys(fit.phase for fit in study.fits if fit.phase):
            yield Panel(None, PHASES[name], name, x[order], order)
    else:
        values = column_of(cases, by)
        for value in dict.fromkeys(values.tolist()):
            those = order[values[order] == value]
            yield Panel(PARAMETERS[by], with_unit(by, value), phase, x[those], those)
