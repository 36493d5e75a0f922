"""What an identification hands over: values, intervals, covariance, rows, tables, pictures, files."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import __version__
from ..arguments import flag, one_of, path
from ..motion.jit import interpreted
from ..project.files import write_json, write_rows, write_text
from ..records.measured import MeasuredRecord
from . import reporting, ringdown_reporting
from .answers import Answer, answers_of_decays, answers_of_forced
from .loading import Loaded
from .outputs import ALL_PICTURES, FIGURES, RING_DOWN_FIGURES, TABLES, pictures_of, require_room
from .result import Identification, Interval, unit_of
from .ringdown import RingDown
from .showing import Shown
from .verdicts import Verdict

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

QUICK = 200_000
"""Calls of kernels, which take no more time in Python than Numba takes to load."""


@dataclass(frozen=True, eq=False, repr=False)
class Identified(ABC):
    """The coefficients of a damping law and K_z from measured records, by every approach; what `identify` returns.

    records : that they come from.   options : what was asked for, by the keys of a configuration.

    `values`, `intervals`, `covariance`, `rows` and the like are those of one approach, the first of `approaches`:
    direct integration, unless others were chosen; for free decays, their balance. Those of any other are in
    `approaches[name]`. SI units throughout; a number that is not known is NaN. In a terminal and in a notebook it shows
    itself as the table that `dampbalance identify` prints.
    """

    records: tuple[MeasuredRecord, ...]
    options: Mapping[str, Any]

    @property
    @abstractmethod
    def approaches(self) -> dict[str, Answer]:
        """What each approach says, by its name, and the fit of one oscillator to all records, "maximum likelihood"."""

    @property
    @abstractmethod
    def warnings(self) -> tuple[str, ...]:
        """What is wrong with the records, and where the answers disagree."""

    @property
    @abstractmethod
    def figures(self) -> tuple[str, ...]:
        """Names of the pictures that `plot` draws, the first if none is named."""

    @property
    def answer(self) -> Answer:
        """The answer whose values these are."""
        return next(iter(self.approaches.values()))

    @property
    def values(self) -> dict[str, float]:
        """Each identified number by its symbol: F_k (N), c (N s/m), K_z (N/m), …"""
        return self.answer.values

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
        """What each is worth: usable, doubtful or none, and why."""
        return self.answer.verdicts

    @property
    def covariance(self) -> pd.DataFrame:
        """The covariance of their errors, in the products of their units; NaN where it is not known."""
        import pandas as pd  # slow to import

        symbols = list(self.answer.parameters)
        return pd.DataFrame(self.answer.covariance, index=symbols, columns=symbols)

    @property
    def rows(self) -> pd.DataFrame:
        """The rows of the energy balance Σ g_j p_j = W: the integrals g_j (a_m, b_m2_per_s, …), the input work W_J, its
        standard error, and what the values leave of it, misfit_J."""
        import pandas as pd  # slow to import

        answer = self.answer
        return pd.DataFrame(dict(answer.rows), index=pd.Index(answer.row_names, name="row"))

    def to_frame(self) -> pd.DataFrame:
        """A line for each approach and each number: approach, symbol, unit, value, standard_error, low and high (the
        interval of 95 %), verdict, reason."""
        import pandas as pd  # slow to import

        lines = []
        for name, answer in self.approaches.items():
            verdicts = answer.verdicts
            for symbol, p in answer.parameters.items():
                line: dict[str, Any] = {"approach": name, "symbol": symbol, "unit": unit_of(symbol)}
                line |= {"value": p.value, "standard_error": p.standard_error}
                lines.append(line | p.interval._asdict() | verdicts[symbol]._asdict())
        return pd.DataFrame(lines)

    def plot(self, figure: str | None = None) -> Figure:
        """One of the pictures that `figures` names; the first by default.

        Raises ValueError for a name that is none of them.
        """
        name = self.figures[0] if figure is None else one_of("figure", figure, self.figures)
        with warnings.catch_warnings():  # a name in a script that the font lacks shows as boxes
            warnings.filterwarnings("ignore", r"Glyph .* missing from font", UserWarning)
            return self._draw(name)()

    def text(self) -> str:
        """The table for a screen, with what limits the answer."""
        return self._shown.text()

    @abstractmethod
    def document(self) -> dict[str, Any]:
        """Everything, as plain data for JSON: what `identification.json` holds."""

    def save(
        self, folder: str | Path, *, figures: bool = True, overwrite: bool = False
    ) -> list[Path]:
        """Write all of it to a folder: document, tables and text, and the pictures as SVG and PNG; returns the files.

        Each file is complete or not at all, the document comes last; the same records give the same bytes. Pictures of
        an earlier identification there are removed.

        Raises ValueError where results are there already and may not be replaced, or nothing can be written.
        """
        folder = path("folder", folder, "the path of a folder")
        remedy = "" if flag("overwrite", overwrite) else "overwrite=True"
        require_room(folder, (*TABLES, *ALL_PICTURES), remedy)
        pictures = pictures_of(self.figures) if flag("figures", figures) else ()
        for name in set(ALL_PICTURES) - set(pictures):
            (folder / name).unlink(missing_ok=True)
        if figures:
            self._save_figures(folder)
        estimates, features = self._tables
        write_rows(folder / "identification.csv", estimates)
        write_rows(folder / "features.csv", features)
        write_text(folder / "summary.txt", self.text())
        write_json(folder / "identification.json", self.document())
        return [folder / name for name in (*TABLES, *pictures)]

    @interpreted(calls=QUICK)
    def _save_figures(self, folder: Path) -> None:
        from ..figures.style import save  # slow to import, and needed for pictures only
        from .drawing import DPI

        with warnings.catch_warnings():  # a name in a script that the font lacks shows as boxes
            warnings.filterwarnings("ignore", r"Glyph .* missing from font", UserWarning)
            for name in self.figures:
                svg, png = (folder / file for file in pictures_of([name]))
                save(self._draw(name)(), svg, png, self._in_words[name], DPI)

    @property
    @abstractmethod
    def _shown(self) -> Shown: ...

    @property
    @abstractmethod
    def _tables(self) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
        """The rows of the tables of estimates and of features."""

    @abstractmethod
    def _draw(self, name: str) -> Callable[[], Figure]: ...

    @property
    @abstractmethod
    def _in_words(self) -> Mapping[str, str]:
        """What each picture shows."""

    @property
    def _files(self) -> list[Mapping[str, Any]]:
        return [record.files or {} for record in self.records]

    def __repr__(self) -> str:
        """The table for a screen."""
        return self.text().rstrip("\n")

    def _repr_html_(self) -> str:
        """The same for a notebook."""
        return self._shown.html()


@dataclass(frozen=True, eq=False, repr=False)
class IdentifiedSteady(Identified):
    """`Identified` from records of steady responses.

    result : with all that the estimates come from.   loaded : the records as they were read.
    """

    result: Identification
    loaded: tuple[Loaded, ...]

    @cached_property
    def approaches(self) -> dict[str, Answer]:
        """What each approach says, and the fit, by name."""
        return answers_of_forced(self.result)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong with the records, and where the answers disagree."""
        return self.result.warnings

    @property
    def figures(self) -> tuple[str, ...]:
        """cycles : each record folded onto one cycle.   loops : acceleration against displacement.   balance : its rows
        and what they leave."""
        return FIGURES

    @interpreted(calls=QUICK)
    def document(self) -> dict[str, Any]:
        """Everything, as plain data for JSON."""
        return reporting.document(self.result, __version__, self.options, self._files)

    @property
    def _shown(self) -> Shown:
        return reporting.shown(self.result)

    @property
    def _tables(self) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
        return reporting.estimates_table(self.result), reporting.features_table(self.result)

    def _draw(self, name: str) -> Callable[[], Figure]:
        from . import drawing  # slow to import

        return {
            "cycles": lambda: drawing.cycles(self.loaded, self.result),
            "loops": lambda: drawing.loops(self.loaded, self.result),
            "balance": lambda: drawing.balance(self.result),
        }[name]

    @property
    def _in_words(self) -> Mapping[str, str]:
        from . import drawing  # slow to import

        return drawing.alternative_texts(self.result)


