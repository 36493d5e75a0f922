"""Every example uses the public interface alone."""

from __future__ import annotations

import ast

import pytest

import dampbalance
from folders import ROOT

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
