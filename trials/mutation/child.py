"""Runs tests in a copy of the project, in a process of its own, which finds package and helpers in that copy."""

from __future__ import annotations

import ast
import builtins
import importlib
import json
import os
import resource
import signal
import sys
import time
from dataclasses import dataclass
from importlib.machinery import SourceFileLoader
from pathlib import Path
from typing import Any

import pytest

CALLS = 4000.0
"""Calls of kernels, at the most, that a test makes if it can do without compiling."""
MEMORY = 6 << 30
"""Bytes that the tests of a mutant may ask for."""


@dataclass(frozen=True)
class Run:
    """Tests to run in the copy `folder`.

    files : below the copy.   interpreted : kernels run in Python.   stop : at the first failure.
    limits : seconds of processor time by id of a test, in the order of running; None: all tests that
    are not slow are run, and the functions of the package that each of them calls are written down.
    report : file that receives the outcome.
    """

    folder: Path
    files: tuple[str, ...]
    interpreted: bool
    stop: bool
    limits: dict[str, float] | None
    report: Path


CALLED: set[Any] = set()
"""Functions of the package, as "module:name", and kernels that were called."""


class Calls(ast.NodeTransformer):
    """Lets each function of a module write down that it was called: kernels do when Python calls them."""

    def __init__(self, module: str) -> None:
        self.module, self.where = module, ""

    def visit_ClassDef(self, node: Any) -> Any:
        around, self.where = self.where, f"{self.where}.{node.name}".lstrip(".")
        if "jit" not in map(ast.unparse, node.decorator_list):
            self.generic_visit(node)
            if isinstance(node, ast.FunctionDef):
                call = ast.parse(f"__called__.add({self.module + ':' + self.where!r})").body[0]
                node.body.insert(int(ast.get_docstring(node) is not None), call)
        self.where = around
        return node

    visit_FunctionDef = visit_ClassDef


def _write_down_calls(package: str) -> None:
    """Import modules below the folder `package` with `Calls` in them, whatever has been compiled before."""
    builtins.__called__ = CALLED  # type: ignore[attr-defined]
    original = SourceFileLoader.get_code

    def get_code(loader: SourceFileLoader, name: str) -> Any:
        path = loader.get_filename(name)
        if not path.startswith(package):
            return original(loader, name)
        tree = Calls(path.removeprefix(package)).visit(ast.parse(loader.get_data(path)))
        return compile(ast.fix_missing_locations(tree), path, "exec")

    SourceFileLoader.get_code = get_code  # type: ignore[method-assign]


class Watch:
    """Chooses the tests, limits their time, and writes down how they ended and which functions they called."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self.tests: dict[str, dict[str, Any]] = {}
        if run.limits is None:
            _write_down_calls(f"{run.folder / 'src/dampbalance'}{os.sep}")
        self.jit: Any = importlib.import_module("dampbalance.motion.jit")
        call = self.jit._Kernel.__call__
        if run.limits is None:
            self.jit._Kernel.__call__ = lambda kernel, *a: (CALLED.add(kernel), call(kernel, *a))[1]

    def called(self) -> list[str]:
        """Functions of the package called since the last time, with the kernels that compiled kernels may call."""
        kernels = [one for one in CALLED if not isinstance(one, str)]
        for kernel in kernels:
            function = kernel.py_func
            CALLED.add(
                f"{function.__module__.removeprefix('dampbalance.').replace('.', '/')}.py:{function.__name__}"
            )
            used = (function.__globals__.get(name) for name in function.__code__.co_names)
            kernels += [k for k in used if isinstance(k, self.jit._Kernel) and k not in kernels]
        names = sorted(one for one in CALLED if isinstance(one, str))
        CALLED.clear()
        return names

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items):
        limits = self.run.limits
        if limits is None:
            items[:] = [item for item in items if not item.get_closest_marker("slow")]
        else:
            place = {name: i for i, name in enumerate(limits)}
            items[:] = [item for item in items if item.nodeid in place]
            items.sort(key=lambda item: place[item.nodeid])

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item):
        test = self.tests[item.nodeid] = {"passed": True, "failed": False}
        self.jit._left = CALLS if self.run.interpreted else 0.0
        if self.run.limits:  # ends the process, as compiled code would let no handler run
            signal.setitimer(signal.ITIMER_PROF, self.run.limits[item.nodeid])
        start = time.process_time()
        try:
            return (yield)
        finally:
            test["seconds"] = time.process_time() - start
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            test["called"] = self.called()
            test["passed"] &= not self.run.interpreted or self.jit._left > 0.0

    def pytest_runtest_logreport(self, report):
        self.tests[report.nodeid]["passed"] &= report.passed
        self.tests[report.nodeid]["failed"] |= report.failed

    def pytest_collectreport(self, report):
        if report.failed:
            self.tests[report.nodeid] = {"passed": False, "failed": True}

    def pytest_sessionfinish(self):
        self.run.report.write_text(json.dumps(self.tests), encoding="utf-8")


def _too_long(*_: object) -> None:
    raise TimeoutError("a test takes too long in Python")


def run_tests(run: Run) -> None:
    """Run the tests and leave with pytest's exit status, or by the signal SIGPROF where one takes too long."""
    os.setsid()  # whatever the tests start ends with this process
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    log = os.open(run.report.with_suffix(".log"), os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for stream in (1, 2):
        os.dup2(log, stream)
    os.chdir(run.folder)
    sys.path[:0] = [str(run.folder / name) for name in ("src", "tests", "trials")]
    os.environ["PYTHONPATH"] = os.pathsep.join(sys.path[:3])
    if run.stop:  # a mutant: its bytes must never be taken for those of the original
        sys.dont_write_bytecode = True
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    arguments = ["-q", "--no-header", "--tb=line", "-p", "no:cacheprovider", "-p", "no:xdist"]
    if run.interpreted and not run.stop:
        signal.signal(signal.SIGPROF, _too_long)
    if run.interpreted:  # compiled code divides and overflows without a word
        arguments += ["-W", "ignore::RuntimeWarning"]
    arguments.append("-x" if run.stop else "--continue-on-collection-errors")
    try:
        watch = Watch(run)
    except BaseException:
        os._exit(1)
    status = pytest.main([*arguments, *run.files], plugins=[watch])
    sys.stdout.flush()
    os._exit(int(status))
