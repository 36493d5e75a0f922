"""All answers to a set of records with what a report says of them, whatever the kind of the records; in numbers, a
document for programs and a table of the estimates for spreadsheets.
"""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

from .. import __version__
from ..motion.jit import interpreted
from ..project.files import plain
from ..project.wording import Remark
from ..records.measured import MeasuredRecord
from .answer import REFERENCE, USABLE, Answer, ParameterEstimate, column
from .law_comparison import LawComparison
from .remarks import doubted, limits
from .sensitivities import FAULTS, Fault

QUICK = 200_000
"""Calls of kernels, which take no more time in Python than Numba takes to load."""

_IN_TABLE = ("residual", "misfit")  # of the merit of an answer


class Picture(NamedTuple):
    """A picture of an identification.

    words : what it shows, for those who cannot see it.   of : what the function of its name in `pictures` draws.
    """

    words: str
    of: tuple[Any, ...]


class Level(NamedTuple):
    """A cycle of the motion, measured, and what a test engineer compares its damping by.

    Loss factor, quality factor and equivalent viscous damping are those of a level: friction takes less of a large
    motion than of a small one. Use them to compare with other rigs, or in a linear model at about that amplitude; F_k
    and c hold at all of them.

    name : of the record, or of the decay and the time.   X : amplitude, m.   omega : ω, rad/s.   W : energy that the
    cycle loses, J.   friction : the part of it that friction takes, J.
    """

    name: str
    X: float
    omega: float
    W: float
    friction: float

    @property
    def equivalent_damping(self) -> float:
        """The viscous damper that takes as much energy of a harmonic motion, c_eq = W/(πωX²), N s/m.

        Jacobsen, Trans. ASME 52 (1930): friction F_k alone, W = 4 F_k X, has c_eq = 4F_k/(πωX).
        """
        return self.W / (math.pi * self.omega * self.X**2)

    def loss_factor(self, k: float) -> float:
        """Energy lost in a cycle over 2π times the largest energy in the spring, η = W/(πkX²) = c_eq ω/k; Q = 1/η.

        Nashif, Jones & Henderson, Vibration Damping (1985), Sec. 3. A viscous damper at the natural frequency has
        η = 2ζ.   k : of the spring, N/m; what the contact stores is not counted.
        """
        return self.W / (math.pi * k * self.X**2)

    def document(self, k: float, m: float) -> dict[str, Any]:
        """All measures for the document.   m : kg; NaN where it is not known, and the damping ratio with it."""
        eta = self.loss_factor(k)
        return {
            "level": self.name,
            "X_m": self.X,
            "frequency_Hz": self.omega / (2.0 * math.pi),
            "W_J": self.W,
            "friction_share": self.friction / self.W if self.W else math.nan,
            "equivalent_damping_N_s_per_m": self.equivalent_damping,
            "equivalent_damping_ratio": damping_ratio(self.equivalent_damping, k, m),
            "loss_factor": eta,
            "Q": 1.0 / eta if eta else math.inf,
        }


