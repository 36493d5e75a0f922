"""Linear algebra on one thread, so that the same records give the same bytes on any number of cores.

The library behind NumPy splits sums among its threads, and their last bits depend on the number of threads.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numpy as np  # noqa: F401  (loads the library that is limited)
from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
R = TypeVar("R")

_CONTROLLER = ThreadpoolController()


def one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Run `function` with the linear algebra of NumPy on one thread."""
    limited: Callable[P, R] = _CONTROLLER.wrap(limits=1, user_api="blas")(function)
    return limited
