"""What can be wrong with the YAML file of a study, found before anything runs."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ..balance import APPROACHES
from ..law.law import Law
from ..project.documents import (
    ConfigurationError,
    Key,
    Problem,
    against_schema,
    in_lines,
    read_schema,
    read_yaml,
)
from .axes import SOBOL_BITS, Listed, spread
from .parameters import MECHANICAL, OF_LAW, PARAMETERS, objection, synonyms
from .references import wrong_references
from .routes import LAWS, ROUTES, terms_named
from .settings import Study, paper_defaults
from .sizes import wrong_sizes


def read_study(path: str | Path, schema_file: str | Path, paper_file: str | Path) -> Study:
    """The study of a YAML file, named after the file.

    paper_file : the configuration of the paper's case, whose oscillator, first frequency and levels stand for what the
    study leaves out.

    Raises ConfigurationError listing every problem, a line each: file, key, what is wrong, what would be right.
    """
    path = Path(path)
    document = read_yaml(path)
    paper = paper_defaults(read_yaml(paper_file))
    wrong = problems(document, read_schema(schema_file), paper)
    if wrong:
        raise ConfigurationError(in_lines(wrong, {str(path): document}))
    return Study.of(path.stem, document, paper)


def problems(
    document: Any, schema: Mapping[str, Any], paper: Mapping[str, Any]
) -> Sequence[Problem]:
    """Everything that is wrong with a study's document, (key, text) each; nothing if it can be run."""
    return (
        against_schema(document, schema, APPROACHES)
        or [*_wrong_axes(document["axes"]), *_wrong_values(document)]
        or list(_contradictions(document, Study.of("", document, paper)))
        or list(wrong_sizes(Study.of("", document, paper)))
        or list(wrong_references(Study.of("", document, paper)))
    )


def _wrong_axes(axes: Sequence[Mapping[str, Any]]) -> Iterator[Problem]:
    seen: set[str] = set()
    for i, block in enumerate(axes):
        key: Key = ("axes", i)
        if "sample" in block and len(block) > 1:
            yield key, "a sample stands in a block of its own; begin another with '-'"
            continue
        yield from _wrong_sample(key, **block) if "sample" in block else _wrong_lists(key, block)
        names = list(block["sample"]["over"] if "sample" in block else block)
        for name in names:
            for other in synonyms(name):
                if other in seen:
                    reason = "twice" if other == name else f"beside {other}, which it stands for"
                    yield key, f"{name} is set {reason}; keep one"
            seen.add(name)


def _wrong_sample(key: Key, sample: Mapping[str, Any]) -> Iterator[Problem]:
    if sample["method"] == "sobol" and sample["count"] > 2**SOBOL_BITS:
        points = f"{2**SOBOL_BITS:,} points"
        text = f"a Sobol sequence has {points} at most; take fewer, or method: random"
        yield (*key, "sample", "count"), text
    for name, limits in sample["over"].items():
        place = (*key, "sample", "over", name)
        if name not in MECHANICAL:
            yield place, "cannot be sampled: list its values in a block of their own"
        yield from _wrong_range(place, name, limits)


def _wrong_lists(key: Key, block: Mapping[str, Any]) -> Iterator[Problem]:
    sizes = {}
    for name, spec in block.items():
        place = (*key, name)
        if "values" in spec and len(spec) > 1:
            yield place, "give either values, or from, to and count (and also)"
        elif "values" in spec:
            sizes[name] = len(spec["values"])
            objections = (objection(name, value) for value in spec["values"])
            yield from ((place, wrong) for wrong in objections if wrong)
        elif not {"from", "to", "count"} <= set(spec):
            yield place, "give values: […], or from, to and count (and spacing: log)"
        else:
            sizes[name] = spec["count"]
            wrong = list(_wrong_range(place, name, spec))
            yield from wrong or _wrong_spread(place, name, spec)
            further = spec.get("also", ())
            objections = (objection(name, value) for value in further)
            yield from (((*place, "also"), wrong) for wrong in objections if wrong)
            if further and len(block) > 1:
                yield (
                    (*place, "also"),
                    "cannot be paired with another axis; list the values of both",
                )
    if len(set(sizes.values())) > 1:
        text = ", ".join(f"{name} has {size}" for name, size in sizes.items())
        yield key, f"paired axes need as many values each: {text}"


def _wrong_spread(key: Key, name: str, spec: Mapping[str, Any]) -> Iterator[Problem]:
    values = spread(spec["from"], spec["to"], spec["count"], spec.get("spacing", "linear"))
    if len(set(values)) < len(values):
        yield key, f"{len(values):,} values do not fit between its ends; take fewer"
    elif PARAMETERS[name].whole and any(value != int(value) for value in values):
        yield key, f"{PARAMETERS[name].meaning} must be whole numbers; list the values"


def _wrong_range(key: Key, name: str, spec: Mapping[str, Any]) -> Iterator[Problem]:
    if PARAMETERS[name].unit == "":
        yield key, "a word has no range; list the values"
        return
    for end in ("from", "to"):
        if wrong := objection(name, spec[end]):
            yield (*key, end), wrong
    if spec["from"] >= spec["to"]:
        yield key, f"from must lie below to, got {spec['from']!r} and {spec['to']!r}"
    if spec.get("spacing") == "log" and spec["from"] <= 0.0:
        yield (*key, "from"), "a logarithmic range begins above zero"


