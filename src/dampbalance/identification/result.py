"""The result of an identification, whatever the kind of its records: numbers, findings and what they rest on.

Screen, document, tables, report, pictures and files are functions of a result, each in its module.
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
from . import outputs
from . import screen as shown
from .answer import CHECKS, NONE, REFERENCE, USABLE, Answer, Interval, Verdict, doubted
from .document import document
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
    """What the answers to a kind of records rest on: all that a kind has of its own, as functions of the result."""

    kind: ClassVar[str]
    """As `identify` takes it."""

    mass_tests: ClassVar[bool]
    """Whether a mass that is given tests stiffness and gains; else it is taken as it is."""

    columns: ClassVar[Mapping[str, Column]]
    """What is measured of each level without a model, by the keys of its document: the table that screen and report
    begin with, its lines grouped by the first column; none where the answer says it all."""

    def document(self, found: Result[Any]) -> dict[str, Any]:
        """Return what was read off the records and follows from them, for the document; `records` has an entry for
        each."""

    def levels(self, found: Result[Any]) -> Sequence[Level | SwingDamping]:
        """Return cycles of the motion, what each loses; of free decays frequency and damping over the amplitude."""

    def pictures(self, found: Result[Any]) -> dict[str, Picture]:
        """Return the pictures of `outputs.PICTURES` by name, those that have something to show."""

    def with_fault(self, found: Result[Any], name: str, fault: Fault) -> Mapping[str, float]:
        """Return the numbers of the answer of that name from the data with a fault, "m" for the mass; empty where they
        are not known."""


B = TypeVar("B", bound=Basis, covariant=True)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Result(Generic[B]):
    """The coefficients of a damping law and K_z from measured records; what `identify` returns.

    k : N/m.
    sources : names of the records.
    estimates : the other answers, by name; the last is the balance of energy, where there is one.
    reference : the answer of the fit of one oscillator to all records; None where no oscillator that slips fits.
    odd : findings on the records, and where the answers disagree; those on an answer are its notes.
    head : what was identified from what, in a line.
    rig : what the fit implies about the rig.
    check : what checks the answer: by how much the balance of energy differs from the fit, and the like.
    settings : how the answers were computed, for the document.
    weighed : models that the numbers are means of, with their weights; none where there is one.
    laws : which damping laws the records support, where that was asked for.
    records : that they come from.
    options : as given, by the keys of a configuration.
    hint : on what the numbers depend, and what to state or give to be sure of them; None where nothing is left.
    basis : what the answers rest on: readings, fits and the like of this kind of records.

    Records that rotate have the same numbers in units of a rotation (`coordinate` is `ROTATION` then): k and K_z in
    N m/rad, c in N m s/rad, masses as moments of inertia in kg m², and F_k in N m. F_k keeps its key in Python; what is
    shown or written calls it T_k, and J the inertia.

    `values`, `intervals`, `covariance` and the like are those of the first of `approaches`. That is the fit of maximum
    likelihood where the records are those of an oscillator with one friction contact, and the balance of energy
    otherwise. Those of any other are in `approaches[name]`. SI units throughout; a number that is not known is NaN. In
    a terminal and in a notebook it shows itself as `dampbalance identify` does.
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
        """Whether the records are of a translation or of a rotation, which decides on units and words."""
        return self.records[0].coordinate if self.records else TRANSLATION

    @property
    def levels(self) -> Sequence[Level | SwingDamping]:
        """Cycles of the motion, what each loses; of free decays frequency and damping over the amplitude."""
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
        """Return the relative change of the numbers of the answer of that name with faults, see `effects_of`."""
        return effects_of(self, faults, name)

    @cached_property
    def approaches(self) -> dict[str, Answer]:
        """The answer of each approach, by its name, and of the fit of one oscillator to all records, "maximum
        likelihood"; the one to use first, with the doubts that the warnings cast on its numbers.

        The fit is the answer, and the balance its check, with values and errors alone, unless more of what the balance
        says is usable.
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
        """Names of the pictures that `plot` draws, the first if none is named: of forced records cycles (each record
        folded onto one cycle), friction (force against displacement) and balance (its rows, and what they leave);
        of free decays decays (each with the motion fitted to it) and damping (over the amplitude); of a stepped sine
        loss and stiffness (against the amplitude) and distribution (of the contact over the amplitude at which it
        slips)."""
        return tuple(self.pictures)

    @property
    def answer(self) -> Answer:
        """The answer whose values these are."""
        return next(iter(self.approaches.values()))

    @property
    def values(self) -> dict[str, float]:
        """Each identified number by its symbol: F_k (N), c (N s/m), K_z (N/m), …"""
        return self.answer.values

    @property
    def mass(self) -> float:
        """The mass m of the fit, kg, or the one given where the fit takes it, without that of a fixture; NaN where no
        fit determines it."""
        moving = (self.reference or self.answer).merit.get("m_kg", math.nan)
        return float(moving - (self.options.get("fixture_mass_kg") or 0.0))

    @property
    def mass_error(self) -> float:
        """The standard error of the mass, kg; zero where the fit takes the mass that was given."""
        return float((self.reference or self.answer).merit.get("m_standard_error_kg", math.nan))

    @property
    def natural_frequency(self) -> float:
        """The undamped natural frequency of this mass on the spring k, with the contact loose, √(k/m)/2π, Hz; NaN where
        the mass is not known."""
        return math.sqrt(self.k / self.mass) / (2.0 * math.pi)

    @property
    def damping_ratio(self) -> float:
        """The fraction of critical damping of c alone, ζ = c/(2√(km)), a pure number; NaN where mass or c are not
        known. Friction adds to it: `document` lists the damping ratio of each level, and of a stepped sine
        `damping_at` gives it at any amplitude."""
        return damping_ratio(self.values.get("c", math.nan), self.k, self.mass)

    @property
    def oscillator(self) -> dict[str, ParameterEstimate]:
        """The mass m (kg), the natural frequency f_n (Hz) and the damping ratio zeta, of which `mass`,
        `natural_frequency` and `damping_ratio` are the values, with standard errors and intervals of 95 %; none where
        no fit determines the mass."""
        values = {"m": self.mass, "f_n": self.natural_frequency, "zeta": self.damping_ratio}
        estimates = self.approaches.get(REFERENCE, self.answer).rig
        return {s: p.at(values[s]) for s, p in estimates.items() if not math.isnan(values[s])}

    @property
    def standard_errors(self) -> dict[str, float]:
        """The standard error of each."""
        return self.answer.standard_errors

    @property
    def intervals(self) -> dict[str, Interval]:
        """The interval (low, high) that holds the true value with a probability of 95 %; an open end is infinite."""
        return self.answer.intervals

    @property
    def verdicts(self) -> dict[str, Verdict]:
        """The verdict on each: usable, doubtful or none, and why."""
        return {symbol: one.worded(self.coordinate) for symbol, one in self.answer.verdicts.items()}

    @property
    def no_answer(self) -> str:
        """Why there is no answer, where no coefficient has a value whose error is bounded; empty where there is one."""
        return "; ".join(sentence(group, self.coordinate) for group in self.unanswered)

    @property
    def unanswered(self) -> list[list[Finding]]:
        """The findings for which there is no answer; none where there is one."""
        if self.answer.answered:
            return []
        verdicts = self.answer.verdicts
        every = [one for s in self.answer.coefficients for one in verdicts[s].findings]
        return [
            [*of] for of in grouped([one for i, one in enumerate(every) if one not in every[:i]])
        ]

    @property
    def covariance(self) -> pd.DataFrame:
        """The covariance of their errors, in the products of their units; NaN where it is not known."""
        import pandas as pd  # slow to import

        symbols = list(self.answer.parameters)
        return pd.DataFrame(self.answer.covariance, index=symbols, columns=symbols)

    @property
    def rows(self) -> pd.DataFrame:
        """The rows of the energy balance Σ g_j p_j = W: the integrals g_j (a_m, b_m2_per_s, …), the input work W_J, its
        standard error, and what the values of the balance leave of it, misfit_J; of the first approach that has
        rows."""
        import pandas as pd  # slow to import

        answer = next((a for a in self.approaches.values() if a.balance is not None), self.answer)
        names = [] if answer.balance is None else answer.balance.names
        frame = pd.DataFrame(answer.rows, index=pd.Index(names, name="row"))
        return frame.rename(columns=self.coordinate.key)

    def to_frame(self) -> pd.DataFrame:
        """Return a line for each answer and each number: approach, symbol, unit, value, standard_error, low and high
        (the interval of 95 %), verdict, within_percent, reason; the check has no verdict."""
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
        """Name of the answer to use first, and what each of `FAULTS` that acts does to it, fault → symbol → number; the
        next answer where that is the fit, and it does not describe the waveforms."""
        for name in self.approaches:
            if changes := self.shifts(FAULTS, name):
                return name, {fault: of for fault, of in changes.items() if any(of.values())}
        return None, {}

    @property
    def limits(self) -> list[list[Finding]]:
        """The findings, those that one sentence may state together, beginning with what may change a number most; of
        equal effect, notes on answers come before findings on records and on all of them."""
        notes = [note.about(name) for name, of in self.approaches.items() for note in of.notes]
        of_records, of_all = ([w for w in self.odd if bool(w.of) == one] for one in (True, False))
        groups = [*grouped(notes), *grouped(of_records), *([one] for one in of_all)]
        return sorted(groups, key=lambda group: -max(one.largest for one in group))

    @property
    def findings(self) -> list[Finding]:
        """What limits the answers, beginning with what may change a number most."""
        return [one for group in self.limits for one in group]

    def in_sentences(self, findings: Iterable[Finding]) -> list[str]:
        """Return a sentence for each finding, in the words and units of the coordinate."""
        return [as_sentence(sentence(one, self.coordinate)) for one in findings]

    def summary(self) -> pd.DataFrame:
        """Return the answer as a table of 80 columns: a line for each number, then for m, f_n and ζ where they are
        known, with unit, value, interval of 95 % (low, high) and verdict. `to_frame` has all that is known of all
        answers."""
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
        """Return the names to complete, without those from which screen, report and files are made."""
        return sorted({*super().__dir__()} - _MADE_FROM)

    def __repr__(self) -> str:
        """Return the screen."""
        return self.screen().rstrip("\n")

    def _repr_html_(self) -> str:
        """Return the screen, with the numbers as a table, for a notebook."""
        from .report import notebook  # slow to import

        return notebook(self)

    def screen(self, width: int = 80) -> str:
        """Return one screen: the answer, what it says of the rig, what checks it, at most three causes of doubt with
        their remedies, and where the rest is. Where there is no answer, the cause comes first and the numbers last.

        width : of a line, characters; tables are not wrapped.
        """
        return shown.screen(self, width)

    def text(self, width: int | None = None) -> str:
        """Return all sentences and tables, what `--details` shows and summary.txt holds: the screen with every cause
        of doubt, and below it all answers and models, and on what the numbers depend.

        width : of a line, characters; tables are not wrapped, and nothing is by default.
        """
        return shown.details(self, width)

    def document(self) -> dict[str, Any]:
        """Return everything, as plain data for JSON, what `identification.json` holds; SI units, named in the keys;
        what is not known is null."""
        return document(self)

    def report(self) -> str:
        """Return the report as one page of HTML that needs no other file: verdict, numbers, pictures, what limits the
        answer and what to do next, damping of each level, effect of faults, settings. Use it to hand a result to
        others; `save` writes it as report.html."""
        from .report import report  # slow to import

        return report(self)

    def plot(
        self,
        figure: str | None = None,
        *,
        ax: Axes | Sequence[Axes | None] | None = None,
        **style: Any,
    ) -> Any:
        """Draw one of the pictures that `figures` names, the first by default, and return its axes.

        ax : where to draw. By default on a new figure of pyplot, whose axes are returned as an array: a panel for each
        record or, for the balance, its rows and their residuals. Axes of yours take the first panel, and are returned;
        a sequence of axes takes as many panels as it has entries, and leaves out those for which it has None:
        `ax=[None, axes]` draws the residuals of the balance alone. Add a legend to axes of yours by `axes.legend()`.
        style : properties of all lines and marks, as in `Axes.plot`: color="k", markersize=8.

        Raises ValueError for a name that is none of them.
        """
        from .pictures import plot  # slow to import

        return plot(self, figure, ax, style)

    def save(
        self, folder: str | Path, *, figures: bool = True, overwrite: bool = False
    ) -> list[Path]:
        """Write all of it to a folder: document, tables and text, and the pictures as SVG and PNG; returns the files.

        All of it is computed before anything there changes; each file is complete or not at all, the document comes
        last; the same records give the same bytes. Pictures of an earlier identification there are removed.

        Raises ValueError where results are there already and may not be replaced, or nothing can be written.
        """
        return outputs.save(self, folder, figures=figures, overwrite=overwrite)


_MADE_FROM = {
    *("basis", "check", "estimates", "head", "hint", "level_documents", "limits", "odd"),
    *("pictures", "reference", "rig", "settings", "shifts", "unanswered", "weighed"),
}
"""Names of a result for the modules that show or write it."""


def _worth(answer: Answer) -> tuple[float, ...]:
    """Return the reasons for which an answer is chosen: coefficients that are usable, that have a bounded error, that
    have a value; and of two that are equal in these the fit, where it is an answer."""
    verdicts = [answer.verdicts[symbol] for symbol in answer.coefficients]
    usable = sum(one.verdict == USABLE for one in verdicts)
    # a limit that is usable has no size, and is no worse for it
    bounded = sum(one.verdict == USABLE or math.isfinite(one.within) for one in verdicts)
    valued = sum(one.verdict != NONE for one in verdicts)
    return usable, bounded, valued, float(answer.balance is None and answer.answered)
