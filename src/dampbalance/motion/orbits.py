"""The exact steady response of many oscillators at once."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import numbers, whole
from ..arrays import Array, Codes
from ..model import Parameters
from .events import MOST_RADIANS
from .integrals import Measures, measure
from .jit import jit
from .steady import MAX_PHASES, NO_CLOSED_FORM, solve_closed, solve_otherwise

_BLOCK = 4096  # cases handed to a thread at a time: the scratch memory stays below a megabyte


@dataclass(frozen=True, eq=False)
class Orbits:
    """Features of many steady orbits, arrays of the broadcast shape of the inputs; names and units as in `Orbit`.

    X_n, phi_n : amplitude, m, and lag, rad, of the odd harmonics.   regime : codes of `Regime` (uint8).
    A feature that does not exist is NaN, and `regime` says why; where no orbit was found everything is NaN.
    """

    X: Array
    X_s: Array
    V_s: Array
    t_s: Array
    phi: Array
    phi_zero_crossing: Array
    a: Array
    b: Array
    W: Array
    X_1: Array
    phi_1: Array
    X_3: Array
    phi_3: Array
    X_5: Array
    phi_5: Array
    regime: Codes


def steady_orbits(
    *,
    m: ArrayLike,
    c: ArrayLike,
    k: ArrayLike,
    K_z: ArrayLike,
    F_k: ArrayLike,
    Y: ArrayLike,
    omega: ArrayLike,
    threads: int | None = None,
) -> Orbits:
    """Exact steady responses of all combinations that the arguments broadcast to, in any regime.

    m : kg.   c : N s/m.   k, K_z : N/m.   F_k : N.   Y : m.   omega : rad/s.   threads : default, the cores this
    process may use. The result does not depend on the number of threads.

    Raises ValueError (naming the argument and the first offending value) for a value that `Oscillator` refuses, masked
    or missing ones among them, for anything but numbers, and for shapes that do not broadcast.

    >>> import math
    >>> from dampbalance import Regime, steady_orbits
    >>> levels = [0.0002, 0.004, 0.012]
    >>> orbits = steady_orbits(
    ...     m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28, Y=levels, omega=2 * math.pi * 4.92
    ... )
    >>> [f"{1000 * X:.3f}" for X in orbits.X]
    ['0.002', '2.728', '9.369']
    >>> str(Regime(orbits.regime[0]))
    'no slip: the contact only sticks'
    """
    given = {"m": m, "c": c, "k": k, "K_z": K_z, "F_k": F_k, "Y": Y, "omega": omega}
    arrays = [numbers(name, value) for name, value in given.items()]
    shape = _common_shape(arrays)
    size = int(np.prod(shape))
    out = np.empty((len(Measures._fields), size))
    regime = np.empty(size, dtype=np.uint8)
    views = [np.broadcast_to(a, shape) for a in arrays]

    def solve(start: int) -> None:
        block = slice(start, start + _BLOCK)
        inputs = tuple(view.flat[block] for view in views)
        if _solve_closed_forms(inputs, out[:, block], regime[block]):
            _solve_others(inputs, out[:, block], regime[block])

    if threads is None:
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    else:
        cores = whole("threads", threads)
    with ThreadPoolExecutor(max_workers=cores or 1) as pool:
        for _ in pool.map(solve, range(0, size, _BLOCK)):
            pass
    # the fields of `Orbits` are those of `Measures`, in their order, and the regime
    return Orbits(*(row.reshape(shape) for row in (*out, regime)))


def _common_shape(arrays: list[Array]) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*(a.shape for a in arrays))
    except ValueError:
        shapes = ", ".join(
            f"{name} {a.shape}" for name, a in zip(Parameters._fields, arrays, strict=True)
        )
        raise ValueError(f"the arguments do not broadcast to one shape: {shapes}") from None


@jit
def _solve_closed_forms(inputs: tuple[Array, ...], out: Array, regime: Codes) -> int:
    """How many cases are left to `_solve_others`: those whose regime is NO_CLOSED_FORM then.

    inputs : the arrays (n,) of `Parameters`.   Rows of `out` (15, n) receive the fields of `Measures`.
    """
    phases, left = np.empty((2, 5)), 0
    for i, of_case in enumerate(zip(*inputs)):  # noqa: B905 (no strict= in compiled code)
        par = Parameters(*of_case)
        code, count, theta = solve_closed(par, phases)
        regime[i] = code
        if code == NO_CLOSED_FORM:
            left += 1
        else:
            _write_measures(out, i, phases, count, theta, par)
    return left


@jit
def _solve_others(inputs: tuple[Array, ...], out: Array, regime: Codes) -> None:
    """The cases that `_solve_closed_forms` left; arguments as there."""
    phases = np.empty((MAX_PHASES, 5))
    for i, of_case in enumerate(zip(*inputs)):  # noqa: B905 (no strict= in compiled code)
        if regime[i] == NO_CLOSED_FORM:
            par = Parameters(*of_case)
            code, count, theta = solve_otherwise(par, phases, MOST_RADIANS)
            regime[i] = code
            _write_measures(out, i, phases, count, theta, par)


@jit
def _write_measures(
    out: Array, i: int, phases: Array, count: int, theta: float, par: Parameters
) -> None:
    """Column i of `out`: the measures of an orbit with `count` phases in its half cycle, NaN where there is none."""
    if count == 0:
        for row in range(len(out)):
            out[row, i] = np.nan
    else:
        for row, value in enumerate(measure(phases, count, theta, par)):
            out[row, i] = value
