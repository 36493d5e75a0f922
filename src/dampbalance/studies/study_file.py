"""A study as its YAML file describes it: axes, route and fits; `reading_study` finds what is wrong with the file.

The cases of a study are the product of its blocks of axes, the last block running fastest. A block is one axis, several
paired (zipped) axes of equal length, or a sample of points in the box that several parameters span. The values of any
stretch of cases follow without ever making a list of all cases.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any, Literal, NamedTuple, Self

import numpy as np

from ..arrays import Array, Integers, Mask, Words
from ..balance import APPROACHES, TERMS, approach
from ..law.terms import in_order
from ..project.documents import read_schema
from ..replication.clean import ReadAt
from .parameters import OF_LAW, PARAMETERS, STUDY_SCHEMA, parameter, synonyms

# --- axes --------------------------------------------------------------------------------------------

# 2³² points at most; with more bits scipy cannot skip to the first point of a chunk.
SOBOL_BITS = 32
SAME = 1e-12  # relative: values of an axis that differ by less are equal except for rounding


class Range(NamedTuple):
    """Bounds of one parameter of a sample; `spacing` says whether the values or their logarithms are spread evenly."""

    low: float
    high: float
    spacing: Literal["linear", "log"]

    def at(self, share: Array) -> Array:
        """Return the value at a share 0 … 1 of the way from low to high."""
        if self.spacing == "linear":
            return np.asarray(self.low + share * (self.high - self.low))
        low, high = math.log(self.low), math.log(self.high)
        return np.clip(np.exp(low + share * (high - low)), self.low, self.high)


@dataclass(frozen=True)
class Listed:
    """Axes that vary together: name → values, all of the same length. A plain axis has one name."""

    axes: Mapping[str, Sequence[float | int | str]]

    @property
    def count(self) -> int:
        """The number of points in the block."""
        return len(next(iter(self.axes.values())))

    def at(self, index: Integers) -> dict[str, Words]:
        """Return the values of each parameter at the points `index`."""
        return {name: np.asarray(values)[index] for name, values in self.axes.items()}


@dataclass(frozen=True)
class Sampled:
    """Points in the box of the axes: a scrambled Sobol sequence, or independent random ones.

    The points depend only on method, seed and their place in the sequence: any stretch can be computed by itself.
    """

    axes: Mapping[str, Range]
    method: Literal["sobol", "random"]
    count: int
    seed: int

    def at(self, index: Integers) -> dict[str, Words]:
        """Return the values of each parameter at the points `index`."""
        first = int(index.min())
        shares = self._shares(first, int(index.max()) - first + 1)[index - first]
        return {name: bounds.at(shares[:, i]) for i, (name, bounds) in enumerate(self.axes.items())}

    def _shares(self, start: int, count: int) -> Array:
        dimension = len(self.axes)
        if self.method == "random":
            bits = np.random.PCG64(self.seed).advance(start * dimension)  # one draw a number
            return np.random.Generator(bits).random((count, dimension))
        from scipy.stats import qmc  # slow to import: longer than a chunk takes to compute

        points = qmc.Sobol(dimension, scramble=True, bits=SOBOL_BITS, rng=self.seed)
        if start:
            points.fast_forward(start)
        with warnings.catch_warnings():  # the whole sequence matters, not the length of a stretch
            warnings.filterwarnings("ignore", "The balance properties", UserWarning)
            return np.asarray(points.random(count), dtype=np.float64)


Block = Listed | Sampled


def _block(item: Mapping[str, Any]) -> Block:
    if "sample" not in item:
        return Listed(
            {name: spec.get("values") or spread_values(spec) for name, spec in item.items()}
        )
    ranges = {
        name: Range(float(spec["from"]), float(spec["to"]), spec.get("spacing", "linear"))
        for name, spec in item["sample"]["over"].items()
    }
    return Sampled(ranges, *(item["sample"][key] for key in ("method", "count", "seed")))


def case_values(blocks: Sequence[Block], start: int, stop: int) -> dict[str, Words]:
    """Return the value of every axis in the cases start … stop − 1, each an array of length stop − start."""
    remaining = np.arange(start, stop, dtype=np.int64)
    values: dict[str, Words] = {}
    for block in reversed(blocks):
        remaining, index = np.divmod(remaining, block.count)
        values = block.at(index) | values
    return values


def spread_values(spec: Mapping[str, Any]) -> list[float]:
    """Return the values of an axis that is given by its ends, which it includes, and their number.

    They or their logarithms are evenly spaced; further values, `also`, are sorted in, and replace those that equal them
    except for rounding.
    """
    spaced = np.geomspace if spec.get("spacing") == "log" else np.linspace
    values = spaced(float(spec["from"]), float(spec["to"]), spec["count"]).tolist()
    if "also" not in spec:
        return values
    also = np.array(spec["also"], float)
    return sorted([*(x for x in values if not is_value(also, x).any()), *also.tolist()])


def is_value(values: Words, wanted: float) -> Mask:
    """Return which values equal the wanted one, except for rounding."""
    return np.abs(values.astype(float) - wanted) <= SAME * abs(wanted)


def selected(values: Mapping[str, Words], spec: Mapping[str, Any]) -> Mask:
    """Return which points have the values of axes in `at` and lie in the bounds `between` of a number or a figure.

    Axes that have no values here do not count.
    """
    mask = np.ones(len(next(iter(values.values()))), dtype=bool)
    for name, wanted in spec.get("at", {}).items():
        if name in values:
            here = values[name]
            mask &= here == wanted if isinstance(wanted, str) else is_value(here, wanted)
    for name, (low, high) in spec.get("between", {}).items():
        if name in values:
            mask &= (values[name] >= low) & (values[name] <= high)
    return mask


# --- routes ------------------------------------------------------------------------------------------


class Route(NamedTuple):
    """A way to compute the responses of a case, as the schema of studies describes it.

    kind : its name in the file.
    needs : parameters of the route; of each group one is needed.   optional : further parameters that it takes.
    cycles, chunk_cases : if the file does not say.
    """

    kind: str
    chunk_cases: int
    cycles: int = 0
    needs: Sequence[Sequence[str]] = ()
    optional: Sequence[str] = ()

    @property
    def is_noisy(self) -> bool:
        """Whether the records have noise, so that coefficients have standard errors and rows can be weighted."""
        return self.kind == "measured"

    def takes(self, name: str) -> bool:
        """Return whether the route uses a parameter: noisy records are read without rounding, and only exact responses
        exist under further damping."""
        kind = parameter(name).kind
        if kind == "numerics":
            return name in self.optional or any(name in names for names in self.needs)
        return (
            not self.is_noisy if kind == "read_out" else name not in OF_LAW or self.kind == "exact"
        )


STUDY_ROUTES = {
    kind: Route(kind, **of) for kind, of in read_schema(STUDY_SCHEMA)["$defs"]["routes"].items()
}


# --- fits --------------------------------------------------------------------------------------------

COMPLIANT, RIGID = "compliant", "rigid"
"""Models of the contact: with the slip onset as it was read, or without one (`Features.rigid`)."""

WEIGHTED, EQUAL = "weighted", "equal"
"""Weights of the rows of noisy records: by inverse variance, or equal, as in Eq. (9)."""

SIMPSON, LIKELIHOOD = "simpson", "fit"
YARDSTICKS = (SIMPSON, LIKELIHOOD)
"""Yardsticks of approaches on noisy records: plain Simpson (`studies.simpson`), which takes a
rigid contact and equal weights, and the maximum-likelihood oscillator, which needs no balance."""

CONTACT = "K_z"
"""Symbol of the contact stiffness; as a yardstick, the maximum-likelihood oscillator with its K_z besides F_k and c."""

_KEYS_SHOWN = ("title", "figure", "summary_by")  # keys on which no number depends
_KEYS_OF_ROUTE = ("cycles", "reading", "seed", "replicates")
_KEYS_OF_STUDY = ("columns", "chunk_cases", "summary_by", "figure")


@dataclass(frozen=True, slots=True)
class Estimator:
    """One way to identify F_k and c in a case: rows, phase, contact, weights, and the levels that it takes.

    approach : an object of `Approach`, or a name of YARDSTICKS.   phase : reversal, zero_crossing or fundamental.
    sharing : φ and t_s individual or common; like the phase, empty for an approach that takes no phase.
    contact : COMPLIANT or RIGID.   weights : WEIGHTED or EQUAL; empty without noise, where all rows weigh alike.
    levels : positions of two levels counted from 0, None for least squares of all.   terms : of the balance, where the
    study sets them; empty for those of the approach.
    """

    approach: str
    phase: str
    sharing: str
    contact: str
    weights: str
    levels: tuple[int, int] | None
    terms: tuple[str, ...] = ()

    @property
    def identified(self) -> tuple[str, ...]:
        """Symbols of the coefficients that it identifies."""
        if self.approach in YARDSTICKS:
            return self.terms or tuple(TERMS)
        return self.terms or tuple(approach(self.approach).terms)

    @property
    def kind(self) -> str:
        """least_squares, or pair_i_j with the levels counted from 1; maximum_likelihood without a balance."""
        if self.approach == LIKELIHOOD:
            return "maximum_likelihood"
        if self.levels is None:
            return "least_squares"
        return f"pair_{self.levels[0] + 1}_{self.levels[1] + 1}"

    @property
    def label(self) -> str:
        """The end of the names of the columns of this fit, e.g. X_s__reversal__individual__least_squares.

        It names a rigid contact, equal weights of noisy records, and terms: direct__F_k+c+c_2__rigid__equal__….
        """
        return "__".join(self.parts)

    @property
    def parts(self) -> list[str]:
        """The parts of the label."""
        contact = "" if self.contact == COMPLIANT else self.contact
        weights = EQUAL if self.weights == EQUAL else ""
        parts = (self.approach, "+".join(self.terms), contact, weights, self.phase, self.sharing)
        return [part for part in (*parts, self.kind) if part]


# --- the study ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Study:
    """One parameter study.

    fixed : value of each parameter that no axis sets, by the names of PARAMETERS.   blocks : the axes.
    levels : amplitudes Y, m, or multiples of Y_m if `levels_relative`.   seed, replicates : of the noise and of the
    bootstrap of noisy records.   settings : the file as read, without the title and the figure, from which everything
    that is computed follows.   text : the template of the paragraph that says what the study shows.
    """

    name: str
    title: str
    settings: Mapping[str, Any]
    blocks: tuple[Block, ...]
    fixed: Mapping[str, float | int | str]
    levels: tuple[float, ...]
    levels_relative: bool
    fits: tuple[Estimator, ...]
    route: Route
    cycles: int
    chunk_cases: int
    reading: ReadAt = "interpolated"
    seed: int = 0
    replicates: int = 200  # of which a standard error is accurate to 5 %
    columns: Sequence[str] = ("parameters", "errors")
    summary_by: Sequence[str] = ()
    figure: Mapping[str, Any] = field(default_factory=dict)
    text: Path | None = None

    @property
    def cases(self) -> int:
        """Number of cases."""
        return math.prod(block.count for block in self.blocks)

    @cached_property
    def axis_names(self) -> tuple[str, ...]:
        """The parameters that the axes set, in the order of the file."""
        return tuple(name for block in self.blocks for name in block.axes)

    @cached_property
    def parameters(self) -> frozenset[str]:
        """Every parameter that has a value, fixed or by an axis."""
        return frozenset((*self.fixed, *self.axis_names))

    def block_of(self, axis: str) -> Block | None:
        """Return the block that sets a parameter, None where none does."""
        return next((block for block in self.blocks if axis in block.axes), None)

    def values_of(self, axis: str) -> Sequence[float | int | str]:
        """Return the listed values of an axis; none where it is sampled or there is no such axis."""
        block = self.block_of(axis)
        return block.axes[axis] if isinstance(block, Listed) else ()

    def extent(self, name: str) -> tuple[float, float]:
        """Return the least and the largest value of a parameter, whether it is fixed or an axis of numbers."""
        block = self.block_of(name)
        if isinstance(block, Sampled):
            return block.axes[name][:2]
        values = [float(x) for x in (block.axes[name] if block else [self.fixed[name]])]
        return min(values), max(values)

    @property
    def seeds(self) -> list[int]:
        """Seeds of the samples, in the order of the file, and of the noise."""
        samples = [block.seed for block in self.blocks if isinstance(block, Sampled)]
        return [*samples, self.seed] if self.route.is_noisy else samples

    def fits_of(self, spec: Mapping[str, Any]) -> list[Estimator]:
        """Return the fits that a number or a figure selects by the keys that it sets.

        lines : label → such a selection, each of one fit; none is selected where one of them selects none or several.
        contact : compliant or rigid; if it is missing, compliant, or else all.   weights : weighted or equal; if they
        are missing, weighted, or else all.
        fit : least_squares, pair_i_j, or pairs for all pairs; if it is missing, least squares, or else all.
        terms : of the balance; if they are missing, the first that the study has.
        """
        if "lines" in spec:
            lines = [self.fits_of(line) for line in spec["lines"].values()]
            return [fit for (fit,) in lines] if set(map(len, lines)) == {1} else []
        first = next((fit.terms for fit in self.fits if fit.approach != LIKELIHOOD), ())
        terms = in_order(spec["terms"]) if "terms" in spec else first
        fits = [fit for fit in self.fits if fit.terms == terms or fit.approach == LIKELIHOOD]
        usual = {"contact": COMPLIANT, "weights": WEIGHTED}
        for key in ("approach", "phase", "sharing", "contact", "weights"):
            if wanted := spec.get(key, usual.get(key)):
                those = [fit for fit in fits if getattr(fit, key) in ("", wanted)]
                fits = those if key in spec else those or fits
        if "fit" not in spec:
            return [fit for fit in fits if fit.levels is None] or fits
        kind = spec["fit"]
        return [fit for fit in fits if fit.kind == kind or (fit.levels and kind == "pairs")]

    @classmethod
    def of(
        cls,
        name: str,
        document: Mapping[str, Any],
        paper: Mapping[str, Any],
        text: Path | None = None,
    ) -> Self:
        """Return the study of a document without faults, see `reading_study.problems`.   paper : `paper_defaults`."""
        blocks, route = tuple(map(_block, document["axes"])), document.get("route", {})
        way = STUDY_ROUTES[route.get("kind", "exact")]
        given = document.get("base", {}) | {
            key: value
            for key, value in (route | document.get("read_out", {})).items()
            if key in PARAMETERS and value is not None
        }
        taken = {other for block in blocks for axis in block.axes for other in synonyms(axis)}
        fixed = {key: value for key, value in given.items() if key not in taken}
        taken |= {other for key in fixed for other in synonyms(key)}
        fixed |= {key: value for key, value in paper["base"].items() if key not in taken}
        levels = document.get("levels_of_Y", document.get("levels_m", paper["levels_m"]))
        stated: dict[str, Any] = {"cycles": way.cycles, "chunk_cases": way.chunk_cases}
        for section, keys in ((route, _KEYS_OF_ROUTE), (document, _KEYS_OF_STUDY)):
            stated |= {key: section[key] for key in keys if section.get(key)}
        return cls(
            name=name,
            title=document["title"],
            settings={key: value for key, value in document.items() if key not in _KEYS_SHOWN},
            blocks=blocks,
            fixed=fixed,
            levels=tuple(levels),
            levels_relative="levels_of_Y" in document,
            fits=tuple(_fits(document.get("estimation", {}), way)),
            route=way,
            text=text,
            **stated,
        )


PAPER_CASE: Mapping[str, Any] = {
    "base": {name: p.default for name, p in PARAMETERS.items() if p.default is not None},
    "levels_m": read_schema(STUDY_SCHEMA)["properties"]["levels_m"]["default"],
}
"""`paper_defaults` of the paper's case, where there is no configuration to read."""


