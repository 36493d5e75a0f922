"""The scripts of the rules, run in this process in the order of the workflow, with what a rule would hand them."""

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


class Named(dict[str, Any]):
    """What a rule hands its script, by name; None for what it lacks."""

    def __getattr__(self, name: str) -> Any:
        return self.get(name)


KINDS = ("input", "output", "params", "wildcards")


def run(script: str, **given: Any) -> None:
    """One job: `script` is a path below workflow/scripts; input, output, params, wildcards are by name."""
    groups = {name: Named(given.get(name, {})) for name in KINDS}
    snakemake = SimpleNamespace(**groups, log=(), threads=1)
    hook = sys.excepthook  # which a script replaces
    try:
        path = ROOT / "workflow/scripts" / script
        runpy.run_path(str(path), init_globals={"snakemake": snakemake}, run_name="__main__")
    finally:
        sys.excepthook = hook


def case_jobs(config: Mapping[str, Any], folder: Path) -> None:
    """What a case without printed numbers has: orbits, records, features, estimates, numbers, tables.

    config : a whole configuration that `check_case` and `check_feasible` have passed.
    """
    frequencies = list(Case.from_config(config).frequencies_hz)
    params = {"case": config, "folder": str(folder)}

    def files(pattern: str) -> list[Path]:
        return [folder / pattern.format(frequency) for frequency in frequencies]

    exact = {"orbits": files("orbits/{}.json"), "features": files("features/exact/{}.csv")}
    read = {
        "records": files("records/as_published/{}.parquet"),
        "tabulated": files("features/as_published/{}.csv"),
        "two_point": files("features/as_published/two_point/{}.csv"),
        "unrounded": files("features/as_published/unrounded/{}.csv"),
    }
    run("response/response_exact.py", output=exact, params=params)
    run("response/response_as_published.py", output=read, params=params)
    entering = exact, {"features": read["tabulated"], "two_point": read["two_point"]}
    for route, features in zip(ROUTES, entering, strict=True):
        output = {"estimates": files(f"estimates/{route}/{{}}.csv")}
        run("estimates/estimate.py", input=features, output=output, params=params)
    numbers = folder / "numbers.csv"
    run("claims/numbers.py", input=read, output={"csv": numbers}, params=params)
    run("tables/tables.py", input={"numbers": numbers}, params=params)