def _wrong_values(document: Mapping[str, Any]) -> Iterator[Problem]:
    for section in ("base", "route", "read_out"):
        for name, value in document.get(section, {}).items():
            if name in PARAMETERS and value is not None and (wrong := objection(name, value)):
                yield (section, name), wrong
    base = document.get("base", {})
    for name in base:
        for other in synonyms(name):
            if other in base and other > name:
                yield ("base", name), f"not together with {other}; keep one"


def _contradictions(document: Mapping[str, Any], study: Study) -> Iterator[Problem]:
    used = {*study.fixed, *study.axis_names}
    if "levels_m" in document and study.levels_relative:
        yield ("levels_m",), "not together with levels_of_Y; keep one"
    given = {*document.get("base", {}), *study.axis_names}
    if not study.levels_relative and given & {"Y_m", "F_k_over_kY"}:
        text = "with Y_m or F_k_over_kY give the levels as multiples of Y_m: levels_of_Y: [1, 2, 3]"
        yield ("levels_m" if "levels_m" in document else "axes",), text
    yield from _wrong_route(document.get("route", {}), used, study.columns)
    if {"X_s_mark_m", "X_s_decimals"} <= used:
        yield ("read_out",), "X_s_mark_m and X_s_decimals say the same; keep one"
    if study.route == LAWS:
        yield from _wrong_for_laws(document, study)
    yield from _wrong_terms(document.get("estimation", {}), study)
    for i, fit in enumerate(document.get("estimation", {}).get("fits", [])):
        if fit != "least_squares" and max(fit) > len(study.levels):
            yield ("estimation", "fits", i), f"there are only {len(study.levels)} levels"
    if "weights" in document.get("estimation", {}) and study.route != "measured":
        text = f"means nothing to the route {study.route}: without noise all rows weigh alike"
        yield ("estimation", "weights"), text


def _wrong_terms(estimation: Mapping[str, Any], study: Study) -> Iterator[Problem]:
    """What is wrong with the terms of the balance, and with those of the oscillator's law."""
    if study.route != "exact":
        for name in OF_LAW:
            if name in (*study.fixed, *study.axis_names) and study.route != LAWS:
                yield ("route",), f"{name} needs the route exact, not {study.route}"
        if "terms" in estimation:
            yield ("estimation", "terms"), f"needs the route exact, not {study.route}"
    for i, terms in enumerate(estimation.get("terms", [])):
        key: Key = ("estimation", "terms", i)
        try:
            law = Law(tuple(terms))
            law.require([1.0] * len(study.levels))  # a case has one frequency
        except ValueError as error:
            yield key, str(error)
            continue
        if len(terms) > 2 and any(fit.levels for fit in study.fits):
            yield (
                key,
                f"a pair of levels tells two terms apart, not {len(terms)}: take fits: [least_squares]",
            )


def _wrong_for_laws(document: Mapping[str, Any], study: Study) -> Iterator[Problem]:
    """What does not fit the route that draws oscillators of its own, and asks for their law."""
    if not study.levels_relative:
        yield ("levels_of_Y",), "missing; the levels of the route laws, in parts of the highest"
    for key in ("base", "estimation", "columns", "summary_by"):
        if key in document:
            yield (key,), "means nothing to the route laws, which draws oscillators; leave it out"
    for name in study.axis_names:
        if name not in ROUTES[LAWS].parameters:
            yield ("axes",), f"{name} means nothing to the route laws, which draws oscillators"
    for block in study.blocks:
        for law in block.values.get("law", ()) if isinstance(block, Listed) else ():
            try:
                terms_named(str(law))
            except ValueError as error:
                yield ("axes",), str(error)


def _wrong_route(
    route: Mapping[str, Any], used: Collection[str], columns: Collection[str]
) -> Iterator[Problem]:
    """What does not fit the route: parameters and settings that are missing, or that mean nothing to it.

    route : that section of the file.   used : every parameter of the study.   columns : kinds of columns asked for.
    """
    kind = route.get("kind", "exact")
    wanted = ROUTES[kind]
    for names in wanted.numerics:
        if not set(used) & set(names):
            yield ("route",), f"{kind} needs {' or '.join(names)}, here or as an axis"
        elif set(names) <= set(used) and len(names) > 1:
            yield ("route",), f"{' and '.join(names)} say the same; keep one"
    for name in sorted(used):
        if PARAMETERS[name].kind == "numerics" and name not in wanted.parameters:
            yield ("route",), f"{name} means nothing to the route {kind}"
        if PARAMETERS[name].kind == "read_out" and "seed" in wanted.settings:
            yield ("read_out", name), f"means nothing to the route {kind}: noise is its limit"
    settings = {key for each in ROUTES.values() for key in each.settings}
    for name in route:
        if name in settings and name not in wanted.settings:
            yield ("route", name), f"means nothing to the route {kind}; leave it out"
    if "seed" in wanted.settings and "seed" not in route:
        yield ("route", "seed"), "missing; the seed of the noise, an integer of at least 0"
    if "intervals" in columns and kind != "measured":
        yield ("columns",), "intervals are those of noisy records: they need the route measured"
