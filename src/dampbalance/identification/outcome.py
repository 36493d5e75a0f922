"""All answers to a set of records with what a report says of them, whatever the kind of the records."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from ..project.wording import Remark
from .answer import REFERENCE, Answer
from .law_comparison import LawComparison

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

    @property
    def answers(self) -> dict[str, Answer]:
        """Each answer by its name, that of the fit last."""
        fit = {} if self.reference is None else {REFERENCE: self.reference}
        return {**self.estimates, **fit}

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

    def draw(self, name: str) -> Figure:
        """One of the pictures."""
        from . import pictures  # slow to import

        return getattr(pictures, name)(*self.pictures[name].of)
