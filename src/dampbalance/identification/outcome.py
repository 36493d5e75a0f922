"""All answers to a set of records with what a report says of them, whatever the kind of the records; in numbers, a
document for programs and a table of the estimates for spreadsheets.
"""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from ..project.files import plain
from ..project.wording import Remark
from .answer import REFERENCE, USABLE, Answer, ParameterEstimate, column
from .equivalents import Level, damping_ratio, of_level
from .law_comparison import LawComparison
from .remarks import doubted, limits
from .sensitivities import FAULTS, Fault

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Picture(NamedTuple):
    """A picture of an identification.

    words : what it shows, for those who cannot see it.   of : what the function of its name in `pictures` draws.
    """

    words: str
    of: tuple[Any, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome(ABC):
    """The answers to a set of records, and all that a report says of them.

    k : N/m.
    sources : names of the records.
    estimates : the answer of each approach, by its name.
    reference : the answer of the fit of one oscillator to all records; None where no oscillator that slips fits.
    warnings : what is wrong with the records, and where the answers disagree.
    head : what was identified from what, in a line.
    rig : what the fit implies about the rig, in sentences.
    settings : how the answers were computed, for the document.
    laws : which damping laws the records support, where that was asked for.
    """

    k: float
    sources: tuple[str, ...]
    estimates: Mapping[str, Answer]
    reference: Answer | None
    warnings: tuple[Remark, ...]
    head: str
    rig: Sequence[str]
    settings: Mapping[str, Any]
    laws: LawComparison | None = None

    kind: ClassVar[Mapping[str, str]] = {}
    """How the document names the kind of records."""

    @cached_property
    def answers(self) -> dict[str, Answer]:
        """Each answer by its name, the one to use first, with the doubts that the warnings cast on its numbers.

        The fit of maximum likelihood is the answer, and the balance its check, unless more of what the balance says is
        usable; where the records are not those of such an oscillator, the balance is.
        """
        fit = {} if self.reference is None else {REFERENCE: self.reference}
        answers = doubted({**self.estimates, **fit}, self.warnings)
        chosen = next(iter(answers.values()))
        if fit and _worth(answers[REFERENCE]) > _worth(chosen):
            answers = {REFERENCE: answers[REFERENCE], **answers}
        return answers

    @abstractmethod
    def findings(self) -> dict[str, Any]:
        """What was read off the records and follows from them, for the document; `records` has an entry for each."""

    @abstractmethod
    def features_table(self) -> list[dict[str, Any]]:
        """What was read off the records, in columns named with units."""

    @property
    @abstractmethod
    def levels(self) -> list[Level]:
        """Cycles of the motion, what each loses: of each forced record, or of swings of a free decay."""

    @property
    @abstractmethod
    def pictures(self) -> dict[str, Picture]:
        """The pictures by name, the most telling first."""

    @abstractmethod
    def shifts(
        self, faults: Mapping[str, Fault], names: Collection[str]
    ) -> dict[str, dict[str, dict[str, float]]]:
        """By which part of themselves faults change the numbers of answers of these names, to first order: name of the
        answer → fault → symbol, "m" for the mass."""

    def sensitivities(self) -> tuple[str | None, dict[str, dict[str, float]]]:
        """Name of the answer to use first, and what each of `FAULTS` that acts does to it, fault → symbol → number; the
        next answer where that is the fit, and it does not describe the waveforms."""
        for name in self.answers:
            if changes := self.shifts(FAULTS, [name]).get(name):
                return name, {fault: of for fault, of in changes.items() if any(of.values())}
        return None, {}

    def damping(self) -> dict[str, Any]:
        """Mass and damping ratio of the answer, and the equivalent measures of each level, for the document."""
        m = math.nan if self.reference is None else self.reference.merit.get("m_kg", math.nan)
        c = next(iter(self.answers.values())).values.get("c", math.nan)
        return {
            "damping_ratio": damping_ratio(c, self.k, m),
            "levels": [of_level(level, self.k, m) for level in self.levels],
        }

    def draw(self, name: str) -> Figure:
        """One of the pictures."""
        from . import pictures  # slow to import

        return getattr(pictures, name)(*self.pictures[name].of)


def _worth(answer: Answer) -> tuple[float, ...]:
    """What an answer is chosen for: coefficients that are usable, coefficients that have a value, and of two that are
    equal in these the fit, unless a note limits it."""
    verdicts = answer.verdicts
    usable = sum(verdicts[symbol].verdict == USABLE for symbol in answer.coefficients)
    valued = sum(not math.isnan(p.value) for p in answer.coefficients.values())
    of_fit = answer.balance is None
    return usable, valued, 0.5 if not of_fit else float(not answer.notes)


_IN_TABLE = ("residual", "misfit")  # of the merit of an answer


def document(
    outcome: Outcome,
    version: str = "",
    options: Mapping[str, Any] | None = None,
    files: Sequence[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """Everything that was identified, for JSON; SI units, named in the keys; what is not known is null.

    options : as given.   files : what is known of the file of each record, in their order.
    """
    answers, findings = {n: _entries(a) for n, a in outcome.answers.items()}, outcome.findings()
    for record, file in zip(findings["records"], files, strict=bool(files)):
        record |= file
    of, effects = outcome.sensitivities()
    everything = {
        "dampbalance": version,
        **outcome.kind,
        "options": dict(options or {}),
        "k_N_per_m": outcome.k,
        **outcome.settings,
        "answer": next(iter(answers)),
        "approaches": {name: answers[name] for name in outcome.estimates},
        "maximum_likelihood": answers.get(REFERENCE),
        **findings,
        "damping": outcome.damping(),
        "sensitivities_of": of,
        "sensitivities": {
            name: {"fault": FAULTS[name].words}
            | {f"{symbol}_percent": 100.0 * change for symbol, change in changes.items()}
            for name, changes in effects.items()
        },
        "limits": [asdict(limit) for limit in limits(outcome.answers, outcome.warnings)],
        "warnings": list(outcome.warnings),
    }
    return plain(everything)


def estimates_table(outcome: Outcome) -> list[dict[str, Any]]:
    """A row for each answer, the one to use first: value, standard errors and interval of each parameter, in columns
    named with units, and the verdict on each; None where an answer has no such number."""
    rows = []
    for name, answer in outcome.answers.items():
        row: dict[str, Any] = {"approach": name}
        for symbol, parameter in answer.parameters.items():
            ends = {f"_{end}": number for end, number in parameter.interval._asdict().items()}
            numbers = _with_errors(answer, parameter) | ends
            row |= {column(symbol, what): number for what, number in numbers.items()}
        for symbol, parameter in answer.equal.items():
            row[f"equal_weights_{column(symbol)}"] = parameter.value
            row[f"equal_weights_{column(symbol, '_standard_error')}"] = parameter.standard_error
        row |= {key: answer.merit[key] for key in _IN_TABLE if key in answer.merit}
        row |= {f"{symbol}_verdict": verdict for symbol, (verdict, _) in answer.verdicts.items()}
        rows.append(row | {"note": "; ".join(answer.notes)})
    columns = dict.fromkeys(name for row in sorted(rows, key=len, reverse=True) for name in row)
    return [{name: row.get(name) for name in columns} for row in rows]


def _entries(answer: Answer) -> dict[str, Any]:
    """An answer for the document."""
    entries: dict[str, Any] = {}
    for beginning, parameters in (("", answer.parameters), ("equal_weights_", answer.equal)):
        for symbol, parameter in parameters.items():
            numbers = _with_errors(answer, parameter) | {"_interval": parameter.interval}
            entries |= {beginning + column(symbol, what): of for what, of in numbers.items()}
    if answer.balance is not None:
        entries |= {
            f"correlation_of_{one}_and_{other}": answer.correlations.get((one, other))
            for one, other in itertools.combinations(answer.coefficients, 2)
        }
    entries["verdicts"] = {symbol: v._asdict() for symbol, v in answer.verdicts.items()}
    entries |= answer.merit
    if answer.balance is not None:
        entries["rows"] = {**answer.rows, **answer.balance.labels}
    return entries | {"notes": answer.notes}


def _with_errors(answer: Answer, parameter: ParameterEstimate) -> dict[str, Any]:
    """The value and its standard errors by the ends of their keys; the error by propagation where it is computed."""
    numbers = {"": parameter.value, "_standard_error": parameter.standard_error}
    return numbers | ({"_propagated_error": parameter.propagated_error} if answer.equal else {})
