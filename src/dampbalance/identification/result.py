"""The result of an identification of any kind of records: numbers, findings, and the data and fits behind them.

Screen, document, tables, report, pictures and files are functions of a result, each in a module.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NamedTuple, Protocol, TypeVar

from ..findings.finding import Finding, grouped
from ..findings.words import sentence, unit_of
from ..project.wording import sentence as as_sentence
from ..records.coordinate import TRANSLATION, Coordinate
from ..records.record import Record
from ..signals.log_decrement import SwingDamping
from . import screen as shown
from .answer import CHECKS, NONE, REFERENCE, USABLE, Answer, Interval, Verdict, doubted
from .document import document, save
from .law_comparison import LawComparison
from .level import Column, Level, damping_ratio
from .sensitivities import FAULTS, Fault, effects_of
from .weighing import Weighed

if TYPE_CHECKING:
    from collections.abc import Callable

    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .answer import ParameterEstimate


class Picture(NamedTuple):
    """A picture of a result: the function that draws it, and its arguments except the coordinate."""

    draw: Callable[..., Figure]
    of: tuple[Any, ...]

    def drawn(self, coordinate: Coordinate) -> Figure:
        """Return the picture on a page of its own."""
        return self.draw(*self.of, coordinate)


class Basis(Protocol):
    """The data and fits behind the answers to one kind of records, and everything that differs between kinds."""

    kind: ClassVar[str]
    """Kind of records, as `identify` takes it."""

    mass_tests: ClassVar[bool]
    """Whether a stated mass is compared with that of the fit, which tests stiffness and gains, or held."""

    columns: ClassVar[Mapping[str, Column]]
    """Columns of the table of quantities measured at each level without a model, by the keys of the level's document;
    screen and report begin with that table, grouped by the first column. Empty for kinds without one."""

    def document(self, found: Result[Any]) -> dict[str, Any]:
        """Return the entries of the document for this kind of records; `records` has one for each record."""

    def levels(self, found: Result[Any]) -> Sequence[Level | SwingDamping]:
        """Return the energy lost in a cycle of each level; for free decays, frequency and damping by amplitude."""

    def pictures(self, found: Result[Any]) -> dict[str, Picture]:
        """Return the pictures by the names in `outputs.PICTURES`; those without data are left out."""

    def with_fault(self, found: Result[Any], name: str, fault: Fault) -> Mapping[str, float]:
        """Return the numbers of the named answer, and the mass as "m", identified from the data with a fault; empty if
        that is not possible."""


B = TypeVar("B", bound=Basis, covariant=True)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Result(Generic[B]):
    """The coefficients of a damping law and the contact stiffness K_z that `identify` finds in measured records.

    Take the numbers from `values`, `intervals` and `verdicts`; use a number whose verdict is "usable", and read in
    `findings` what limits the others. `summary` is a table of the answer, `to_frame` one of all answers, `plot` draws,
    `save` writes everything to a folder, and `print` shows the screen of `dampbalance identify`.

    These numbers are those of the first of `approaches`: of the maximum-likelihood fit where the records fit an
    oscillator with one friction contact, otherwise of the energy balance. `approaches[name]` has those of the others.
    Units are SI; an unknown number is NaN. For records of a rotation (`coordinate`), k and K_z are in N m/rad, c in
    N m s/rad, masses are moments of inertia in kg m², and F_k is a torque in N m, which keeps its key in Python and is
    shown and written as T_k.

    k : stiffness, N/m.
    sources : names of the records.
    records : the records.
    options : as given, by the keys of a configuration.
    laws : the damping laws that the records support, if `laws` was asked for.
    weighed : the models over which the numbers are averaged, with their weights; empty for a single model.
    reference : the answer of the fit of one oscillator to all records; None where no oscillator that slips fits.
    estimates : the other answers by name; the last is the energy balance, where there is one.
    odd : findings on the records and on disagreements of the answers; those on one answer are its notes.
    head : one line: what was identified, from how many records.
    rig : findings on the rig that the fit implies.
    check : findings of the check of the answer, such as its difference from the energy balance.
    settings : how the answers were computed, for the document.
    hint : on which inputs the numbers depend, and what to state or measure to reduce that; None if nothing would.
    basis : data and fits behind the answers.
    """

    basis: B
    k: float
    sources: tuple[str, ...]
    estimates: Mapping[str, Answer]
    odd: tuple[Finding, ...]
    head: str
    rig: Sequence[Finding]
    reference: Answer | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    check: Sequence[Finding] = ()
    weighed: tuple[Weighed, ...] = ()
    laws: LawComparison | None = None
    records: tuple[Record, ...] = ()
    options: Mapping[str, Any] = field(default_factory=dict)
    hint: Finding | None = None

    @property
    def coordinate(self) -> Coordinate:
        """Translation or rotation, which decides units and words."""
        return self.records[0].coordinate if self.records else TRANSLATION

    @property
    def levels(self) -> Sequence[Level | SwingDamping]:
        """The energy lost in a cycle of each level, with loss factor and equivalent damping; for free decays, frequency
        and damping ratio by amplitude."""
        return self.basis.levels(self)

    @property
    def level_documents(self) -> list[dict[str, Any]]:
        """The levels as plain data, by the keys of the document."""
        return [level.document(self.k, self.mass) for level in self.levels]

    @property
    def pictures(self) -> dict[str, Picture]:
        """The pictures by name."""
        return self.basis.pictures(self)

    def shifts(self, faults: Mapping[str, Fault], name: str) -> dict[str, dict[str, float]]:
        """Return the relative changes that faults make to the numbers of the named answer, see `effects_of`."""
        return effects_of(self, faults, name)

    @cached_property
    def approaches(self) -> dict[str, Answer]:
        """The answer of each approach by its name, the one to use first.

        That is the fit of one oscillator to all records, "maximum likelihood", unless the energy balance has more
        usable numbers. After the fit, the balance is a check, with values and errors but no verdicts.
        """
        fit = {} if self.reference is None else {REFERENCE: self.reference}
        answers = doubted({**self.estimates, **fit}, self.odd)
        chosen = next(iter(answers.values()))
        if fit and _worth(answers[REFERENCE]) > _worth(chosen):
            answers = {REFERENCE: answers[REFERENCE], **answers}
        first, *_ = answers
        return {
            name: self.estimates[name].as_check() if name in CHECKS and name != first else one
            for name, one in answers.items()
        }

    @property
    def figures(self) -> tuple[str, ...]:
        """Names of the pictures that `plot` draws, the most telling first.

        For forced records cycles (each record folded onto one cycle), friction (force against displacement) and balance
        (its rows and their residuals); for free decays decays (each with the fitted motion), balance and damping
        (against the amplitude); for a stepped sine loss and stiffness (against the amplitude) and distribution
        (stiffness of the contact against the amplitude of slip); for loops loops, loss and history (of the cycles); for
        steady speeds speeds.
        """
        return tuple(self.pictures)

    @property
    def answer(self) -> Answer:
        """The answer to use, the first of `approaches`."""
        return next(iter(self.approaches.values()))

    @property
    def values(self) -> dict[str, float]:
        """Each identified number by its symbol: F_k (N), c (N s/m), K_z (N/m), …"""
        return self.answer.values

    @property
    def mass(self) -> float:
        """The mass m of the fit, kg, without that of a fixture, or the stated mass if the fit holds it; NaN if no fit
        determines it."""
        moving = (self.reference or self.answer).merit.get("m_kg", math.nan)
        return float(moving - (self.options.get("fixture_mass_kg") or 0.0))

    @property
    def mass_error(self) -> float:
        """The standard error of the mass, kg; zero if the fit holds the stated mass."""
        return float((self.reference or self.answer).merit.get("m_standard_error_kg", math.nan))

    @property
    def natural_frequency(self) -> float:
        """The undamped natural frequency with the contact loose, √(k/m)/2π, Hz; NaN if the mass is not known."""
        return math.sqrt(self.k / self.mass) / (2.0 * math.pi)

    @property
    def damping_ratio(self) -> float:
        """The fraction of critical damping of c alone, ζ = c/(2√(km)); NaN if mass or c are not known.

        Friction adds to it: `levels` has the equivalent damping ratio at each level and, for a stepped sine,
        `damping_at` gives it at any amplitude.
        """
        return damping_ratio(self.values.get("c", math.nan), self.k, self.mass)

    @property
    def oscillator(self) -> dict[str, ParameterEstimate]:
        """The mass m (kg), the natural frequency f_n (Hz) and the damping ratio zeta with standard errors and 95 %
        intervals; `mass`, `natural_frequency` and `damping_ratio` are their values. Empty if no fit determines the
        mass."""
        values = {"m": self.mass, "f_n": self.natural_frequency, "zeta": self.damping_ratio}
        estimates = self.approaches.get(REFERENCE, self.answer).rig
        return {s: p.at(values[s]) for s, p in estimates.items() if not math.isnan(values[s])}

    @property
    def standard_errors(self) -> dict[str, float]:
        """The standard error of each number by its symbol, SI units."""
        return self.answer.standard_errors

    @property
    def intervals(self) -> dict[str, Interval]:
        """The 95 % interval (low, high) of each number by its symbol, SI units; an open end is infinite."""
        return self.answer.intervals

    @property
    def verdicts(self) -> dict[str, Verdict]:
        """The verdict on each number by its symbol: "usable", "doubtful" or "none", with the reason and the relative
        half width of the interval."""
        return {symbol: one.worded(self.coordinate) for symbol, one in self.answer.verdicts.items()}

    @property
    def no_answer(self) -> str:
        """Why there is no answer, if no coefficient has a value with a bounded error; otherwise empty."""
        return "; ".join(sentence(group, self.coordinate) for group in self.unanswered)

    @property
    def unanswered(self) -> list[list[Finding]]:
        """The findings because of which there is no answer; empty if there is one."""
        if self.answer.answered:
            return []
        verdicts = self.answer.verdicts
        every = [one for s in self.answer.coefficients for one in verdicts[s].findings]
        return [
            [*of] for of in grouped([one for i, one in enumerate(every) if one not in every[:i]])
        ]

    @property
    def covariance(self) -> pd.DataFrame:
        """The covariance of the errors of all numbers, in the products of their SI units; NaN where it is not known."""
        import pandas as pd  # slow to import

        symbols = list(self.answer.parameters)
        return pd.DataFrame(self.answer.covariance, index=symbols, columns=symbols)

    @property
    def rows(self) -> pd.DataFrame:
        """The rows of the energy balance Σ g_j p_j = W of the first approach that has rows: the integrals g_j (a_m,
        b_m2_per_s, …), the input work W_J, its standard error, and the residual misfit_J."""
        import pandas as pd  # slow to import

        answer = next((a for a in self.approaches.values() if a.balance is not None), self.answer)
        names = [] if answer.balance is None else answer.balance.names
        frame = pd.DataFrame(answer.rows, index=pd.Index(names, name="row"))
        return frame.rename(columns=self.coordinate.key)

    def to_frame(self) -> pd.DataFrame:
        """Return all numbers of all answers as a table, one line each: approach, symbol, unit, value, standard_error,
        low and high (the 95 % interval), verdict, within_percent and reason; the check has no verdict."""
        import pandas as pd  # slow to import

        return pd.DataFrame(
            {
                **{"approach": name, "symbol": symbol},
                "unit": self.coordinate.unit(unit_of(symbol)),
                **{"value": p.value, "standard_error": p.standard_error},
                **p.interval._asdict(),
                **answer.verdicts.get(symbol, Verdict("")).worded(self.coordinate).document(),
            }
            for name, answer in self.approaches.items()
            for symbol, p in answer.parameters.items()
        )

    def sensitivities(self) -> tuple[str | None, dict[str, dict[str, float]]]:
        """Return the name of an answer and the relative change that each of `FAULTS` makes to its numbers, fault →
        symbol → change. It is the first answer for which they are known; faults without effect are left out."""
        for name in self.approaches:
            if changes := self.shifts(FAULTS, name):
                return name, {fault: of for fault, of in changes.items() if any(of.values())}
        return None, {}

    @property
    def limits(self) -> list[list[Finding]]:
        """The findings in groups that one sentence states, those with the largest effect first; of equal effect, notes
        on answers precede findings on single records and on all of them."""
        notes = [note.about(name) for name, of in self.approaches.items() for note in of.notes]
        of_records, of_all = ([w for w in self.odd if bool(w.of) == one] for one in (True, False))
        groups = [*grouped(notes), *grouped(of_records), *([one] for one in of_all)]
        return sorted(groups, key=lambda group: -max(one.largest for one in group))

    @property
    def findings(self) -> list[Finding]:
        """The findings that limit the answers, those with the largest effect first."""
        return [one for group in self.limits for one in group]

    def in_sentences(self, findings: Iterable[Finding]) -> list[str]:
        """Return a sentence for each finding, in the words and units of the coordinate."""
        return [as_sentence(sentence(one, self.coordinate)) for one in findings]

    def summary(self) -> pd.DataFrame:
        """Return the answer as a table of at most 80 columns: a line for each number, then for m, f_n and ζ if they are
        known, with unit, value, 95 % interval (low, high) and verdict. `to_frame` has all answers."""
        import pandas as pd  # slow to import

        return pd.DataFrame(
            {
                "symbol": of.symbol,
                "unit": self.coordinate.unit(unit_of(of.symbol)),
                "value": of.p.value,
                **of.p.interval._asdict(),
                "verdict": of.verdict.verdict,
            }
            for of in shown.numbers(self)
        ).set_index("symbol")

    def __dir__(self) -> list[str]:
        """Return the names for completion, without those that only screen, report and files use."""
        return sorted({*super().__dir__()} - _MADE_FROM)

    def __repr__(self) -> str:
        """Return the screen."""
        return self.screen().rstrip("\n")

    def _repr_html_(self) -> str:
        """Return the screen, with the numbers as a table, for a notebook."""
        from .report import notebook  # slow to import

        return notebook(self)

    def screen(self, width: int = 80) -> str:
        """Return the answer as text for one screen: numbers and verdicts, the rig, the check, at most three causes of
        doubt with their remedies, and where to find the rest. If there is no answer, its cause comes first.

        width : of a line, characters; tables are not wrapped.
        """
        return shown.screen(self, width)

    def text(self, width: int | None = None) -> str:
        """Return all sentences and tables as text, as `--details` shows and summary.txt holds them: the screen with
        every cause of doubt, then all answers and models, and on which inputs the numbers depend.

        width : of a line, characters; tables are not wrapped; by default no line is.
        """
        return shown.details(self, width)

    def document(self) -> dict[str, Any]:
        """Return everything as plain data, as in `identification.json`: SI units, named in the keys; what is not known
        is None."""
        return document(self)

    def report(self) -> str:
        """Return the report, one page of HTML that needs no other file, to hand a result to others: verdicts, numbers,
        limitations and next steps, pictures, damping of each level, effect of faults, settings. `save` writes it as
        report.html."""
        from .report import report  # slow to import

        return report(self)

    def plot(
        self,
        figure: str | None = None,
        *,
        ax: Axes | Sequence[Axes | None] | None = None,
        **style: Any,
    ) -> Any:
        """Draw a picture and return its axes.

        figure : one of `figures`; by default the first.
        ax : where to draw; by default on a new figure of pyplot, whose axes are returned as an array: a panel for each
        record or, for the balance, its rows and their residuals. Axes of yours get the first panel and are returned;
        a sequence of axes gets one panel for each entry, and a panel whose entry is None is left out: `ax=[None, axes]`
        draws the residuals of the balance alone. Axes of yours have no legend until you call `axes.legend()`.
        style : properties of all lines and marks, as in `Axes.plot`: color="k", markersize=8.

        Raises ValueError for an unknown name.
        """
        from .pictures import plot  # slow to import

        return plot(self, figure, ax, style)

    def save(
        self, folder: str | Path, *, figures: bool = True, overwrite: bool = False
    ) -> list[Path]:
        """Write document, table, text, report and pictures (SVG, PNG) to a folder, and return the paths of the files.

        Everything is computed before the folder changes, and each file is written completely or not at all, the
        document last. The same records give the same bytes.

        figures : whether to write pictures and the report; they take longer than everything else.
        overwrite : whether to replace earlier results, whose pictures are removed.

        Raises ValueError if the folder has results that may not be replaced, or cannot be written to.
        """
        return save(self, folder, figures=figures, overwrite=overwrite)


_MADE_FROM = {
    *("basis", "check", "estimates", "head", "hint", "level_documents", "limits", "odd"),
    *("pictures", "reference", "rig", "settings", "shifts", "unanswered", "weighed"),
}
"""Names that only the modules use that show or write a result."""


def _worth(answer: Answer) -> tuple[float, ...]:
    """Return the numbers by which answers are ranked: how many coefficients are usable, have a bounded error, have a
    value; then whether it is the fit."""
    verdicts = [answer.verdicts[symbol] for symbol in answer.coefficients]
    usable = sum(one.verdict == USABLE for one in verdicts)
    # a limit that is usable has no size, and is no worse for it
    bounded = sum(one.verdict == USABLE or math.isfinite(one.within) for one in verdicts)
    valued = sum(one.verdict != NONE for one in verdicts)
    return usable, bounded, valued, float(answer.balance is None and answer.answered)
