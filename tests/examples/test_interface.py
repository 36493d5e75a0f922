"""Every example uses the public interface alone, and its rule asks for the files that it needs."""

from __future__ import annotations

import ast
import sys

import pytest

import dampbalance
from folders import ROOT
from processes import run

NAMES = sorted(path.parent.name for path in (ROOT / "examples").glob("*/Snakefile"))


@pytest.mark.parametrize("name", NAMES)
def test_it_imports_public_names_alone(name):
    tree = ast.parse((ROOT / f"examples/{name}/{name}.py").read_text(encoding="utf-8"))
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    modules = {
        f"{getattr(node, 'module', '')}.{alias.name}".removeprefix(".")
        for node in imports
        for alias in node.names
    }
    own = {module for module in modules if module.split(".")[0] == "dampbalance"}
    assert own
    assert own <= {f"dampbalance.{public}" for public in dampbalance.__all__}


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_records_that_are_missing_are_named(name, tmp_path):
    command = ("-m", "snakemake", "--snakefile", f"examples/{name}/Snakefile", "--dry-run")
    done = run(sys.executable, *command, "--config", f"data={tmp_path}", HOME=str(tmp_path))
    assert done.returncode == 1
    assert "MissingInputException" in done.stdout + done.stderr
    assert f"{tmp_path}/" in done.stdout + done.stderr
