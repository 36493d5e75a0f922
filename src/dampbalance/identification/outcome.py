"""What an identification hands over, of forced records and of free decays alike."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from .answer import REFERENCE, Answer, Remark

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Picture(NamedTuple):
    """A picture of an identification.   draw : it.   words : what it shows, for those who cannot see it."""

    draw: Callable[[], Figure]
    words: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome(ABC):
    """The answers to a set of records, and all that a report says of them.

    k : N/m.   sources : names of the records.   estimates : the answer of each approach, by its name.   reference : the
    answer of the fit of one oscillator to all records; None where no oscillator that slips fits.   warnings : what is
    wrong with the records, and where the answers disagree.
    """

    k: float
    sources: tuple[str, ...]
    estimates: Mapping[str, Answer]
    reference: Answer | None
    warnings: tuple[Remark, ...]

    kind: ClassVar[Mapping[str, str]] = {}
    """How the document names the kind of records."""

    @property
    def answers(self) -> dict[str, Answer]:
        """Each answer by its name, that of the fit last."""
        fit = {} if self.reference is None else {REFERENCE: self.reference}
        return {**self.estimates, **fit}

    @property
    @abstractmethod
    def head(self) -> str:
        """What was identified from what, in a line."""

    @property
    @abstractmethod
    def rig(self) -> Sequence[str]:
        """What the fit implies about the rig, in sentences."""

    @property
    def comparison(self) -> Sequence[str]:
        """The comparison of damping laws, in lines for a screen; empty where none was asked for."""
        return ()

    @abstractmethod
    def settings(self) -> dict[str, Any]:
        """How the answers were computed, for the document."""

    @abstractmethod
    def findings(self, files: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        """What was read off the records and follows from them, for the document.

        files : what is known of the file of each record, in their order.
        """

    @abstractmethod
    def features_table(self) -> list[dict[str, Any]]:
        """What was read off the records, in columns named with units."""

    @property
    @abstractmethod
    def pictures(self) -> dict[str, Picture]:
        """The pictures by name, the most telling first."""
