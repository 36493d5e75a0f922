"""A study as its YAML file describes it, checked before anything runs."""

from __future__ import annotations

import string
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from ..balance import APPROACHES, takes_phase
from ..project.documents import (
    ConfigurationError,
    Key,
    Problem,
    against_schema,
    in_lines,
    read_yaml,
)
from .axes import SOBOL_BITS, Block, Listed, Range, Sampled, number_of_cases, spread
from .parameters import MECHANICAL, PARAMETERS, objection, rivals
from .routes import REPLICATES, ROUTES, route_problems

SPREADS = ("bias", "rms", "standard_error", "coverage")
"""Facts that a whole set of runs tells, by one fit: see `groups.Spread`."""


@dataclass(frozen=True, slots=True)
class Fit:
    """One way to identify F_k and c in a case: which rows, with which phase, and which of the levels.

    phase : reversal, zero_crossing or fundamental.   sharing : φ and t_s individual or common.   Both are empty for
    an approach that knows no phase.   levels : positions of two levels counted from 0, None for least squares of all.
    """

    approach: str
    phase: str
    sharing: str
    levels: tuple[int, int] | None

    @property
    def kind(self) -> str:
        """least_squares, or pair_i_j with the levels counted from 1."""
        if self.levels is None:
            return "least_squares"
        return f"pair_{self.levels[0] + 1}_{self.levels[1] + 1}"

    @property
    def label(self) -> str:
        """How the columns of this fit are told apart, e.g. X_s__reversal__individual__least_squares."""
        return "__".join(
            part for part in (self.approach, self.phase, self.sharing, self.kind) if part
        )


@dataclass(frozen=True)
class Study:
    """One parameter study.

    fixed : value of each parameter that no axis sets, by the names of PARAMETERS.   blocks : the axes.
    levels : amplitudes Y, m, or multiples of Y_m if `levels_relative`.   seed, replicates : of the noise and of the
    bootstrap, where the route is `measured`.   settings : the file as read, without the
    text and the figure, from which everything that is computed follows.
    """

    name: str
    title: str
    settings: Mapping[str, Any]
    blocks: tuple[Block, ...]
    fixed: Mapping[str, float | int | str]
    levels: tuple[float, ...]
    levels_relative: bool
    fits: tuple[Fit, ...]
    route: str
    cycles: int
    reading: str
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
        return number_of_cases(self.blocks)

    @cached_property
    def axis_names(self) -> tuple[str, ...]:
        """The parameters that the axes set, in the order of the file."""
        return tuple(name for block in self.blocks for name in block.names)

    @property
    def seeds(self) -> list[int]:
        """Seeds of the samples, in the order of the file, and of the noise."""
        samples = [block.seed for block in self.blocks if isinstance(block, Sampled)]
        return [*samples, self.seed] if self.route == "measured" else samples

    @classmethod
    def of(cls, name: str, document: Mapping[str, Any], paper: Mapping[str, Any]) -> Self:
        """The study of a document that `problems` finds nothing wrong with; `paper` as in `read_study`."""
        blocks = tuple(_block(item) for item in document["axes"])
        route = {"kind": "exact", "reading": "interpolated"} | document.get("route", {})
        kind = route["kind"]
        estimation = document.get("estimation", {})
        on_axes = {axis for block in blocks for axis in block.names}
        given = document.get("base", {}) | {
            key: value
            for key, value in (route | document.get("read_out", {})).items()
            if key in PARAMETERS and value is not None
        }
        taken = {other for axis in on_axes for other in (axis, *rivals(axis))}
        fixed = {key: value for key, value in given.items() if key not in taken}
        taken |= {other for key in fixed for other in (key, *rivals(key))}
        fixed |= {key: value for key, value in paper["base"].items() if key not in taken}
        relative = "levels_of_Y" in document
        return cls(
            name=name,
            title=document["title"],
            settings={
                key: value
                for key, value in document.items()
                if key not in ("title", "figure", "facts", "shows", "summary_by")
            },
            blocks=blocks,
            fixed=fixed,
            levels=tuple(
                document["levels_of_Y"] if relative else document.get("levels_m", paper["levels_m"])
            ),
            levels_relative=relative,
            fits=tuple(_fits(estimation)),
            route=kind,
            cycles=route.get("cycles", ROUTES[kind].cycles),
            reading=route["reading"],
            seed=route.get("seed", 0),
            replicates=route.get("replicates", REPLICATES),
            columns=tuple(document.get("columns", ["parameters", "errors"])),
            chunk_cases=document.get("chunk_cases", ROUTES[kind].chunk_cases),
            summary_by=tuple(document.get("summary_by", [])),
            figure=document.get("figure", {}),
            facts=document.get("facts", {}),
            shows=document.get("shows", "").strip(),
        )


