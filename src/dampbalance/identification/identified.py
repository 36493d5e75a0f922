"""Results of an identification, whatever the kind of its records: answers, tables, sentences, pictures, files."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from html import escape
from pathlib import Path, PurePath
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from .. import __version__
from ..arguments import flag, one_of, path
from ..findings.finding import Finding, grouped
from ..findings.words import in_a_sentence, limit, unit_of
from ..findings.words import sentence as worded
from ..law.terms import FRICTION
from ..project.files import plain, write_json, write_rows, write_text
from ..project.wording import percent, sentence, visible
from ..records.coordinate import ROTATION, TRANSLATION, Coordinate
from ..records.record import Record
from .answer import (
    CHECKS,
    NONE,
    REFERENCE,
    USABLE,
    Answer,
    Interval,
    Verdict,
    columns_of,
    doubted,
    entries,
)
from .law_comparison import LawComparison
from .level import Level, damping_ratio
from .outputs import ALL_PICTURES, REPORT, TABLES, pictures_of, require_room, written_together
from .screen import (
    agreement_of,
    aligned,
    answer_in_words,
    answers_table,
    comparison,
    damping_of,
    value_of,
    wrapped,
)
from .sensitivities import FAULTS, Fault

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

_IN_TABLE = ("residual", "misfit")  # of the merit of an answer
_CAUSES = 3  # of doubt that a screen has room for


class Picture(NamedTuple):
    """A picture of an identification.

    words : what it shows, for those who cannot see it.   of : what the function of its name in `drawings` draws.
    """

    words: str
    of: tuple[Any, ...]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Identified(ABC):
    """The coefficients of a damping law and K_z from measured records; what `identify` returns.

    k : N/m.
    sources : names of the records.
    estimates : the other answers, by name; the last is the balance of energy, where there is one.
    reference : the answer of the fit of one oscillator to all records; None where no oscillator that slips fits.
    warnings : what is wrong with the records, and where the answers disagree.
    head : what was identified from what, in a line.
    rig : what the fit implies about the rig.
    settings : how the answers were computed, for the document.
    laws : which damping laws the records support, where that was asked for.
    records : that they come from.
    options : as given, by the keys of a configuration.
    hint : on what the numbers depend, and what to state or give to be sure of them; None where nothing is left.

    Records that rotate have the same numbers in units of a rotation (`coordinate` is `ROTATION` then): k and K_z in
    N m/rad, c in N m s/rad, masses as moments of inertia in kg m², and F_k in N m. F_k keeps its key in Python; what is
    shown or written calls it T_k, and J the inertia.

    `values`, `intervals`, `covariance` and the like are those of the first of `approaches`. That is the fit of maximum
    likelihood where the records are those of an oscillator with one friction contact, and the balance of energy
    otherwise. Those of any other are in `approaches[name]`. SI units throughout; a number that is not known is NaN. In
    a terminal and in a notebook it shows itself as the table that `dampbalance identify` prints.
    """

    k: float
    sources: tuple[str, ...]
    estimates: Mapping[str, Answer]
    reference: Answer | None
    warnings: tuple[Finding, ...]
    head: str
    rig: Sequence[Finding]
    settings: Mapping[str, Any]
    laws: LawComparison | None = None
    records: tuple[Record, ...] = ()
    options: Mapping[str, Any] = field(default_factory=dict)
    hint: Finding | None = None

    kind: ClassVar[Mapping[str, str]] = {}
    """How the document names the kind of records."""

    mass_tests: ClassVar[bool] = True
    """Whether a mass that is given tests stiffness and gains; else it is taken as it is."""

    @property
    def coordinate(self) -> Coordinate:
        """Whether the records are of a translation or of a rotation, which decides on units and words."""
        return self.records[0].coordinate if self.records else TRANSLATION

    def in_words(self, text: str) -> str:
        """Return a sentence in the words and units of the coordinate; names of records stay."""
        return self.coordinate.text(text, self._names)

    @cached_property
    def _names(self) -> frozenset[str]:
        """Names of records and levels, as they stand in texts."""
        names = {*self.sources, *(record.label for record in self.records)}
        names |= {visible(PurePath(name).name) for name in names} | {visible(n) for n in names}
        return frozenset(names | {escape(name) for name in names})

    @abstractmethod
    def findings(self) -> dict[str, Any]:
        """Return what was read off the records and follows from them, for the document; `records` has an entry for
        each."""

    @property
    @abstractmethod
    def levels(self) -> list[Level]:
        """Cycles of the motion, what each loses: of each forced record, or of swings of a free decay."""

    @property
    @abstractmethod
    def pictures(self) -> dict[str, Picture]:
        """The pictures by name, the most telling first."""

    @property
    def drawings(self) -> ModuleType:
        """The module with a function for each of the pictures, by its name."""
        from . import pictures  # slow to import

        return pictures

    def friction_loops(self, mass: float | None = None) -> dict[str, pd.DataFrame]:
        """Return the friction force over the averaged cycle of each forced record, by its name.

            f = k(y − x) − mẍ − Σ p_j h_j(ẋ, ẏ)

        Use it to plot loops, and to fit a law of friction of your own to them. The p_j are the coefficients beyond
        friction, as identified or given. Columns: phase_rad (0 at the peak of the base), x_m, v_m_per_s and f_N.
        Displacements are deviations from their mean over the cycle: f holds a constant that no record determines.

        mass : kg; default, that of the fit. Without a fit it is ∮ k(y − x)ẍ dt / ∮ ẍ² dt, exact for a contact that does
        not yield: neither a force of constant size against ẋ nor one in proportion to ẋ correlates with ẍ over a cycle.

        Raises ValueError for records without a periodic response.
        """
        raise ValueError("friction_loops: these records are not forced; free decays have `plot`")

    def damping_at(self, X: ArrayLike, frequency_hz: ArrayLike) -> pd.DataFrame:
        """Return the equivalent damping ratio that a stepped sine implies at amplitudes, with its interval.

            ζ(X) = W(X)/(2π m ω² X²)

        W(X) is the energy that the identified law loses in a cycle. Use it to predict a decay, or in a linear model of
        the structure at a known amplitude. Columns: X_m, damping_ratio, low and high; NaN beyond the amplitudes that
        were measured, where nothing is known of the contact.

        X : amplitudes, m, (n,).   frequency_hz : at which the structure swings, Hz, (n,) or one.

        Raises ValueError for other records than a stepped sine.
        """
        raise ValueError("damping_at: these records are no stepped sine; `document` has `damping`")

    @abstractmethod
    def shifts(self, faults: Mapping[str, Fault], name: str) -> dict[str, dict[str, float]]:
        """Return the relative change of the numbers of the answer of that name with faults, to first order: fault →
        symbol, "m" for the mass; empty where that is not known."""

    @cached_property
    def approaches(self) -> dict[str, Answer]:
        """The answer of each approach, by its name, and of the fit of one oscillator to all records, "maximum
        likelihood"; the one to use first, with the doubts that the warnings cast on its numbers.

        The fit is the answer, and the balance its check, with values and errors alone, unless more of what the balance
        says is usable.
        """
        fit = {} if self.reference is None else {REFERENCE: self.reference}
        answers = doubted({**self.estimates, **fit}, self.warnings)
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
        of free decays decays (each with the motion fitted to it); of a stepped sine loss and stiffness (against
        the amplitude) and distribution (of the contact over the amplitude at which it slips)."""
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
        return "; ".join(worded(group, self.coordinate) for group in self._unanswered)

    @property
    def _unanswered(self) -> list[list[Finding]]:
        """The findings for which there is no answer; none where there is one."""
        if self.answer.answered:
            return []
        verdicts = self.answer.verdicts
        every = [one for s in self.answer.coefficients for one in verdicts[s].findings]
        return [
            [*of] for of in grouped([one for i, one in enumerate(every) if one not in every[:i]])
        ]

    @property
    def lead(self) -> str:
        """The sentence before all numbers: that there is no answer and its first cause, or no friction; else empty."""
        if why := self._unanswered:
            return sentence(f"no answer: {worded(why[0], self.coordinate, remedy=False)}")
        verdict, c = self.verdicts.get(FRICTION), self.answer.parameters.get("c")
        if verdict is None or c is None or (verdict.verdict, verdict.within) != (USABLE, math.inf):
            return ""
        ends = self.answer.parameters[FRICTION].interval
        friction = limit(FRICTION, *ends, self.coordinate)
        ratio = self.damping_ratio
        zeta = "" if math.isnan(ratio) else f", ζ = {percent(ratio, 2)}"
        words = f"No friction ({friction} at 95 %); c = {value_of(c)} {unit_of('c')}{zeta}."
        return self.in_words(words)

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

        answer = next(a for a in self.approaches.values() if a.balance is not None)
        names = [] if answer.balance is None else answer.balance.names
        columns = self.coordinate.document(answer.rows)
        return pd.DataFrame(columns, index=pd.Index(names, name="row"))

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
                **answer.verdicts.get(symbol, Verdict("")).document(),
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

    def document(self) -> dict[str, Any]:
        """Return everything, as plain data for JSON, what `identification.json` holds; SI units, named in the keys;
        what is not known is null."""
        shown: dict[str, Any] = self.coordinate.document(self._document(), self._names)
        return shown

    def _document(self) -> dict[str, Any]:
        """Return the document with the names of a translation."""
        answers = {n: entries(a, self.coordinate) for n, a in self.approaches.items()}
        findings = self.findings()
        for entry, record in zip(findings["records"], self.records, strict=bool(self.records)):
            entry |= record.files or {}
        of, effects = self.sensitivities()
        everything = {
            "dampbalance": __version__,
            **self.kind,
            **({} if self.coordinate == TRANSLATION else {"coordinate": self.coordinate.name}),
            "options": dict(self.options),
            "k_N_per_m": self.k,
            **self.settings,
            "answer": next(iter(answers)),
            "no_answer": self.no_answer or None,
            "approaches": {name: answers[name] for name in self.estimates},
            "maximum_likelihood": answers.get(REFERENCE),
            **({} if self.laws is None else {"laws": self.laws.document()}),
            **findings,
            "damping": {
                "damping_ratio": self.damping_ratio,
                "levels": [level.document(self.k, self.mass) for level in self.levels],
            },
            "sensitivities_of": of,
            "sensitivities": {
                name: {"fault": FAULTS[name].words}
                | {f"{symbol}_percent": 100.0 * change for symbol, change in changes.items()}
                for name, changes in effects.items()
            },
            "findings": [
                one.document() | {"sentence": worded(one, self.coordinate)}
                for group in self.limits
                for one in group
            ],
        }
        return plain(everything)

    def estimates_table(self) -> list[dict[str, Any]]:
        """Return a row for each answer, the one to use first: value, standard errors and interval of each parameter, in
        columns named with units, and the verdict on each; None where an answer has no such number."""
        rows = []
        for name, answer in self.approaches.items():
            row = {"approach": name} | columns_of(answer, table=True)
            row |= {key: answer.merit[key] for key in _IN_TABLE if key in answer.merit}
            for symbol, v in answer.verdicts.items():
                row |= {
                    f"{symbol}_verdict": v.verdict,
                    f"{symbol}_within_percent": 100.0 * v.within,
                }
            rows.append(
                row | {"note": "; ".join(worded(one, self.coordinate) for one in answer.notes)}
            )
        rows[0]["no_answer"] = self.no_answer
        columns = dict.fromkeys(name for row in sorted(rows, key=len, reverse=True) for name in row)
        table = [{name: row.get(name) for name in columns} for row in rows]
        return [self.coordinate.document(row, self._names) for row in table]

    @property
    def limits(self) -> list[list[Finding]]:
        """What limits the answers, each thing once, beginning with what may change a number most; of equal effect,
        notes on answers come before findings on records and on all of them."""
        notes = [note.about(name) for name, of in self.approaches.items() for note in of.notes]
        of_records, of_all = (
            [w for w in self.warnings if bool(w.of) == one] for one in (True, False)
        )
        groups = [*grouped(notes), *grouped(of_records), *([one] for one in of_all)]
        return sorted(groups, key=lambda group: -max(one.largest for one in group))

    @property
    def limiting(self) -> list[str]:
        """Limits of the answers, in sentences: "*" begins a note on answers, "warning:" all else."""
        return [
            ("* " if group[0].of in self.approaches else "warning: ") + self.named(group)
            for group in self.limits
        ]

    def named(self, findings: Sequence[Finding]) -> str:
        """Return findings of one kind in a sentence that names what they are about, unless it is the answer alone."""
        if all(one.of == self.answer.name for one in findings):
            return worded(findings, self.coordinate)
        return in_a_sentence(findings, self.sources, self.coordinate)

    def in_sentences(self, findings: Sequence[Finding]) -> list[str]:
        """Return a sentence for each finding."""
        return [sentence(worded(one, self.coordinate)) for one in findings]

    def text(self) -> str:
        """Return all sentences and tables for a screen, what `--details` shows and summary.txt holds: the answers with
        their 95 % intervals and verdicts, a line each, then what limits them; where there is no answer, the causes
        first and the numbers last."""
        tests, sentences = [*map(self.in_words, comparison(self.laws))], self.limiting
        numbers = [self.head, "", *self._table(), "", *self.in_sentences(self.rig)]
        numbers += ["", *tests] if tests else []
        heading = "Causes and remedies" if self.no_answer else "What limits the answer"
        causes = [f"{heading}:", *sentences] if sentences else []
        parts = [causes, numbers] if self.no_answer else [numbers, causes]
        parts = [[self.lead] if self.lead else [], *parts]
        return "\n\n".join("\n".join(part) for part in parts if part) + "\n"

    def _table(self) -> list[str]:
        """Return the lines of the table of all answers."""
        return aligned(
            [[*map(self.coordinate.text, line)] for line in answers_table(self.approaches)]
        )

    @property
    def check(self) -> str:
        """A sentence on what checks the answer; empty where nothing does."""
        return agreement_of(self.approaches)

    def screen(self, width: int = 80, *, details: str = "the method text") -> str:
        """Return one screen: the answer, what it says of the rig, what checks it, at most three causes of doubt with
        their remedies, and where the rest is. Where there is no answer, the cause comes first and the numbers last.

        width : of a line, characters; tables are not wrapped.   details : what shows the rest.
        """
        answer = self.lead or self.in_words(answer_in_words(self.answer, self.coordinate))
        own = [of for of in self.limits if {o.of for o in of} - {*self.approaches} or self._own(of)]
        first = next(iter(self._unanswered), [])
        cause = next((of for of in own if first and of[0].kind == first[0].kind), None)
        if cause is not None:  # with its remedy
            answer = sentence(f"no answer: {worded(cause, self.coordinate)}")
            own.remove(cause)
        causes = [worded(o, self.coordinate) if self._own(o) else self.named(o) for o in own]
        left = max(0, len(causes) - _CAUSES)
        causes = [*map(sentence, causes[:_CAUSES])]
        if self.hint and not first and len(causes) < _CAUSES:
            causes += self.in_sentences([self.hint])
        c, mass = self.values.get("c", math.nan), (self.mass, self.mass_error)
        numbers = [*map(self.in_words, (*damping_of(self.k, mass, c, self.levels), self.check))]
        causes = [f"- {one}" for one in causes]
        parts = [causes, self._table(), numbers] if self.no_answer else [numbers, causes]
        parts += [[*map(self.in_words, comparison(self.laws))]]
        more = f"{left} more and " * bool(left) + "all numbers"
        parts += [[f"See {details} for {more}, and for what they depend on."]]
        broken = [wrapped(part, width) for part in ([answer], *parts)]
        return "\n\n".join("\n".join(part) for part in broken if part) + "\n"

    def _own(self, findings: Sequence[Finding]) -> bool:
        """Return whether findings are about the answer."""
        return self.answer.name in {one.of for one in findings}

    def summary(self) -> pd.DataFrame:
        """Return the answer as a table for a notebook: a line for each number, with unit, value, standard error,
        interval of 95 % and verdict, then m, f_n and ζ."""
        import pandas as pd  # slow to import

        table = self.to_frame().query("approach == @self.answer.name").drop(columns="approach")
        values = (self.mass, self.natural_frequency, self.damping_ratio)
        units = map(self.coordinate.unit, ("kg", "Hz", "1"))
        rig = pd.DataFrame({"symbol": ["m", "f_n", "zeta"], "unit": units, "value": values})
        return pd.concat([table, rig]).set_index("symbol")

    def __repr__(self) -> str:
        """The screen."""
        return self.screen().rstrip("\n")

    def _repr_html_(self) -> str:
        """Return the table for a notebook."""
        return self._page("notebook")

    def _page(self, template: str, **content: Any) -> str:
        """Return a page in the words and units of the coordinate; drawings stay as they are."""
        from .report import page_of  # slow to import

        pieces = re.split(r"(data:[^\"]*)", page_of(template, found=self, **content))
        return "".join(
            piece if piece.startswith("data:") else self.in_words(piece) for piece in pieces
        )

    def draw(self, name: str) -> Figure:
        """Return one of the pictures, on a page of its own; `plot` draws in axes that are given."""
        from matplotlib.text import Text  # slow to import

        from ..figures.style import lacking_glyphs

        with lacking_glyphs():
            drawn: Figure = getattr(self.drawings, name)(*self.pictures[name].of)
        for text in drawn.findobj(Text) if self.coordinate == ROTATION else ():
            assert isinstance(text, Text)
            text.set_text(self.coordinate.drawn(text.get_text(), self._names))
        return drawn

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
        from ..figures.style import drawn_in  # slow to import, and needed for pictures only

        name = self.figures[0] if figure is None else one_of("figure", figure, self.figures)
        several = ax is None or isinstance(ax, Iterable)
        given: Any = ax if several else [ax]
        held = [] if given is None else [one for one in given if one is not None]
        before = {line for axes in held for line in axes.get_lines()}
        with drawn_in(given):
            drawn = self.draw(name)
        axes = held or drawn.axes
        for one in held:  # what the panels of a picture share, each of these has
            shared = [panel.get_xlabel() for panel in drawn.axes if panel.get_xlabel()]
            one.set_xlabel(one.get_xlabel() or next(iter(shared), ""))
            one.tick_params(labelbottom=True)
        for line in (line for one in axes for line in one.get_lines() if line not in before):
            line.set(**style)
        return np.array(axes) if several else ax

    def save(
        self, folder: str | Path, *, figures: bool = True, overwrite: bool = False
    ) -> list[Path]:
        """Write all of it to a folder: document, tables and text, and the pictures as SVG and PNG; returns the files.

        All of it is computed before anything there changes; each file is complete or not at all, the document comes
        last; the same records give the same bytes. Pictures of an earlier identification there are removed.

        Raises ValueError where results are there already and may not be replaced, or nothing can be written.
        """
        folder = path("folder", folder, "the path of a folder")
        remedy = "" if flag("overwrite", overwrite) else "overwrite=True"
        require_room(folder, (*TABLES, *ALL_PICTURES), remedy)
        pictures = (*pictures_of(self.figures), REPORT) if flag("figures", figures) else ()
        with written_together(folder, (*pictures, *reversed(TABLES))) as new:
            if figures:
                write_text(new / REPORT, self._report(new))
            write_rows(new / "identification.csv", self.estimates_table())
            write_text(new / "summary.txt", self.text())
            write_json(new / "identification.json", self.document())
        return [folder / name for name in (*TABLES, *pictures)]

    def report(self) -> str:
        """Return the report as one page of HTML that needs no other file: verdict, numbers, pictures, what limits the
        answer and what to do next, damping of each level, effect of faults, settings. Use it to hand a result to
        others; `save` writes it as report.html."""
        with TemporaryDirectory() as folder:
            return self._report(Path(folder), png=False)

    def _report(self, folder: Path, png: bool = True) -> str:
        """Return the report, and the pictures in a folder."""
        # slow to import, and needed for pictures only
        from ..figures.style import lacking_glyphs, save, save_svg
        from .pictures import DPI

        drawings = {}
        for name, picture in self.pictures.items():
            words = self.in_words(picture.words)
            svg, other = (folder / file for file in pictures_of([name]))
            with lacking_glyphs():
                if png:
                    save(self.draw(name), svg, other, words, DPI)
                else:
                    save_svg(self.draw(name), svg, words, DPI)
            drawings[name] = svg.read_text(encoding="utf-8")
        return self._page("report", document=self._document(), drawings=drawings)


def _worth(answer: Answer) -> tuple[float, ...]:
    """Return the reasons for which an answer is chosen: coefficients that are usable, that have a bounded error, that
    have a value; and of two that are equal in these the fit, where it is an answer."""
    verdicts = [answer.verdicts[symbol] for symbol in answer.coefficients]
    usable = sum(one.verdict == USABLE for one in verdicts)
    bounded = sum(math.isfinite(one.within) for one in verdicts)
    valued = sum(one.verdict != NONE for one in verdicts)
    return usable, bounded, valued, float(answer.balance is None and answer.answered)
