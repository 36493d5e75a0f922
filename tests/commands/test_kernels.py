"""What the set-up compiles is every kernel, so that nobody waits for one later."""

from __future__ import annotations

import pkgutil
from importlib import import_module

import pytest

from dampbalance import motion
from dampbalance.commands import kernels
from dampbalance.motion.jit import _Kernel


def called_by(kernel: _Kernel) -> set[_Kernel]:
    """The kernels whose names stand in a kernel, and which are compiled with it."""
    names = kernel.py_func.__code__.co_names
    found = [kernel.py_func.__globals__.get(name) for name in names]
    return {one for one in found if isinstance(one, _Kernel)}


@pytest.mark.slow
def test_the_set_up_calls_every_kernel(monkeypatch):
    waiting, reached = [], set()
    plain = _Kernel.__call__

    def seen(kernel, *arguments):
        waiting.append(kernel)
        return plain(kernel, *arguments)

    monkeypatch.setattr(_Kernel, "__call__", seen)
    for part in kernels.PARTS.values():
        part()
    while waiting:
        kernel = waiting.pop()
        if kernel not in reached:
            reached.add(kernel)
            waiting += called_by(kernel)
    rooms = pkgutil.iter_modules(motion.__path__)
    modules = [import_module(f"dampbalance.motion.{module.name}") for module in rooms]
    there = {one for module in modules for one in vars(module).values() if isinstance(one, _Kernel)}
    assert {one.__qualname__ for one in there - reached} == set()