def read_study(path: str | Path, schema_file: str | Path, paper_file: str | Path) -> Study:
    """The study of a YAML file, named after the file.

    paper_file : the configuration of the paper's case, whose oscillator, first frequency and levels stand for what the
    study leaves out.

    Raises ConfigurationError listing every problem, a line each: file, key, what is wrong, what would be right.
    """
    path = Path(path)
    document = read_yaml(path)
    paper = paper_defaults(read_yaml(paper_file))
    found = list(problems(document, read_yaml(schema_file), paper))
    if found:
        raise ConfigurationError(in_lines(found, {str(path): document}))
    return Study.of(path.stem, document, paper)


def paper_defaults(config: Mapping[str, Any]) -> dict[str, Any]:
    """What stands for parameters and levels that a study leaves out: {base: …, levels_m: …}."""
    excitation = config["excitation"]
    base = dict(config["oscillator"])
    base |= {
        "frequency_hz": excitation["frequencies"][0]["hz"],
        "Y_m": excitation["levels_m"][0],
    }
    return {"base": base, "levels_m": excitation["levels_m"]}


def problems(
    document: Any, schema: Mapping[str, Any], paper: Mapping[str, Any]
) -> Iterator[Problem]:
    """Everything that is wrong with a study's document, (key, text) each; nothing if it can be run."""
    found = against_schema(document, schema)
    if not found:
        found = [*_wrong_axes(document["axes"]), *_wrong_values(document)]
    if not found:
        found = list(_contradictions(document, paper))
    if not found:
        found = list(_wrong_words(Study.of("", document, paper)))
    yield from found


def _wrong_axes(axes: Sequence[Mapping[str, Any]]) -> Iterator[Problem]:
    seen: dict[str, str] = {}
    for i, block in enumerate(axes):
        key: Key = ("axes", i)
        names = list(block)
        if "sample" in block:
            if len(block) > 1:
                yield key, "a sample stands in a block of its own; begin another with '-'"
                continue
            names = list(block["sample"]["over"])
            if block["sample"]["method"] == "sobol" and block["sample"]["count"] > 2**SOBOL_BITS:
                yield (
                    (*key, "sample", "count"),
                    f"a Sobol sequence has {2**SOBOL_BITS:,} points at most; take fewer, or method: random",
                )
            for name in names:
                place = (*key, "sample", "over", name)
                if PARAMETERS[name].kind not in ("oscillator", "excitation"):
                    yield place, "cannot be sampled: list its values in a block of their own"
                yield from _wrong_range(place, name, block["sample"]["over"][name])
        else:
            sizes = {}
            for name, spec in block.items():
                place = (*key, name)
                if "values" in spec and len(spec) > 1:
                    yield place, "give either values, or from, to and count"
                elif "values" in spec:
                    sizes[name] = len(spec["values"])
                    for value in spec["values"]:
                        if (wrong := objection(name, value)) is not None:
                            yield place, wrong
                elif not {"from", "to", "count"} <= set(spec):
                    yield place, "give values: […], or from, to and count (and spacing: log)"
                else:
                    sizes[name] = spec["count"]
                    yield from _wrong_range(place, name, spec)
                    if PARAMETERS[name].unit == "":
                        yield place, "a word has no range; list the values"
            if len(set(sizes.values())) > 1:
                text = ", ".join(f"{name} has {size}" for name, size in sizes.items())
                yield key, f"paired axes need as many values each: {text}"
        for name in names:
            for other in (name, *rivals(name)):
                if other in seen:
                    reason = "twice" if other == name else f"beside {other}, which it stands for"
                    yield key, f"{name} is set {reason}; keep one"
            seen[name] = name


def _wrong_range(key: Key, name: str, spec: Mapping[str, Any]) -> Iterator[Problem]:
    for end in ("from", "to"):
        if (wrong := objection(name, spec[end])) is not None:
            yield (*key, end), wrong
    if spec["from"] >= spec["to"]:
        yield key, f"from must lie below to, got {spec['from']!r} and {spec['to']!r}"
    if spec.get("spacing") == "log" and spec["from"] <= 0.0:
        yield (*key, "from"), "a logarithmic range begins above zero"


def _wrong_values(document: Mapping[str, Any]) -> Iterator[Problem]:
    for section in ("base", "route", "read_out"):
        for name, value in document.get(section, {}).items():
            if name in PARAMETERS and value is not None:
                wrong = objection(name, value)
                if wrong is not None:
                    yield (section, name), wrong
    base = document.get("base", {})
    for name in base:
        for other in rivals(name):
            if other in base and other > name:
                yield ("base", name), f"not together with {other}; keep one"


