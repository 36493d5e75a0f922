"""The jobs of a case, run in this process: the scripts of the rules, in the order of the workflow."""

from __future__ import annotations

import runpy
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


def run(script: str, *, output: Mapping[str, Any], **given: Any) -> None:
    """One job: `script` is a path below workflow/scripts."""
    groups = {name: Named(**value) for name, value in {**given, "output": output}.items()}
    runpy.run_path(
        str(ROOT / "workflow/scripts" / script),
        init_globals={"snakemake": SimpleNamespace(**{"input": Named()} | groups)},
        run_name="__main__",
    )


def case_jobs(config: Mapping[str, Any], folder: Path, figures: bool = True) -> None:
    """Everything that a case without printed numbers has: orbits, records, features, estimates, tables, figures, page.

    config : a whole configuration that `check` and `check_feasible` have passed.
    """
    frequencies = list(Case.from_config(config).frequencies_hz)
    given = {"params": {"case": config, "folder": str(folder), "config": config}}
    for frequency in frequencies:
        wildcards = {"frequency": frequency}
        orbits, records = (
            folder / f"orbits/{frequency}.json",
            folder / f"records/{frequency}.parquet",
        )
        read = {
            "tabulated": folder / f"features/as_published/{frequency}.csv",
            "two_point": folder / f"features/as_published/two_point/{frequency}.csv",
            "unrounded": folder / f"features/as_published/unrounded/{frequency}.csv",
        }
        exact = folder / f"features/exact/{frequency}.csv"
        estimates = {route: folder / f"estimates/{route}/{frequency}.csv" for route in ROUTES}
        common = {**given, "wildcards": wildcards}
        run("simulate/simulate_exact.py", output={"orbits": orbits}, **common)
        run("simulate/simulate_as_published.py", output={"records": records}, **common)
        run(
            "features/features_exact.py",
            input={"orbits": orbits},
            output={"features": exact},
            **common,
        )
        run("features/features_as_published.py", input={"records": records}, output=read, **common)
        run(
            "estimates/estimate_exact.py",
            input={"features": exact},
            output={"estimates": estimates["exact"]},
            **common,
        )
        run(
            "estimates/estimate_as_published.py",
            input=read,
            output={"estimates": estimates["as_published"]},
            **common,
        )
    first = folder / f"orbits/{frequencies[0]}.json"
    run("tables/tables.py", output={}, **given)
    if figures:
        for name in ("figure2", "figure3", "estimation_error"):
            files = {kind: folder / f"figures/{name}.{kind}" for kind in ("svg", "png")}
            run(f"figures/{name}.py", input={"orbits": first}, output=files, **given)
        inputs = {"orbits": first, "study_files": [], "study_cases": []}
        run("page/page.py", input=inputs, output={"page": folder / "report.html"}, **given)
