"""A study as its YAML file describes it; `checking` finds what is wrong with the file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any, Self

import numpy as np

from ..arrays import Array
from ..balance import APPROACHES, TERMS, takes_phase
from ..law.terms import in_order
from ..reading.clean import ReadAt
from .axes import Block, Listed, Range, Sampled, spread
from .parameters import PARAMETERS, synonyms
from .routes import REPLICATES, ROUTES, Route

COMPLIANT, RIGID = "compliant", "rigid"
"""Models of the contact: with the slip onset as it was read, or without one (`Features.rigid`)."""

WEIGHTED, EQUAL = "weighted", "equal"
"""Weights of the rows of noisy records: by inverse variance, or all alike, as in Eq. (9)."""

SIMPSON, LIKELIHOOD = "simpson", "fit"
YARDSTICKS = (SIMPSON, LIKELIHOOD)
"""What approaches are compared with on noisy records: plain direct integration (`reading.simpson`), which takes a
rigid contact and equal weights, and the maximum-likelihood oscillator, which needs no balance."""

OF_INTERVALS = ("standard_error", "coverage", "coverage_low", "coverage_high")
SPREADS = ("bias", "rms", "p95_error", *OF_INTERVALS)
"""Facts about a set of runs, each by one fit: see `groups.Spread`."""

CHOICES = ("right", "right_low", "right_high", "extra", "extra_low", "extra_high", "none")
"""Facts about the laws that are chosen: see `confusion.choices_of`."""

BANDS = ("band", "from")
"""Facts about a stretch of an axis: both its ends, or the lower one."""


_SHOWN = ("title", "figure", "facts", "shows", "summary_by")  # keys on which no number depends


@dataclass(frozen=True, slots=True)
class Fit:
    """One way to identify F_k and c in a case: rows, phase, contact, weights, and the levels that it takes.

    approach : a name in `balance.APPROACHES`, or one of YARDSTICKS.   phase : reversal, zero_crossing or fundamental.
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
            return tuple(TERMS)
        return self.terms or APPROACHES[self.approach].terms

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
        """How the names of the columns of this fit end, e.g. X_s__reversal__individual__least_squares; a rigid contact,
        equal weights of noisy records and terms are named: direct__F_k+c+c_2__rigid__equal__least_squares."""
        contact = "" if self.contact == COMPLIANT else self.contact
        weights = EQUAL if self.weights == EQUAL else ""
        parts = (self.approach, "+".join(self.terms), contact, weights, self.phase, self.sharing)
        return "__".join(part for part in (*parts, self.kind) if part)