def paper_defaults(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return the paper's values of the parameters and levels that a study leaves out: {base: …, levels_m: …}."""
    frequencies, levels = config["excitation"]["frequencies"], config["excitation"]["levels_m"]
    base = {**config["oscillator"], "frequency_hz": frequencies[0]["hz"], "Y_m": levels[0]}
    return {"base": base, "levels_m": levels}


def _fits(estimation: Mapping[str, Any], way: Route) -> Iterator[Estimator]:
    kinds = estimation.get("fits", ["least_squares"])
    levels = [None if kind == "least_squares" else (kind[0] - 1, kind[1] - 1) for kind in kinds]
    of_phase = estimation.get("phases", ["reversal"]), estimation.get("sharing", ["individual"])
    contacts = estimation.get("contact", [COMPLIANT])
    weights = estimation.get("weights", [WEIGHTED]) if way.is_noisy else [""]
    terms = list(dict.fromkeys(map(in_order, estimation.get("terms", [()]))))
    for chosen in map(approach, estimation.get("approaches", APPROACHES)):
        choices = of_phase if chosen.takes_phase else ([""], [""])
        for choice in product(*choices, contacts, weights, levels, terms):
            yield Estimator(chosen, *choice)
    of_yardsticks = {SIMPSON: (RIGID, EQUAL), LIKELIHOOD: (COMPLIANT, "")}
    for name in estimation.get("yardsticks", []):
        if name == CONTACT:
            yield Estimator(LIKELIHOOD, "", "", *of_yardsticks[LIKELIHOOD], None, (*TERMS, CONTACT))
        else:
            yield Estimator(name, "", "", *of_yardsticks[name], None)
