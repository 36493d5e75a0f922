"""Linear algebra on one thread: the same records must give the same bytes on one core and on many.

The library behind NumPy splits sums among its threads, and their last bits follow how many there are.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numpy as np  # noqa: F401  (its library must be loaded before it can be limited)
from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
R = TypeVar("R")

_CONTROLLER = ThreadpoolController()
_LIMITED = threading.local()  # whether this thread works within a limit already


def one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Run `function` with the linear algebra of NumPy on one thread."""

    @functools.wraps(function)
    def limited(*arguments: P.args, **named: P.kwargs) -> R:
        if getattr(_LIMITED, "now", False):
            return function(*arguments, **named)
        _LIMITED.now = True
        try:
            with _CONTROLLER.limit(limits=1, user_api="blas"):
                return function(*arguments, **named)
        finally:
            _LIMITED.now = False

    return limited
