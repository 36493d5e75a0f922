"""A pytest plugin that records outcome, time and called functions of each test (`-p mutation.watch`).

Environment: MUTATION_PACKAGE, the folder of the package; MUTATION_REPORT, the file to write; MUTATION_CALLS, whether
calls are recorded, which takes as long as the tests.
"""

import json
import os
import resource
import sys
import threading
import time
from pathlib import Path

import pytest

from dampbalance import jit

MEMORY = 6 << 30  # bytes that tests may ask for
PACKAGE = os.environ["MUTATION_PACKAGE"] + os.sep

resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
records, codes, kernels = {}, set(), {}


def _note(frame, event, _):
    if event == "call" and frame.f_code.co_filename.startswith(PACKAGE):
        codes.add(frame.f_code)
        if frame.f_code is jit._Kernel.__call__.__code__:
            kernels[frame.f_locals["self"]] = None


def _called():
    """Return the functions called, as "module:name", with the kernels that compiled kernels may call."""
    every = [*kernels]
    for function in (kernel.py_func for kernel in every):
        codes.add(function.__code__)
        used = map(function.__globals__.get, function.__code__.co_names)
        every += [other for other in used if isinstance(other, jit._Kernel) and other not in every]
    names = {f"{c.co_filename}:{c.co_qualname}".replace(".<locals>", "") for c in codes}
    return sorted(name.removeprefix(PACKAGE) for name in names)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item):
    codes.clear()
    kernels.clear()
    record = records[item.nodeid] = {"outcomes": []}
    start = time.process_time()
    if os.environ["MUTATION_CALLS"]:
        threading.setprofile(_note)
        sys.setprofile(_note)
    try:
        return (yield)
    finally:
        sys.setprofile(None)
        record |= {"seconds": time.process_time() - start, "called": _called()}


def pytest_runtest_logreport(report):
    records[report.nodeid]["outcomes"].append(report.outcome)


def pytest_sessionfinish():
    Path(os.environ["MUTATION_REPORT"]).write_text(json.dumps(records), encoding="utf-8")
