"""The exact and the as-published route of `config/config.yaml`, computed in memory, for any oscillator."""

from __future__ import annotations

import shutil
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import pandas as pd
import yaml

from dampbalance.estimates import estimate_table
from dampbalance.features import of_orbit, stack
from dampbalance.model import Oscillator
from dampbalance.motion.orbit import steady_orbit
from dampbalance.project.case import Case
from dampbalance.replication import authors_route as authors
from dampbalance.replication.claims.causes import Sources
from dampbalance.replication.claims.printed import Published, from_print, read_published
from dampbalance.replication.claims.table import claims_table
from dampbalance.replication.comparison import approaches_table
from dampbalance.replication.numbers import Numbers, by_key, numbers_table, of_routes, with_claims
from dampbalance.studies import case_files, evaluate
from dampbalance.studies.reading_study import read_study
from dampbalance.studies.study_file import Study
from folders import PUBLISHED, ROOT

PRINT = read_published(PUBLISHED)
CONFIG = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
CASE = Case.from_config(CONFIG)
PAPER = CASE.oscillator


class Route(NamedTuple):
    """The tables of a route by frequency: `Features.to_frame()`, and `estimate_table`."""

    features: dict[str, pd.DataFrame]
    estimates: dict[str, pd.DataFrame]


def case_of(oscillator: Oscillator) -> Case:
    """The case of the configuration with this oscillator."""
    return replace(CASE, oscillator=oscillator)


def judged(
    published: Published = PRINT, oscillator: Oscillator = PAPER, claimed: Oscillator | None = None
) -> pd.DataFrame:
    """The table of claims.   claimed : the oscillator of the configuration where it differs from the simulated one."""
    sources = reprinted(sources_of(oscillator, claimed or oscillator), published)
    vars(sources)["rules_at_work"] = sources_of(oscillator, claimed or oscillator).rules_at_work
    return claims_table(sources)


def reprinted(sources: Sources, published: Published) -> Sources:
    """The sources with another print, and what follows from it by the route from print."""
    numbers = dict(sources.numbers)
    for key, value in from_print(published, sources.case).items():
        numbers[key] = {**numbers[key], "from_print": value}
    return Sources(published, sources.case, numbers)


@lru_cache
def sources_of(oscillator: Oscillator = PAPER, claimed: Oscillator = PAPER) -> Sources:
    """What the claims on the paper's print are judged from.   claimed : as for `judged`."""
    case = case_of(claimed)
    routes = exact(oscillator), as_published(oscillator), unrounded(oscillator)
    return Sources(PRINT, case, by_key(numbers_of(*routes, case)))


def numbers_of(
    exact: Route, as_published: Route, unrounded: pd.DataFrame, case: Case = CASE
) -> pd.DataFrame:
    """The table of numbers of these routes, and of the paper's print."""
    features = {"exact": exact.features, "as_published": as_published.features}
    estimates = {"exact": exact.estimates, "as_published": as_published.estimates}
    routes = of_routes(case, features | {"unrounded": {"omega1": unrounded}}, estimates)
    return numbers_table(routes | {"from_print": from_print(PRINT, case)}, PRINT.ids)


@lru_cache
def numbers() -> pd.DataFrame:
    """The table of numbers of the paper's case, with what is printed and its verdict."""
    return with_claims(numbers_of(exact(), as_published(), unrounded()), judged())


def nothing() -> Numbers:
    """The numbers where no route that simulates gives any."""
    silent = dict.fromkeys(("exact", "as_published", "unrounded"), float("nan"))
    rows = sources_of().numbers.items()
    return {key: row if key.kind == "parameter" else row | silent for key, row in rows}


@lru_cache
def exact(oscillator: Oscillator = PAPER) -> Route:
    """The exact route at the three frequencies."""
    features = {
        name: stack([of_orbit(steady_orbit(oscillator, motion)) for motion in CASE.motions(name)])
        for name in CASE.frequencies_hz
    }
    return Route(
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
def as_published(oscillator: Oscillator = PAPER) -> Route:
    """The as-published route at the three frequencies."""
    read, case = as_read(oscillator), case_of(oscillator)
    return Route(
        {name: of.tabulated.to_frame() for name, of in read.items()},
        {name: authors.estimates(of.tabulated, of.two_point, case) for name, of in read.items()},
    )


def unrounded(oscillator: Oscillator = PAPER) -> pd.DataFrame:
    """What the as-published simulation gives at the first frequency, before it is read."""
    return as_read(oscillator)["omega1"].to_frame()


def approaches() -> pd.DataFrame:
    """The table of all approaches on exact features."""
    return approaches_table(by_key(numbers()), CASE.frequencies_hz)


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
