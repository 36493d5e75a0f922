"""How the printed digits arose, for the page: the paper's numbers beside what each cause would make of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...balance import TERMS
from ...figures.looks import LOOKS, SCHEME_LOOKS, SPARE, Look
from ...figures.numerics import Evidence, deviation
from ...figures.series import decades
from ...model import Oscillator
from .charts import Axis, Chart, Spec, Table, Value, at_height, curve, dots, with_points
from .colours import variable
from .legend import Entry, line, mark
from .words import italic

PRINTED = variable("stick")  # the colour of what is printed
# What stands behind the print looks like backward Euler in every panel, the other candidate like explicit Euler.
_FOUND, _OTHER = LOOKS["X_s"], LOOKS["V_s"]
_PHASES = {"zero crossing": _OTHER, "fundamental": SPARE[0], "reversal": _FOUND}
_SIGNS = {"V_s": ("+", _FOUND), "V_s with minus": ("−", _OTHER)}


def digit_charts(
    evidence: Evidence, oscillator: Oscillator, step_s: float, t_s_unit_s: float
) -> list[Chart]:
    """The six panels of the article's figure of the digits, each with a legend of its own.

    Scheme, step, rounded coefficients, phase, slip time, sign. The arguments are those of `figures.numerics.numerics`.
    """
    return [
        _integrals(evidence),
        _steps(evidence, oscillator, step_s),
        _coefficients(evidence),
        _phases(evidence),
        _slip_times(evidence, step_s, t_s_unit_s),
        _signs(evidence),
    ]


@dataclass(frozen=True)
class _Panel:
    """What one panel shows, gathered: what it tells in words, columns of its table, layers, values, legend.

    The first layer must be a curve or marks: the zoom is bound to its fields.
    """

    remark: str
    columns: dict[str, Any] = field(default_factory=dict)
    layers: list[Spec] = field(default_factory=list)
    says: list[Value] = field(default_factory=list)
    legend: list[Entry] = field(default_factory=list)

    def add(self, value: Value, values: ArrayLike, layer: Spec, *entry: Entry) -> None:
        """A curve or a set of marks: the column that `value` tells, how it is drawn, and its entry."""
        self.columns[value.column] = np.asarray(values)
        self.layers.append(layer)
        self.says.append(value)
        self.legend.extend(entry)

    def add_curve(self, value: Value, values: ArrayLike, look: Look) -> None:
        """A curve with a mark at each value, named in the legend as where it is told."""
        colour, width = variable(look.series), look.page_width
        layer = with_points(curve(value.column, colour, width))
        self.add(value, values, layer, line(value.name, colour, width))

    def add_printed(self, value: Value, values: ArrayLike, shape: str = "circle") -> None:
        """What is printed, as marks on top."""
        look = Look(SPARE[0].colour, SPARE[0].marker, "stick", SPARE[0].light, SPARE[0].dark, shape)
        self.add(value, values, dots(value.column, PRINTED, shape), mark(value.name, look))

    def over_levels(self, name: str, title: str, y: str, e: Evidence) -> Chart:
        """The panel over the level of excitation."""
        Y = 1e3 * e.exact["Y_m"].to_numpy()
        shown = np.concatenate(list(self.columns.values()))
        table = Table(f"digits-{name}", {"Y": Y, **self.columns})
        x = Axis("Y", "base amplitude *Y* (mm)", limits=_around(Y))
        level = Value("Y", "base amplitude *Y*", "mm")
        words = f"{title[4:].capitalize()}: what is printed beside what may stand behind it."
        axis = Axis(next(iter(self.columns)), y, limits=_around(shown))
        return self._drawn(title, words, table, x, axis, level)

    def over_steps(self, title: str, y: str, steps: np.ndarray) -> Chart:
        """The panel over the step of the simulation."""
        span = (float(steps[0]) / 1.2, float(steps[-1]) * 1.2)
        limits = decades(list(self.columns.values()), 1e-13, 1e3, cut=0.02)
        table = Table("digits-step", {"h": steps, **self.columns})
        x = Axis("h", "step *h* (s)", "log", span)
        words = "Error of c by direct integration against the step, by scheme, and as printed."
        axis = Axis(next(iter(self.columns)), y, "log", limits)
        return self._drawn(title, words, table, x, axis, Value("h", "step *h*", "s"))

    def over_pairs(self, title: str, y: str, pairs: list[str]) -> Chart:
        """The panel over pairs of levels."""
        limits = decades(list(self.columns.values()), 1e-3, 1e4, cut=0.0)
        table = Table("digits-sign", {"at": [*range(len(pairs))], "pair": pairs, **self.columns})
        x = Axis("at", "pair of levels", limits=(-0.6, len(pairs) - 0.4), labels=pairs)
        words = "Distance of the pairs of Table 3 by V_s to print, with either sign under the root."
        axis = Axis(next(iter(self.columns)), y, "log", limits)
        return self._drawn(title, words, table, x, axis, Value("pair", "pair of levels"))

    def _drawn(self, title: str, words: str, table: Table, x: Axis, y: Axis, place: Value) -> Chart:
        return Chart(
            id=table.id,
            title=title,
            description=words,
            table=table,
            x=x,
            y=y,
            layers=tuple(self.layers),
            says=(place, *self.says),
            legend=tuple(self.legend),
            remark=self.remark,
        )


def _integrals(e: Evidence) -> Chart:
    """W and b: how far from exact, printed and by each scheme."""
    panel = _Panel(
        "Of the schemes tried, backward Euler alone meets the printed *W* and *b*: it damps by itself."
    )
    terms = {"W": "W_J", "b": "b_m2_per_s"}
    schemes = e.schemes[e.schemes["coefficients"] == "rounded"]
    for scheme, rows in schemes.groupby("scheme", sort=False):
        label, look = SCHEME_LOOKS[str(scheme)]
        colour, width = variable(look.series), look.page_width
        panel.legend.append(line(label, colour, width))
        for name, column in terms.items():
            value = Value(f"{name}_{scheme}".replace("-", "_"), f"*{name}*, {label}", "·10⁻⁴")
            layer = curve(value.column, colour, width, dashed=name == "b")
            panel.add(value, deviation(rows[column], e.exact[column]), layer)
    ink = variable("ink")
    panel.legend.extend([line("*W*", ink), line("*b*", ink, dash="6 4")])
    for (name, column), shape in zip(terms.items(), ("circle", "square"), strict=True):
        value = Value(f"{name}_printed", f"*{name}* printed", "·10⁻⁴")
        panel.add_printed(value, deviation(e.printed(f"table2.{name}."), e.exact[column]), shape)
    return panel.over_levels("scheme", "(a) the scheme", "deviation from exact (10⁻⁴)", e)


def _steps(e: Evidence, oscillator: Oscillator, step_s: float) -> Chart:
    """The error of c by direct integration against the step, with the printed c."""
    panel = _Panel(
        "Backward Euler adds nearly *m*ω²*h* to *c*. At the step of the rebuild this is the *c* that the paper prints."
    )
    error = (e.steps["c_N_s_per_m"] * e.steps["c_relative_error__direct__least_squares"]).abs()
    steps = np.unique(e.steps["step_s"])
    for scheme, rows in e.steps.groupby("scheme", sort=False):
        label, look = SCHEME_LOOKS[str(scheme)]
        of_step = dict(zip(rows["step_s"], error[rows.index], strict=True))
        value = Value(str(scheme).replace("-", "_"), label, "N s/m")
        errors = [of_step.get(step, np.nan) for step in steps]
        panel.add_curve(value, errors, look)
    printed = float(e.printed("text.c_direct_ls")[0]) - oscillator.c
    panel.layers.append(at_height(printed, PRINTED))
    at_step = np.where(np.isclose(steps, step_s), printed, np.nan)
    panel.add_printed(Value("printed", "printed *c*, at the step of the rebuild", "N s/m"), at_step)
    return panel.over_steps("(b) the step", "error of *c* (N s/m)", steps)


def _coefficients(e: Evidence) -> Chart:
    """What is left of the printed W beside the simulation, with rounded and with exact coefficients."""
    panel = _Panel(
        "The simulation meets the printed *W* more closely with its coefficients rounded, after division by *m*.",
        legend=[line("printed", PRINTED, dash="2 3")],
    )
    euler = e.schemes[e.schemes["scheme"] == "backward-euler"]
    for name, look in (("rounded", _FOUND), ("exact", _OTHER)):
        W = euler.loc[euler["coefficients"] == name, "W_J"].to_numpy()
        value = Value(name, f"{name} *c*/*m* and *k*/*m*", "·10⁻⁶")
        off = 1e6 * (e.printed("table2.W.") / W - 1.0)
        panel.add_curve(value, off, look)
    panel.layers.append(at_height(0.0, PRINTED))
    y = "*W* printed over rebuilt, less 1 (10⁻⁶)"
    return panel.over_levels("coefficients", "(c) the coefficients", y, e)


def _phases(e: Evidence) -> Chart:
    """The printed φ and the three phases it might be."""
    panel = _Panel(
        "The printed phi rises with the level, as the phase of the velocity reversal does. That of the zero crossing, "
        "which the paper’s text names, falls."
    )
    for words, look in _PHASES.items():
        phase = words.replace(" ", "_")
        panel.add_curve(Value(phase, words, "rad"), e.exact[f"phi_{phase}_rad"], look)
    panel.add_printed(Value("printed", "printed", "rad"), e.printed("table1.phi."))
    return panel.over_levels("phase", "(d) the phase", "phi (rad)", e)


def _slip_times(e: Evidence, step_s: float, unit_s: float) -> Chart:
    """The printed t_s, the exact one, and the whole sampling intervals inside it."""
    panel = _Panel(
        "The printed t_s are the whole sampling intervals that fit into the microstick phase."
    )
    panel.add_curve(Value("exact", "exact", "ms"), 1e3 * e.exact["t_s_s"], _OTHER)
    value, colour = (
        Value("whole", f"whole {1e3 * unit_s:g} ms inside", "ms"),
        variable(_FOUND.series),
    )
    mark = {"type": "tick", "orient": "horizontal", "color": colour, "size": 26, "thickness": 3}
    whole = curve(value.column, colour) | {"mark": mark | {"opacity": 1}}
    panel.add(value, 1e3 * e.slip_times(step_s, unit_s), whole, line(value.name, colour, 3.0))
    panel.add_printed(Value("printed", "printed", "ms"), 1e3 * e.printed("table1.t_s."))
    return panel.over_levels("slip-time", "(e) the slip time", "t_s (ms)", e)


def _signs(e: Evidence) -> Chart:
    """The pairs by V_s with either sign: how far from the printed number, in units of its last digit."""
    half = line("half a unit: the printed digits", PRINTED, dash="2 3")
    panel = _Panel(
        "Table 3 by V_s comes out with a plus under the root of Eq. (19), and misses by many units with the minus "
        "that the paper defines.",
        legend=[half],
    )
    pairs = e.estimates[(e.estimates["kind"] == "pair") & (e.estimates["phase"] == "common")]
    for name, (sign, look) in _SIGNS.items():
        rows = pairs[pairs["approach"] == name]
        for n, term in enumerate(TERMS.values()):
            printed = f"table3.V_s.{term.symbol}."
            if not e.printed(printed).size:
                continue
            words = f"{italic(term.symbol)}, {sign} under the root"
            value = Value(f"{term.symbol}_{look.series}".replace("-", "_"), words)
            layer = dots(value.column, variable(look.series), look.shape, filled=n == 0)
            off = (rows[term.column].to_numpy() - e.printed(printed)) / e.last_digit(printed)
            panel.add(value, np.abs(off), layer, mark(words, look, filled=n == 0))
    panel.layers.append(at_height(0.5, PRINTED))
    labels = [str(label).replace("-", "–") for label in pairs["pair"].drop_duplicates()]
    return panel.over_pairs("(f) the sign in Eq. (19)", "off by units of the last digit", labels)


def _around(values: np.ndarray) -> tuple[float, float]:
    """Limits a little wider than the values."""
    margin = 0.08 * float(np.ptp(values))
    return float(values.min()) - margin, float(values.max()) + margin
