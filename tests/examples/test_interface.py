"""Every example uses the public interface alone, and its rule asks for the files that it needs."""

from __future__ import annotations

import ast
import re
import sys

import pytest

import dampbalance
from folders import ROOT
from processes import run

NAMES = sorted(path.parent.name for path in (ROOT / "examples").glob("*/Snakefile"))


@pytest.mark.parametrize("name", NAMES)
def test_it_imports_public_names_alone(name):
    tree = ast.parse((ROOT / f"examples/{name}/{name}.py").read_text(encoding="utf-8"))
    own = {
        (node.module, alias.name)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module.startswith("dampbalance")
        for alias in node.names
    }
    assert own
    assert own <= {("dampbalance", public) for public in dampbalance.__all__}


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_records_that_are_missing_are_named(name, tmp_path):
    command = ("-m", "snakemake", "--snakefile", f"examples/{name}/Snakefile", "--dry-run")
    done = run(sys.executable, *command, "--config", f"data={tmp_path}", HOME=str(tmp_path))
    assert done.returncode == 1
    assert re.search(f"MissingInputException(.|\n)*{tmp_path}/", done.stdout + done.stderr)