def _contradictions(document: Mapping[str, Any], paper: Mapping[str, Any]) -> Iterator[Problem]:
    study = Study.of("", document, paper)
    route, used = document.get("route", {}), {*study.fixed, *study.axis_names}
    if "levels_m" in document and study.levels_relative:
        yield ("levels_m",), "not together with levels_of_Y; keep one"
    given = {*document.get("base", {}), *study.axis_names}
    if not study.levels_relative and given & {"Y_m", "F_k_over_kY"}:
        yield (
            ("levels_m",) if "levels_m" in document else ("axes",),
            "with Y_m or F_k_over_kY give the levels as multiples of Y_m: levels_of_Y: [1, 2, 3]",
        )
    yield from route_problems(route, used, study.columns)
    if {"X_s_mark_m", "X_s_decimals"} <= used:
        yield ("read_out",), "X_s_mark_m and X_s_decimals say the same; keep one"
    for i, fit in enumerate(document.get("estimation", {}).get("fits", [])):
        if fit != "least_squares" and max(fit) > len(study.levels):
            yield ("estimation", "fits", i), f"there are only {len(study.levels)} levels"


def _wrong_words(study: Study) -> Iterator[Problem]:
    """What the figure, the facts and the text speak of must be there."""
    for i, axis in enumerate(study.summary_by):
        if axis not in study.axis_names:
            yield ("summary_by", i), f"{axis!r} is not an axis of this study"
    for part in ("x", "y", "panels"):
        name = study.figure.get(part, "phase")
        if name not in (*study.axis_names, "phase"):
            yield ("figure", part), f"{name!r} is not an axis of this study"
    if study.figure.get("kind") == "map" and "y" not in study.figure:
        yield ("figure", "y"), "missing; a map has two axes, x and y"
    listed = [name for b in study.blocks if isinstance(b, Listed) for name in b.names]
    for fact, spec in study.facts.items():
        for where in ("at", "between"):
            for name in spec.get(where, {}):
                if name not in study.axis_names:
                    yield ("facts", fact, where, name), "not an axis of this study"
        meant = chosen(study.fits, {"fit": "least_squares"} | dict(spec)) or chosen(
            study.fits, spec
        )
        if not meant:
            yield ("facts", fact), "no fit of this study is meant: see estimation"
        if spec["take"] in SPREADS and len(meant) > 1:
            text = ", ".join(fit.label for fit in meant)
            yield ("facts", fact), f"{spec['take']} is that of one fit, and {text} are meant"
        if spec["take"] in ("standard_error", "coverage") and "intervals" not in study.columns:
            yield (
                ("facts", fact, "take"),
                "needs the columns of intervals: columns: [errors, intervals]",
            )
        if spec["take"] == "band" and spec.get("along") not in listed:
            yield ("facts", fact, "along"), "must be an axis of this study whose values are listed"
    for _, name, _, _ in string.Formatter().parse(study.shows):
        if name is not None and name not in (*study.facts, "cases"):
            yield ("shows",), f"{{{name}}} is not among the facts: {', '.join(study.facts)}"


def chosen(fits: Iterable[Fit], spec: Mapping[str, Any]) -> list[Fit]:
    """The fits that a fact or a figure speaks of: approach, phase, sharing, fit, as far as they are given.

    fit : least_squares, pair_i_j, or pairs for all pairs.
    """

    def meant(fit: Fit) -> bool:
        if spec.get("approach", fit.approach) != fit.approach:
            return False
        if fit.phase and spec.get("phase", fit.phase) != fit.phase:
            return False
        if fit.sharing and spec.get("sharing", fit.sharing) != fit.sharing:
            return False
        kind = spec.get("fit", fit.kind)
        return kind == fit.kind or (kind == "pairs" and fit.levels is not None)

    return [fit for fit in fits if meant(fit)]


def _block(item: Mapping[str, Any]) -> Block:
    if "sample" in item:
        sample = item["sample"]
        ranges = {
            name: Range(float(spec["from"]), float(spec["to"]), spec.get("spacing", "linear"))
            for name, spec in sample["over"].items()
        }
        return Sampled(sample["method"], sample["count"], sample["seed"], ranges)
    values = {
        name: spec["values"]
        if "values" in spec
        else spread(spec["from"], spec["to"], spec["count"], spec.get("spacing", "linear"))
        for name, spec in item.items()
    }
    return Listed(values)


def _fits(estimation: Mapping[str, Any]) -> Iterator[Fit]:
    chosen_levels = [
        None if fit == "least_squares" else (fit[0] - 1, fit[1] - 1)
        for fit in estimation.get("fits", ["least_squares"])
    ]
    for approach in estimation.get("approaches", APPROACHES):
        phases, sharings = (
            estimation.get("phases", ["reversal"]),
            estimation.get("sharing", ["individual"]),
        )
        if not takes_phase(approach):
            phases, sharings = [""], [""]
        for phase in phases:
            for sharing in sharings:
                for levels in chosen_levels:
                    yield Fit(approach, phase, sharing, levels)


__all__ = [
    "MECHANICAL",
    "Fit",
    "Study",
    "chosen",
    "paper_defaults",
    "problems",
    "read_study",
]
