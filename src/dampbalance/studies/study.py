"""Studies from Python: the keys, the checks and the numbers of a study's YAML file, without a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from ..arguments import names, one_of, shown, whole
from ..model import UNITS, Oscillator, named_with_unit
from ..project.documents import DEEPEST
from .cases import case_columns
from .evaluate import evaluate, responses_of
from .study_file import PAPER_CASE, Listed, Study

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

_OF_NAMES = ("approaches", "phases", "sharing", "contact", "weights", "yardsticks", "fits")


@dataclass(frozen=True, eq=False, repr=False)
class StudyResult:
    """The result of `study`: the errors of every way to identify F_k and c, case by case.

    `print` shows its `summary`, `plot` draws it, and `to_frame` and `to_xarray` return all numbers.

    settings : what was studied.   cases : the table of cases.
    """

    settings: Study
    cases: pd.DataFrame

    def to_frame(self) -> pd.DataFrame:
        """Return a table with a row for each case: axes, parameters in SI units, regime, and what `columns` asks for.

        Each way to identify F_k and c has columns such as F_k_relative_error__X_s__reversal__individual__least_squares.
        """
        return self.cases.copy()

    @cached_property
    def responses(self) -> pd.DataFrame:
        """A table with a row for each case and level: axes, level counted from 1, and features of the response, X_m,
        X_s_m, phi_rad, W_J and so on. They are computed on first use; noisy ones are those from which the errors
        come."""
        return responses_of(self.settings, 0, self.settings.cases)

    @property
    def summary(self) -> pd.DataFrame:
        """A table with a row for each way to identify: median and largest size of the relative error of each
        coefficient, and the share of the cases in which it could be identified."""
        rows = {}
        for fit in self.settings.fits:
            row: dict[str, float] = {}
            for symbol in fit.identified:
                if (errors := self.cases.get(f"{symbol}_relative_error__{fit.label}")) is not None:
                    size = errors.abs()
                    row |= {f"{symbol} median": size.median(), f"{symbol} largest": size.max()}
                    row.setdefault("identified", size.notna().mean())
            rows[fit.label] = row
        return pd.DataFrame.from_dict(rows, orient="index").rename_axis("fit")

    def to_xarray(self) -> xarray.Dataset:
        """Return the table as a data set of xarray, which has to be installed.

        It holds errors over the axes and the dimension `fit`, responses over the axes and the dimension `level`.
        Axes that are varied together share the dimension of the first of them; a sample has a dimension of its own.
        """
        try:
            import xarray
        except ImportError:
            raise ValueError(
                "to_xarray needs the package xarray: install it, or use to_frame"
            ) from None
        study = self.settings
        data: dict[str, Any] = {}
        sizes: dict[str, int] = {}
        coords: dict[str, Any] = {}
        for number, block in enumerate(study.blocks, start=1):
            dimension = next(iter(block.axes)) if isinstance(block, Listed) else f"sample_{number}"
            sizes[dimension] = block.count
            points = block.at(np.arange(block.count))
            coords |= {name: (dimension, values) for name, values in points.items()}
        shape, dims, fits = tuple(sizes.values()), tuple(sizes), [fit.label for fit in study.fits]
        coords |= {"fit": fits, "level": np.arange(len(study.levels)) + 1}
        for column in case_columns(study):
            if column.name in ("case", *study.axis_names):
                continue
            quantity, _, label = column.name.partition("__")
            values = self.cases[column.name].to_numpy().reshape(shape)
            about = {"units": column.unit, "long_name": column.meaning.partition(";")[0]}
            if label:
                empty = np.full((*shape, len(fits)), np.nan)
                _, of_fits, _ = data.setdefault(quantity, ((*dims, "fit"), empty, about))
                of_fits[..., fits.index(label)] = values
            else:
                data[quantity] = dims, values, about
        of_levels = self.responses.drop(columns=["case", "level", *study.axis_names])
        for name in of_levels.columns:
            values = of_levels[name].to_numpy().reshape(*shape, len(study.levels))
            data[f"response_{name}" if name in data else name] = (*dims, "level"), values
        return xarray.Dataset(data, coords)

    def plot(self, figure: str | None = None, *, ax: Axes | None = None) -> Any:
        """Draw a figure of the errors and return its axes.

        figure : "curves" (errors along an axis), "map" (over two axes) or "scatter" (errors over many runs of noise);
        default, the one that suits the axes best, as for a file without a figure.
        ax : where to draw the first panel, which is returned; default, a new figure of pyplot, whose axes are returned
        as an array.

        Raises ValueError for another name, and for a figure that the axes of the study do not suit.
        """
        from ..figures.style import drawn_in  # slow to import, and needed for pictures only
        from .reading_study import with_usual_figure
        from .shown.study_figure import FIGURES

        kind = "" if figure is None else one_of("figure", figure, FIGURES)
        drawn = with_usual_figure(self.settings, kind)
        if not drawn.figure:
            axes = ", ".join(drawn.axis_names)
            raise ValueError(
                f"no figure{f' of the kind {kind}' * bool(kind)} suits a study over {axes}: "
                f"{'leave out its name' if kind else 'vary a number'}, or draw columns of to_frame"
            )
        with drawn_in(None if ax is None else [ax]):
            page = FIGURES[drawn.figure["kind"]](drawn, self.cases)
        return np.array(page.axes) if ax is None else ax

    def __repr__(self) -> str:
        """Return what was studied, and the summary."""
        return f"{self._head}\n{self.summary.to_string(float_format='{:.3g}'.format)}"

    def _repr_html_(self) -> str:
        """Return what was studied, and the summary as a table."""
        return f"<p>{self._head}</p>{self.summary.to_html(float_format='{:.3g}'.format)}"

    @property
    def _head(self) -> str:
        study = self.settings
        over = ", ".join(study.axis_names)
        return f"Study over {over}: {study.cases:,} cases of {len(study.levels)} levels; sizes of relative errors"


def study(
    axes: Mapping[str, Any] | Sequence[Mapping[str, Any]],
    *,
    base: Mapping[str, float] | Oscillator | None = None,
    levels_m: Sequence[float] | None = None,
    levels_of_Y: Sequence[float] | None = None,
    estimation: Mapping[str, Any] | None = None,
    route: Mapping[str, Any] | str | None = None,
    read_out: Mapping[str, Any] | None = None,
    columns: Sequence[str] | str | None = None,
    threads: int | None = None,
) -> StudyResult:
    """Compute how well approaches identify F_k and c, over any parameters of oscillator, excitation or noise.

    Use it to find out how well the method works for a system like yours, or under another damping law. The arguments
    are the keys of a study's YAML file, with the same meaning, defaults and checks; use a file for a study with a
    figure and a text, on many cores, or larger than memory. Parameters that are left out have the paper's values.

    axes : name of a parameter → its values, an array or a list, or a range
    {"from": 0.4, "to": 2.6, "count": 50, "spacing": "log"}; the cases are their product. Or a list of blocks as in the
    file: axes that are in one block vary together, and {"sample": {...}} is a sample of a box.
    base : parameters that no axis sets, or an oscillator.
    levels_m, levels_of_Y : amplitudes of the base at the levels, m, or as multiples of Y_m.
    estimation : how F_k and c are identified: approaches, phases, sharing, contact, fits, terms,
    ...; a name alone stands for a list of one.
    route : where the responses come from, {"kind": "measured", "sampling_hz": 1000, "noise": 0.01, "seed": 0}; a name
    alone is its kind; default, the exact solution, a million orbits in a second.
    read_out : rules by which features are rounded.
    columns : what the table holds of each fit: parameters, errors, estimates, residuals, intervals.
    threads : for exact responses; default, the cores that this process may use.

    Raises ConfigurationError, a ValueError, naming every wrong argument and what would be right.

    >>> from dampbalance import study
    >>> studied = study(
    ...     {"frequency_hz": [3.5, 4.92, 11.1]},
    ...     estimation={"approaches": ["X_s", "fourier"]},
    ...     route={"kind": "measured", "sampling_hz": 1000, "noise": 0.01, "seed": 1},
    ... )
    >>> errors = studied.to_frame()["F_k_relative_error__X_s__reversal__individual__least_squares"]
    >>> [f"{100 * error:+.1f} %" for error in errors]
    ['-16.1 %', '+0.6 %', '+11.4 %']
    >>> studied.responses[["frequency_hz", "level", "Y_m", "X_m"]].round(5).head(2).values.tolist()
    [[3.5, 1.0, 0.004, 0.00339], [3.5, 2.0, 0.006, 0.00541]]
    """
    from ..project.documents import ConfigurationError, in_lines, read_schema
    from .parameters import STUDY_SCHEMA
    from .reading_study import MOST_NUMBERS, problems

    given = {
        **{"axes": axes, "base": base, "levels_m": levels_m, "levels_of_Y": levels_of_Y},
        **{"estimation": estimation, "route": route, "read_out": read_out, "columns": columns},
    }
    stated = {key: value for key, value in given.items() if value is not None or key == "axes"}
    document = {"title": "study()", **_document(stated)}
    if wrong := list(problems(document, read_schema(STUDY_SCHEMA), PAPER_CASE)):
        if isinstance(axes, Mapping):  # the blocks of a mapping have no number
            wrong = [(key[:1] + key[2:] if key[0] == "axes" else key, text) for key, text in wrong]
        raise ConfigurationError(in_lines(wrong, {"study()": document}))
    settings = Study.of("study", document, PAPER_CASE)
    if (size := settings.cases * len(case_columns(settings))) > MOST_NUMBERS:
        raise ConfigurationError(
            f"study(): axes: {settings.cases:,} cases with {size // settings.cases} columns do not fit in memory; "
            "take fewer, or let the workflow run a file of config/studies"
        )
    cores = None if threads is None else whole("threads", threads)
    return StudyResult(settings, evaluate(settings, 0, settings.cases, cores))


def _document(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments as the document of a YAML file; a name alone stands for a list of one."""
    document: dict[str, Any] = _plain(given)
    if isinstance(document["axes"], dict):
        document["axes"] = [{name: spec} for name, spec in document["axes"].items()]
    for block in document["axes"] if isinstance(document["axes"], list) else ():
        if isinstance(block, dict):
            block |= {name: {"values": x} for name, x in block.items() if isinstance(x, list)}
    if isinstance(document.get("route"), str):
        document["route"] = {"kind": document["route"]}
    estimation = document.get("estimation")
    for section, key in ((document, "columns"), *((estimation, key) for key in _OF_NAMES)):
        if isinstance(section, dict) and isinstance(section.get(key), str):
            section[key] = list(names(key, section[key]))
    if isinstance(estimation, dict) and isinstance(terms := estimation.get("terms"), str | list):
        laws = [terms] if isinstance(terms, str) else terms
        estimation["terms"] = [list(names("terms", x)) if isinstance(x, str) else x for x in laws]
    return document


def _plain(value: Any, depth: int = 0) -> Any:
    """Return a value as a YAML file would hold it; what none can hold becomes text, which the schema refuses."""
    if depth > DEEPEST:
        raise ValueError(f"study(): more than {DEEPEST} lists and mappings inside each other")
    if isinstance(value, Oscillator):
        value = {named_with_unit(name, UNITS[name]): x for name, x in asdict(value).items()}
    if hasattr(value, "tolist") and not isinstance(value, type):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _plain(item, depth + 1) for key, item in value.items()}
    if isinstance(value, list | tuple | range):
        return [_plain(item, depth + 1) for item in value]
    return value if isinstance(value, str | int | float | None) else shown(value)