@dataclass(frozen=True)
class Study:
    """One parameter study.

    fixed : value of each parameter that no axis sets, by the names of PARAMETERS.   blocks : the axes.
    levels : amplitudes Y, m, or multiples of Y_m if `levels_relative`.   seed, replicates : of the noise and of the
    bootstrap of noisy records.   settings : the file as read, without the text and the figure, from which everything
    that is computed follows.
    """

    name: str
    title: str
    settings: Mapping[str, Any]
    blocks: tuple[Block, ...]
    fixed: Mapping[str, float | int | str]
    levels: tuple[float, ...]
    levels_relative: bool
    fits: tuple[Fit, ...]
    route: Route
    cycles: int
    reading: ReadAt
    seed: int
    replicates: int
    columns: tuple[str, ...]
    chunk_cases: int
    summary_by: tuple[str, ...]
    figure: Mapping[str, Any]
    facts: Mapping[str, Mapping[str, Any]]
    shows: str

    @property
    def cases(self) -> int:
        """Number of cases."""
        return math.prod(block.count for block in self.blocks)

    @cached_property
    def axis_names(self) -> tuple[str, ...]:
        """The parameters that the axes set, in the order of the file."""
        return tuple(name for block in self.blocks for name in block.names)

    @cached_property
    def parameters(self) -> frozenset[str]:
        """Every parameter that has a value, fixed or by an axis."""
        return frozenset((*self.fixed, *self.axis_names))

    def block_of(self, axis: str) -> Block | None:
        """The block that sets a parameter, None where none does."""
        return next((block for block in self.blocks if axis in block.names), None)

    def values_of(self, axis: str) -> Sequence[float | int | str]:
        """The listed values of an axis; none where it is sampled or there is no such axis."""
        block = self.block_of(axis)
        return block.values[axis] if isinstance(block, Listed) else ()

    def extent(self, name: str) -> tuple[float, float]:
        """The least and the largest value of a parameter, whether it is fixed or an axis of numbers."""
        block = self.block_of(name)
        if isinstance(block, Sampled):
            return block.ranges[name].low, block.ranges[name].high
        values = [float(x) for x in (block.values[name] if block else [self.fixed[name]])]
        return min(values), max(values)

    def amplitudes(self, Y: Array) -> Array:
        """Amplitudes of the base at the levels, m, (L, n), of cases with the reference amplitudes Y, m, (n,)."""
        return np.array(self.levels)[:, None] * (Y if self.levels_relative else np.ones_like(Y))

    @property
    def seeds(self) -> list[int]:
        """Seeds of the samples, in the order of the file, and of the noise."""
        samples = [block.seed for block in self.blocks if isinstance(block, Sampled)]
        return [*samples, self.seed] if self.route.is_noisy else samples

    def fits_of(self, spec: Mapping[str, Any]) -> list[Fit]:
        """The fits that a fact or a figure selects by the keys that it sets.

        lines : label → such a selection, each of one fit; none is selected where one of them selects none or several.
        contact : compliant or rigid; if it is missing, compliant, or else all.   weights : weighted or equal; if they
        are missing, weighted, or else all.
        fit : least_squares, pair_i_j, or pairs for all pairs; if it is missing, least squares, or else all.
        terms : of the balance; if they are missing, the first that the study has.
        """
        if "lines" in spec:
            lines = [self.fits_of(line) for line in spec["lines"].values()]
            return [fit for (fit,) in lines] if set(map(len, lines)) == {1} else []
        terms = (
            in_order(spec["terms"]) if "terms" in spec else next((f.terms for f in self.fits), ())
        )
        fits = [fit for fit in self.fits if fit.terms == terms]
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
    def of(cls, name: str, document: Mapping[str, Any], paper: Mapping[str, Any]) -> Self:
        """The study of a document in which `checking.problems` finds nothing wrong; paper : see `paper_defaults`."""
        blocks = tuple(map(_block, document["axes"]))
        route = {"kind": "exact", "reading": "interpolated"} | document.get("route", {})
        way = ROUTES[route["kind"]]
        estimation = document.get("estimation", {})
        given = document.get("base", {}) | {
            key: value
            for key, value in (route | document.get("read_out", {})).items()
            if key in PARAMETERS and value is not None
        }
        taken = {other for block in blocks for axis in block.names for other in synonyms(axis)}
        fixed = {key: value for key, value in given.items() if key not in taken}
        taken |= {other for key in fixed for other in synonyms(key)}
        fixed |= {key: value for key, value in paper["base"].items() if key not in taken}
        levels = document.get("levels_of_Y", document.get("levels_m", paper["levels_m"]))
        return cls(
            name=name,
            title=document["title"],
            settings={key: value for key, value in document.items() if key not in _SHOWN},
            blocks=blocks,
            fixed=fixed,
            levels=tuple(levels),
            levels_relative="levels_of_Y" in document,
            fits=tuple(_fits(estimation, way)),
            route=way,
            cycles=route.get("cycles", way.cycles),
            reading=route["reading"],
            seed=route.get("seed", 0),
            replicates=route.get("replicates", REPLICATES),
            columns=tuple(document.get("columns", way.columns)),
            chunk_cases=document.get("chunk_cases", way.chunk_cases),
            summary_by=tuple(document.get("summary_by", [])),
            figure=document.get("figure") or {},
            facts=document.get("facts", {}),
            shows=document.get("shows", "").strip(),
        )


PAPER: Mapping[str, Any] = {
    "base": {
        "m_kg": 2.42,
        "c_N_s_per_m": 90.0,
        "k_N_per_m": 2310.0,
        "K_z_N_per_m": 208000.0,
        "F_k_N": 1.28,
        "frequency_hz": 4.92,
        "Y_m": 0.004,
    },
    "levels_m": [0.004, 0.006, 0.008, 0.010, 0.012],
}
"""`paper_defaults` of the paper's case, where there is no configuration to read."""


def paper_defaults(config: Mapping[str, Any]) -> dict[str, Any]:
    """The paper's values of the parameters and levels that a study leaves out: {base: …, levels_m: …}."""
    frequencies, levels = config["excitation"]["frequencies"], config["excitation"]["levels_m"]
    base = {**config["oscillator"], "frequency_hz": frequencies[0]["hz"], "Y_m": levels[0]}
    return {"base": base, "levels_m": levels}


def _block(item: Mapping[str, Any]) -> Block:
    if "sample" in item:
        sample = item["sample"]
        ranges = {
            name: Range(float(spec["from"]), float(spec["to"]), spec.get("spacing", "linear"))
            for name, spec in sample["over"].items()
        }
        return Sampled(sample["method"], sample["count"], sample["seed"], ranges)
    return Listed({name: spec.get("values") or spread(spec) for name, spec in item.items()})


def _fits(estimation: Mapping[str, Any], way: Route) -> Iterator[Fit]:
    kinds = estimation.get("fits", ["least_squares"])
    levels = [None if kind == "least_squares" else (kind[0] - 1, kind[1] - 1) for kind in kinds]
    phases, sharings = (
        estimation.get("phases", ["reversal"]),
        estimation.get("sharing", ["individual"]),
    )
    contacts = estimation.get("contact", [COMPLIANT])
    weights = estimation.get("weights", [WEIGHTED]) if way.has_intervals else [""]
    terms = list(dict.fromkeys(map(in_order, estimation.get("terms", [()]))))
    for approach in estimation.get("approaches", way.approaches):
        choices = (phases, sharings) if takes_phase(approach) else ([""], [""])
        for choice in product(*choices, contacts, weights, levels, terms):
            yield Fit(approach, *choice)
    of_yardsticks = {SIMPSON: (RIGID, EQUAL), LIKELIHOOD: (COMPLIANT, "")}
    for name in estimation.get("yardsticks", []):
        yield Fit(name, "", "", *of_yardsticks[name], None)
