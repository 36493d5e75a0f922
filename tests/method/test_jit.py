"""Compiled kernels are kept on disk, and never outlive the source they were compiled from."""

from __future__ import annotations

import json
import re
import shutil
import sys
from pathlib import Path

import pytest

import dampbalance
import dampbalance.jit
from processes import output_of
from rooms import FACE, MODULES, graph, reached

SOURCE = Path(dampbalance.__file__).parent

# Two kernels in two files, as small as can be: those of the package take seconds to compile.
CALLED = """
from ..jit import jit
@jit
def doubled(x):
    return 2.0 * x
"""
CALLING = """
from ..jit import jit
from .called import doubled
@jit
def doubled_and_one(x):
    return doubled(x) + 1.0
"""
PROGRAM = """
import json
from dampbalance import jit
from dampbalance.motion import calling
kernel = calling.doubled_and_one.dispatcher
print(json.dumps({
    "value": kernel(3.0), "hits": sum(kernel.stats.cache_hits.values()),
    "folder": str(jit._folder()), "module": calling.__file__,
}))
"""


@pytest.fixture
def package(tmp_path):
    """A copy of the package, without anything compiled."""
    copy = tmp_path / "site" / "dampbalance"
    shutil.copytree(SOURCE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    return copy


def run(package):
    """What PROGRAM prints when it runs on that copy, in a fresh process."""
    variables = {"PYTHONPATH": str(package.parent), "PYTHONDONTWRITEBYTECODE": "1"}
    result = json.loads(output_of(sys.executable, "-W", "error", "-c", PROGRAM, **variables))
    assert Path(result["module"]).parents[1] == package
    return result


@pytest.mark.slow
def test_an_edit_of_a_called_kernel_takes_effect(package):
    (package / "motion/called.py").write_text(CALLED, encoding="utf-8")
    (package / "motion/calling.py").write_text(CALLING, encoding="utf-8")
    first = run(package)
    assert first["value"] == 7.0
    assert Path(first["folder"]).parent == package / "__pycache__"
    assert first["hits"] == 0

    again = run(package)
    assert (again["folder"], again["value"]) == (first["folder"], first["value"])
    assert again["hits"] == 1  # not compiled a second time

    # a kernel in another file than the one that is called from here
    (package / "motion/called.py").write_text(CALLED.replace("2.0", "4.0"), encoding="utf-8")
    edited = run(package)
    assert edited["value"] == 13.0
    assert edited["folder"] != first["folder"]


def test_digest_follows_every_module_that_kernels_are_made_of():
    decorated = re.compile(r"^@jit$", re.MULTILINE)
    kernels = {name for name, path in MODULES.items() if decorated.search(path.read_text("utf-8"))}
    assert {"dampbalance.motion.flow", "dampbalance.motion.integrals"} <= kernels
    made_of = {MODULES[name] for name in reached(kernels, graph()) - FACE}
    assert made_of <= {*dampbalance.jit._sources()}


def block(path):
    """Make it impossible to create a folder there, for root as well: a file is in its place."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("")


def no_home():
    raise RuntimeError("Could not determine home directory.")


def test_a_package_that_cannot_be_written_to_uses_the_users_cache_and_else_none(
    package, monkeypatch, tmp_path
):
    chosen_folder = dampbalance.jit._cache_folder
    monkeypatch.setattr(dampbalance.jit, "_PACKAGE", package)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert chosen_folder().parent == package / "__pycache__"
    shutil.rmtree(package / "__pycache__")
    block(package / "__pycache__")
    assert chosen_folder().parent == tmp_path / "cache" / "dampbalance"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert chosen_folder().parent == tmp_path / "home" / ".cache" / "dampbalance"
    shutil.rmtree(tmp_path / "home")
    block(tmp_path / "home" / ".cache")
    assert chosen_folder() is None
    monkeypatch.delenv("HOME")
    monkeypatch.setattr(Path, "home", no_home)
    assert chosen_folder() is None
    monkeypatch.setattr(dampbalance.jit, "_folder", lambda: None)
    assert dampbalance.jit.jit(lambda x: 3.0 * x)(2.0) == 6.0  # compiled all the same
