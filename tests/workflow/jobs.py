"""The jobs of a case, run in this process: the scripts of the rules, in the order of the workflow."""

from __future__ import annotations

import runpy
import sys
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from dampbalance.project.case import Case
from dampbalance.project.files import ROUTES
from folders import ROOT


class Named(SimpleNamespace):
    """Files or parameters of a rule, by name; None for one that the rule lacks."""

    def __getattr__(self, name: str) -> Any:
        return None

    def get(self, name: str, default: Any = None) -> Any:
        return vars(self).get(name, default)


def run(script: str, **given: Any) -> None:
    """One job: `script` is a path below workflow/scripts; input, output, params are by name."""
    groups = {name: Named(**value) for name, value in given.items()}
    snakemake = SimpleNamespace(
        **{"input": Named(), "output": Named(), "log": (), "threads": 1} | groups
    )
    hook = sys.excepthook  # which a script replaces
    try:
        path = ROOT / "workflow/scripts" / script
        runpy.run_path(str(path), init_globals={"snakemake": snakemake}, run_name="__main__")
    finally:
        sys.excepthook = hook


def case_jobs(config: Mapping[str, Any], folder: Path) -> None:
    """What a case without printed numbers has: orbits, records, features, estimates, numbers, tables.

    config : a whole configuration that `check` and `check_feasible` have passed.
    """
    frequencies = list(Case.from_config(config).frequencies_hz)
    given = {"params": {"case": config, "folder": str(folder)}}

    def files(pattern: str) -> list[Path]:
        return [folder / pattern.format(frequency) for frequency in frequencies]

    exact = {
        "orbits": files("orbits/{}.json"),
        "features": files("features/exact/{}.csv"),
    }
    read = {
        "records": files("records/as_published/{}.parquet"),
        "tabulated": files("features/as_published/{}.csv"),
        "two_point": files("features/as_published/two_point/{}.csv"),
        "unrounded": files("features/as_published/unrounded/{}.csv"),
    }
    run("response/response_exact.py", output=exact, **given)
    run("response/response_as_published.py", output=read, **given)
    entering = {"features": read["tabulated"], "two_point": read["two_point"]}
    for route, features in zip(ROUTES, (exact, entering), strict=True):
        output = {"estimates": files(f"estimates/{route}/{{}}.csv")}
        run("estimates/estimate.py", input=features, output=output, **given)
    numbers = {"csv": folder / "numbers.csv"}
    run("claims/numbers.py", input=read, output=numbers, **given)
    run("tables/tables.py", input={"numbers": numbers["csv"]}, **given)
