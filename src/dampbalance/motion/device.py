"""The closed forms of steady orbits on a GPU: the kernels of the processor, compiled for CUDA from the same source.

Imported by the first call that asks for a device, as Numba's part for CUDA takes long to import. A thread solves a
case: it finds the arguments of its case in the arrays as they were given, by the rules of broadcasting, so that nothing
of the size of the result is copied to the device.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numba import cuda as numba_cuda
from numba.core import config

from ..arrays import Array, Codes
from ..jit import for_device
from ..model import Parameters
from .integrals import Measures, write_measures
from .steady import NO_CLOSED_FORM, solve_closed

Solver = Callable[[Sequence[Array]], tuple[Array, Codes]]
_BLOCK = 1 << 22  # cases at a time: half a gigabyte on the device
_THREADS = 128  # in a block of CUDA's

cuda: Any = numba_cuda  # has no types
# The compiler takes 234 registers by itself; with fewer, more threads run at a time. The simulator knows no registers.
_OPTIONS = {} if getattr(config, "ENABLE_CUDASIM", False) else {"max_registers": 128}


@cuda.jit(**_OPTIONS)
def _solve(first, values, starts, strides, shape, out, regime):  # type: ignore[no-untyped-def]
    """Write case first + i, the last axis running fastest, to column i of `out` and to regime[i].

    values : the given arrays one after the other; array p begins at starts[p] and has strides[p], in numbers.
    """
    i = cuda.grid(1)
    if i < regime.size:
        at = cuda.local.array(7, np.int64)
        for p in range(7):
            at[p] = starts[p]
        rest = first + i
        for axis in range(shape.size - 1, -1, -1):
            along = rest % shape[axis]
            rest //= shape[axis]
            for p in range(7):
                at[p] += along * strides[p, axis]
        m, c, k, K_z = values[at[0]], values[at[1]], values[at[2]], values[at[3]]
        par = Parameters(m, c, k, K_z, values[at[4]], values[at[5]], values[at[6]])
        phases = cuda.local.array((2, 5), np.float64)
        code, count, theta = solve_closed(par, phases)
        regime[i] = code
        if code != NO_CLOSED_FORM:
            write_measures(out, i, phases, count, theta, par)


@cuda.jit
def _put(columns, values, codes, out, regime):  # type: ignore[no-untyped-def]
    """Write the columns of `values` to those columns of `out`, and their regimes."""
    i = cuda.grid(1)
    if i < columns.size:
        regime[columns[i]] = codes[i]
        for row in range(len(values)):
            out[row, columns[i]] = values[row, i]


def solve_on_device(
    arrays: list[Array], shape: tuple[int, ...], by_processor: Solver, fetch: bool
) -> tuple[Any, Any]:
    """Solve all cases that the arrays broadcast to: the rows (15, n) of `Measures`, and the regimes (n,).

    arrays : of the fields of `Parameters`.   by_processor : solves the cases that have no closed form.
    fetch : return NumPy arrays, computed in blocks; else arrays that stay on the device.

    Raises RuntimeError where there is no GPU.
    """
    if not cuda.is_available():
        raise RuntimeError(
            "device='cuda' needs an NVIDIA GPU with its driver, and Numba finds none; with one, install "
            "'dampbalance[cuda]'; without one, device='cpu' computes the same"
        )
    size, rows = math.prod(shape), len(Measures._fields)
    values, ends = np.concatenate([a.ravel() for a in arrays]), np.cumsum([a.size for a in arrays])
    parts = np.split(values, ends[:-1])
    axes = (1, *shape)  # CUDA has no array without axes
    views = [
        np.broadcast_to(part.reshape(a.shape), axes) for part, a in zip(parts, arrays, strict=True)
    ]
    strides = [[step // values.itemsize for step in view.strides] for view in views]
    layout = [cuda.to_device(np.array(of)) for of in (values, [0, *ends[:-1]], strides, axes)]

    block = min(size, _BLOCK) if fetch else size
    on_device = cuda.device_array((rows, block)), cuda.device_array(block, np.uint8)
    out, regime = (np.empty((rows, size)), np.empty(size, np.uint8)) if fetch else on_device
    for first in range(0, size, max(block, 1)):  # cases beyond the last are the first ones again
        with for_device():
            _solve[-(-block // _THREADS), _THREADS](first, *layout, *on_device)
        codes = on_device[1].copy_to_host()[: size - first]
        others = np.flatnonzero(codes == NO_CLOSED_FORM)
        case = np.unravel_index(first + others, axes)
        solved = by_processor([view[case] for view in views])
        if fetch:
            those = slice(first, first + codes.size)
            out[:, those], regime[those] = on_device[0].copy_to_host()[:, : codes.size], codes
            out[:, first + others], regime[first + others] = solved
        elif others.size:
            _put[-(-others.size // _THREADS), _THREADS](others, *solved, *on_device)
    return out, regime