def damping_ratio(c: float, k: float, m: float) -> float:
    """Fraction of critical damping, ζ = c/(2√(km)): of the oscillator with its contact loose.

    Inman, Engineering Vibration, Sec. 1.3.   c : N s/m.   k : N/m.   m : kg.

    >>> damping_ratio(c=40.0, k=100.0, m=4.0)  # critical
    1.0
    """
    return c / (2.0 * math.sqrt(k * m))


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
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
    records : that they come from.
    options : as given, by the keys of a configuration.
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
    records: tuple[MeasuredRecord, ...] = ()
    options: Mapping[str, Any] = field(default_factory=dict)

    kind: ClassVar[Mapping[str, str]] = {}
    """How the document names the kind of records."""

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

    @cached_property
    def answers(self) -> dict[str, Answer]:
        """The answer of each approach, by its name, and of the fit of one oscillator to all records, "maximum
        likelihood"; the one to use first, with the doubts that the warnings cast on its numbers.

        The fit is the answer, and the balance its check, unless more of what the balance says is usable.
        """
        fit = {} if self.reference is None else {REFERENCE: self.reference}
        answers = doubted({**self.estimates, **fit}, self.warnings)
        chosen = next(iter(answers.values()))
        if fit and _worth(answers[REFERENCE]) > _worth(chosen):
            answers = {REFERENCE: answers[REFERENCE], **answers}
        return answers

    def sensitivities(self) -> tuple[str | None, dict[str, dict[str, float]]]:
        """Name of the answer to use first, and what each of `FAULTS` that acts does to it, fault → symbol → number; the
        next answer where that is the fit, and it does not describe the waveforms."""
        for name in self.answers:
            if changes := self.shifts(FAULTS, [name]).get(name):
                return name, {fault: of for fault, of in changes.items() if any(of.values())}
        return None, {}

    @interpreted(calls=QUICK)
    def document(self) -> dict[str, Any]:
        """Everything, as plain data for JSON, what `identification.json` holds; SI units, named in the keys; what is
        not known is null."""
        answers, findings = {n: _entries(a) for n, a in self.answers.items()}, self.findings()
        for entry, record in zip(findings["records"], self.records, strict=bool(self.records)):
            entry |= record.files or {}
        m = math.nan if self.reference is None else self.reference.merit.get("m_kg", math.nan)
        of, effects = self.sensitivities()
        everything = {
            "dampbalance": __version__,
            **self.kind,
            "options": dict(self.options),
            "k_N_per_m": self.k,
            **self.settings,
            "answer": next(iter(answers)),
            "approaches": {name: answers[name] for name in self.estimates},
            "maximum_likelihood": answers.get(REFERENCE),
            **({} if self.laws is None else {"laws": self.laws.document()}),
            **findings,
            "damping": {
                "damping_ratio": damping_ratio(
                    next(iter(self.answers.values())).values.get("c", math.nan), self.k, m
                ),
                "levels": [level.document(self.k, m) for level in self.levels],
            },
            "sensitivities_of": of,
            "sensitivities": {
                name: {"fault": FAULTS[name].words}
                | {f"{symbol}_percent": 100.0 * change for symbol, change in changes.items()}
                for name, changes in effects.items()
            },
            "limits": [asdict(limit) for limit in limits(self.answers, self.warnings)],
            "warnings": list(self.warnings),
        }
        return plain(everything)

    def estimates_table(self) -> list[dict[str, Any]]:
        """A row for each answer, the one to use first: value, standard errors and interval of each parameter, in
        columns named with units, and the verdict on each; None where an answer has no such number."""
        rows = []
        for name, answer in self.answers.items():
            row: dict[str, Any] = {"approach": name}
            for symbol, p in answer.parameters.items():
                ends = {f"_{end}": number for end, number in p.interval._asdict().items()}
                row |= _columns(symbol, _with_errors(answer, p) | ends)
            for symbol, p in answer.equal.items():
                numbers = {"": p.value, "_standard_error": p.standard_error}
                row |= _columns(symbol, numbers, "equal_weights_")
            row |= {key: answer.merit[key] for key in _IN_TABLE if key in answer.merit}
            row |= {
                f"{symbol}_verdict": verdict for symbol, (verdict, _) in answer.verdicts.items()
            }
            rows.append(row | {"note": "; ".join(answer.notes)})
        columns = dict.fromkeys(name for row in sorted(rows, key=len, reverse=True) for name in row)
        return [{name: row.get(name) for name in columns} for row in rows]


def _worth(answer: Answer) -> tuple[float, ...]:
    """What an answer is chosen for: coefficients that are usable, coefficients that have a value, and of two that are
    equal in these the fit, unless a note limits it."""
    verdicts = answer.verdicts
    usable = sum(verdicts[symbol].verdict == USABLE for symbol in answer.coefficients)
    valued = sum(not math.isnan(p.value) for p in answer.coefficients.values())
    return usable, valued, 0.5 if answer.balance is not None else float(not answer.notes)


def _entries(answer: Answer) -> dict[str, Any]:
    """An answer for the document."""
    entries: dict[str, Any] = {}
    for beginning, parameters in (("", answer.parameters), ("equal_weights_", answer.equal)):
        for symbol, p in parameters.items():
            numbers = _with_errors(answer, p) | {"_interval": p.interval}
            entries |= _columns(symbol, numbers, beginning)
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


def _columns(symbol: str, numbers: Mapping[str, Any], beginning: str = "") -> dict[str, Any]:
    """Numbers of a parameter, given by what they are of it, in columns named with its unit."""
    return {beginning + column(symbol, what): number for what, number in numbers.items()}


def _with_errors(answer: Answer, p: ParameterEstimate) -> dict[str, Any]:
    """The value and its standard errors by the ends of their keys; the error by propagation where it is computed."""
    numbers = {"": p.value, "_standard_error": p.standard_error}
    return numbers | ({"_propagated_error": p.propagated_error} if answer.equal else {})
