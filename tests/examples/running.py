"""Examples as their tests load and run them."""

from __future__ import annotations

import importlib.util
from types import ModuleType

from folders import ROOT

DATA = ROOT.parent / "shared/data"


def script_of(name: str) -> ModuleType:
    """Return the script of an example as a module."""
    path = ROOT / "examples" / name / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"example_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
