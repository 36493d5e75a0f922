"""The exact and the as-published route of `config/config.yaml`, computed in memory, for any oscillator."""

from __future__ import annotations

import shutil
from dataclasses import replace
from decimal import Decimal
from functools import lru_cache
from pathlib import Path

import pandas as pd
import yaml

from dampbalance.estimates import estimate_table
from dampbalance.features import Features, of_orbit, stack
from dampbalance.model import Oscillator
from dampbalance.motion.orbit import steady_orbit
from dampbalance.project.case import Case
from dampbalance.replication import authors_route as authors
from dampbalance.replication.claims.judging import Claim
from dampbalance.replication.claims.print import Published, Row, read_published
from dampbalance.replication.claims.rules import Sources
from dampbalance.replication.claims.table import claims_table
from dampbalance.replication.claims.verdicts import ROUTE_NAMES
from dampbalance.replication.comparison import approaches_table
from dampbalance.replication.rebuilt_tables import RouteTables
from dampbalance.studies import case_files, evaluate
from dampbalance.studies.reading_study import read_study
from dampbalance.studies.study_file import Study
from folders import PUBLISHED, ROOT

PRINT = read_published(PUBLISHED)
CONFIG = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
CASE = Case.from_config(CONFIG)
PAPER = CASE.oscillator


def claim(printed: str = "1.28", **parts) -> Claim:
    """A claim on some number. parts : values by route (exact, as_published, from_print) and fields of Claim."""
    values = {route: parts.pop(route) for route in ROUTE_NAMES if route in parts}
    row = Row("id", "where", "F_k", "", "quantity", "N", printed, "computed", "")
    return Claim(row, values, **parts)


def with_digits_of(text: str, value: float) -> Decimal:
    """The value rounded to as many decimals as the text has."""
    return Decimal(value).quantize(Decimal(text))


def case_of(oscillator: Oscillator) -> Case:
    """The case of the configuration with this oscillator."""
    return replace(CASE, oscillator=oscillator)


def judged(
    published: Published = PRINT, oscillator: Oscillator = PAPER, claimed: Oscillator | None = None
) -> pd.DataFrame:
    """The table of claims.   claimed : the oscillator of the configuration where it differs from the simulated one."""
    of_routes = sources_of(oscillator, claimed or oscillator)
    sources = replace(of_routes, published=published)
    vars(sources)["rules_at_work"] = of_routes.rules_at_work  # does not follow from print
    return claims_table(sources)


@lru_cache
def sources_of(oscillator: Oscillator = PAPER, claimed: Oscillator = PAPER) -> Sources:
    """What the claims on the paper's print are judged from.   claimed : as for `judged`."""
    return Sources(
        PRINT,
        case_of(claimed),
        exact(oscillator),
        as_published(oscillator),
        unrounded(oscillator),
    )


@lru_cache
def exact(oscillator: Oscillator = PAPER) -> RouteTables:
    """The exact route at the three frequencies."""
    features = {
        name: stack([of_orbit(steady_orbit(oscillator, motion)) for motion in CASE.motions(name)])
        for name in CASE.frequencies_hz
    }
    return RouteTables(
        {name: of.to_frame() for name, of in features.items()},
        {name: estimate_table(of, oscillator.k, CASE.pairs) for name, of in features.items()},
    )


@lru_cache
def as_read(oscillator: Oscillator = PAPER) -> dict[str, authors.ReadFeatures]:
    """What the as-published route reads at the three frequencies."""
    case = case_of(oscillator)
    return {
        name: authors.read_levels(authors.simulate_levels(case, name), case, name)
        for name in case.frequencies_hz
    }


@lru_cache
def as_published(oscillator: Oscillator = PAPER) -> RouteTables:
    """The as-published route at the three frequencies."""
    read, case = as_read(oscillator), case_of(oscillator)
    return RouteTables(
        {name: of.tabulated.to_frame() for name, of in read.items()},
        {name: authors.estimates(of.tabulated, of.two_point, case) for name, of in read.items()},
    )


def unrounded(oscillator: Oscillator = PAPER) -> pd.DataFrame:
    """What the as-published simulation gives at the first frequency, before it is read."""
    return as_read(oscillator)["omega1"].to_frame()


def approaches() -> pd.DataFrame:
    """The table of all approaches on exact features."""
    features = {name: Features.from_frame(of) for name, of in exact().features.items()}
    return approaches_table(features, CASE)


def computed(name: str, folder: Path, coarser: tuple[str, str] = ("", "")) -> tuple[Study, Path]:
    """A study of config/studies, computed in a folder, and the file of its cases.

    coarser : a part of its text, and what stands there instead, so that it has fewer cases.
    """
    text = (ROOT / f"config/studies/{name}.yaml").read_text(encoding="utf-8")
    assert coarser[0] in text
    file, cases = folder / f"{name}.yaml", folder / f"{name}/cases.parquet"
    cases.parent.mkdir(parents=True)
    file.write_text(text.replace(*coarser) if coarser[0] else text, encoding="utf-8")
    shutil.copy(ROOT / f"config/studies/{name}.md.j2", folder)
    study = read_study(file)
    case_files.write_parts(cases, [evaluate.evaluate(study, 0, study.cases, threads=1)], study, "0")
    return study, cases