@dataclass(frozen=True, eq=False, repr=False)
class IdentifiedDecays(Identified):
    """`Identified` from records of free decays.   result : with all that the estimates come from."""

    result: RingDown

    @cached_property
    def approaches(self) -> dict[str, Answer]:
        """What the balance says, and the fit, by name."""
        return answers_of_decays(self.result)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong with the records."""
        return self.result.warnings

    @property
    def figures(self) -> tuple[str, ...]:
        """decays : each with the motion fitted to it."""
        return RING_DOWN_FIGURES

    def document(self) -> dict[str, Any]:
        """Everything, as plain data for JSON."""
        return ringdown_reporting.document(self.result, __version__, self.options, self._files)

    @property
    def _shown(self) -> Shown:
        return ringdown_reporting.shown(self.result)

    @property
    def _tables(self) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
        of = ringdown_reporting
        return of.estimates_table(self.result), of.features_table(self.result)

    def _draw(self, name: str) -> Callable[[], Figure]:
        from . import ringdown_drawing  # slow to import

        return {"decays": lambda: ringdown_drawing.decays(self.result)}[name]

    @property
    def _in_words(self) -> Mapping[str, str]:
        from . import ringdown_drawing  # slow to import

        return {"decays": ringdown_drawing.alternative_text(self.result)}
