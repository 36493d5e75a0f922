"""All answers to a set of records with what a report says of them, whatever the kind of the records."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from ..project.wording import Remark
from .answer import REFERENCE, USABLE, Answer
from .law_comparison import LawComparison
from .remarks import doubted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .sensitivities import Fault


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
    def pictures(self) -> dict[str, Picture]:
        """The pictures by name, the most telling first."""

    @abstractmethod
    def shifts(
        self, faults: Mapping[str, Fault], names: Collection[str]
    ) -> dict[str, dict[str, dict[str, float]]]:
        """By which part of themselves faults change the numbers of answers of these names, to first order: name of the
        answer → fault → symbol, "m" for the mass."""

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
