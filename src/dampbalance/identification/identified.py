"""What an identification hands over, whatever the kind of its records: answers, tables, sentences, pictures, files."""

from __future__ import annotations

import warnings
from abc import ABC
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import flag, one_of, path
from ..motion.jit import interpreted
from ..project.files import write_json, write_rows, write_text
from . import screen
from .answer import Answer, Interval, Verdict, unit_of
from .outcome import QUICK, Outcome
from .outputs import ALL_PICTURES, REPORT, TABLES, pictures_of, require_room

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Identified(Outcome, ABC):
    """The coefficients of a damping law and K_z from measured records, by every approach; what `identify` returns.

    `values`, `intervals`, `covariance` and the like are those of the first of `approaches`. That is the fit of maximum
    likelihood where the records are those of an oscillator with one friction contact, and the balance of energy
    otherwise: direct integration, unless other approaches were chosen. Those of any other are in `approaches[name]`. SI
    units throughout; a number that is not known is NaN. In a terminal and in a notebook it shows itself as the table
    that `dampbalance identify` prints.
    """

    @property
    def approaches(self) -> dict[str, Answer]:
        """The answer of each approach, by its name, and of the fit of one oscillator to all records, "maximum
        likelihood"; the one to use first."""
        return self.answers

    @property
    def result(self) -> Identified:
        """The identification itself: `result.answers` are its `approaches`."""
        return self

    @property
    def figures(self) -> tuple[str, ...]:
        """Names of the pictures that `plot` draws, the first if none is named: of forced records cycles (each record
        folded onto one cycle), loops (acceleration against displacement) and balance (its rows, and what they leave);
        of free decays decays (each with the motion fitted to it)."""
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
        standard error, and what the values of the balance leave of it, misfit_J; of the first approach that has
        rows."""
        import pandas as pd  # slow to import

        answer = next(a for a in self.approaches.values() if a.balance is not None)
        return pd.DataFrame(dict(answer.rows), index=pd.Index(answer.row_names, name="row"))

    def to_frame(self) -> pd.DataFrame:
        """A line for each approach and each number: approach, symbol, unit, value, standard_error, low and high (the
        interval of 95 %), verdict, reason."""
        import pandas as pd  # slow to import

        return pd.DataFrame(
            {
                **{"approach": name, "symbol": symbol, "unit": unit_of(symbol)},
                **{"value": p.value, "standard_error": p.standard_error},
                **p.interval._asdict(),
                **answer.verdicts[symbol]._asdict(),
            }
            for name, answer in self.approaches.items()
            for symbol, p in answer.parameters.items()
        )

    def text(self) -> str:
        """The table for a screen, with what limits the answer."""
        return screen.text(self)

    def __repr__(self) -> str:
        """The table for a screen."""
        return self.text().rstrip("\n")

    def _repr_html_(self) -> str:
        """The table for a notebook."""
        from .report import notebook  # slow to import

        return notebook(self)

    def draw(self, name: str) -> Figure:
        """One of the pictures, on a page of its own; `plot` draws in axes that are given."""
        from . import pictures  # slow to import

        with _lacking_glyphs():
            return getattr(pictures, name)(*self.pictures[name].of)

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

        Each file is complete or not at all, the document comes last; the same records give the same bytes. Pictures of
        an earlier identification there are removed.

        Raises ValueError where results are there already and may not be replaced, or nothing can be written.
        """
        folder = path("folder", folder, "the path of a folder")
        remedy = "" if flag("overwrite", overwrite) else "overwrite=True"
        require_room(folder, (*TABLES, *ALL_PICTURES), remedy)
        pictures = (*pictures_of(self.figures), REPORT) if flag("figures", figures) else ()
        for name in set(ALL_PICTURES) - set(pictures):
            (folder / name).unlink(missing_ok=True)
        if figures:
            write_text(folder / REPORT, self._report(folder))
        write_rows(folder / "identification.csv", self.estimates_table())
        write_rows(folder / "features.csv", self.features_table())
        write_text(folder / "summary.txt", self.text())
        write_json(folder / "identification.json", self.document())
        return [folder / name for name in (*TABLES, *pictures)]

    def report(self) -> str:
        """The report as one page of HTML that needs no other file: verdict, numbers, pictures, what limits the answer
        and what to do next, damping of each level, effect of faults, settings. Use it to hand a result to others;
        `save` writes it as report.html."""
        with TemporaryDirectory() as folder:
            return self._report(Path(folder), png=False)

    @interpreted(calls=QUICK)
    def _report(self, folder: Path, png: bool = True) -> str:
        """The report, and the pictures in a folder."""
        from ..figures.style import save, save_svg  # slow to import, and needed for pictures only
        from .pictures import DPI
        from .report import report

        drawings = {}
        for name, picture in self.pictures.items():
            svg, other = (folder / file for file in pictures_of([name]))
            with _lacking_glyphs():
                if png:
                    save(self.draw(name), svg, other, picture.words, DPI)
                else:
                    save_svg(self.draw(name), svg, picture.words)
            drawings[name] = svg.read_text(encoding="utf-8")
        return report(self, drawings)


@contextmanager
def _lacking_glyphs() -> Iterator[None]:
    """A name in a script that the font lacks shows as boxes, without a warning."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Glyph .* missing from font", UserWarning)
        yield
