"""The exact steady response of many oscillators at once."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Codes
from ..model import Parameters
from .integrals import measure, wrapped
from .jit import jit
from .states import zero_crossing
from .steady import MAX_PHASES, solve_steady

_BLOCK = 4096  # cases handed to a thread at a time: the scratch memory stays below a megabyte
_COLUMNS = (
    "X",
    "X_s",
    "V_s",
    "t_s",
    "phi",
    "phi_zero_crossing",
    "a",
    "b",
    "W",
    "X_1",
    "phi_1",
    "X_3",
    "phi_3",
    "X_5",
    "phi_5",
)
_POSITIVE = ("m", "k", "K_z", "Y", "omega")
_NOT_NEGATIVE = ("c", "F_k")


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

    Raises ValueError (naming the argument and the first offending value) for a value outside the range given in
    `Oscillator` and for shapes that do not broadcast, TypeError for anything but numbers.
    """
    arrays = _checked({"m": m, "c": c, "k": k, "K_z": K_z, "F_k": F_k, "Y": Y, "omega": omega})
    shape = _common_shape(arrays)
    size = int(np.prod(shape))
    out = np.empty((len(_COLUMNS), size))
    regime = np.empty(size, dtype=np.uint8)
    views = [np.broadcast_to(a, shape) for a in arrays]

    def solve(start: int) -> None:
        stop = min(start + _BLOCK, size)
        inputs = np.empty((len(views), stop - start))
        for row, view in zip(inputs, views, strict=True):
            row[:] = view.flat[start:stop]
        _solve_block(inputs, out[:, start:stop], regime[start:stop])

    if threads is None:
        threads = (
            len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
        )
    with ThreadPoolExecutor(max_workers=max(1, threads or 1)) as pool:
        for _ in pool.map(solve, range(0, size, _BLOCK)):
            pass
    columns = {name: row.reshape(shape) for name, row in zip(_COLUMNS, out, strict=True)}
    return Orbits(**columns, regime=regime.reshape(shape))


def _common_shape(arrays: list[Array]) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*(a.shape for a in arrays))
    except ValueError:
        shapes = ", ".join(
            f"{name} {a.shape}" for name, a in zip(Parameters._fields, arrays, strict=True)
        )
        raise ValueError(f"the arguments do not broadcast to one shape: {shapes}") from None


def _checked(arguments: dict[str, ArrayLike]) -> list[Array]:
    arrays = []
    for name, value in arguments.items():
        given = np.asarray(value)
        if given.dtype.kind not in "iuf":
            raise TypeError(f"{name} must be a number or an array of numbers, got {value!r}")
        array = given.astype(float)
        wrong = ~np.isfinite(array) | (array <= 0.0 if name in _POSITIVE else array < 0.0)
        if wrong.any():
            bound = "positive" if name in _POSITIVE else "not negative"
            raise ValueError(f"{name} must be finite and {bound}, got {array[wrong].item(0)!r}")
        arrays.append(array)
    return arrays


@jit
def _solve_block(inputs: Array, out: Array, regime: Codes) -> None:
    """Rows of `inputs` (7, n) in the order of `Parameters`; rows of `out` in that of _COLUMNS."""
    phases = np.empty((MAX_PHASES, 5))
    for i in range(inputs.shape[1]):
        par = Parameters(
            inputs[0, i],
            inputs[1, i],
            inputs[2, i],
            inputs[3, i],
            inputs[4, i],
            inputs[5, i],
            inputs[6, i],
        )
        code, count, theta = solve_steady(par, phases)
        regime[i] = code
        if count == 0:
            out[:, i] = np.nan
            continue
        found = measure(phases, count, theta, par)
        delay = zero_crossing(phases, count, theta, par)
        out[0, i], out[1, i], out[2, i], out[3, i] = found.X, found.X_s, found.V_s, found.t_s
        out[4, i] = wrapped(theta + np.pi)
        out[5, i] = wrapped(theta + par.omega * delay + 0.5 * np.pi)
        out[6, i], out[7, i], out[8, i] = found.a, found.b, found.W
        out[9, i], out[10, i] = abs(found.harmonic_1), -np.angle(found.harmonic_1)
        out[11, i], out[12, i] = abs(found.harmonic_3), -np.angle(found.harmonic_3)
        out[13, i], out[14, i] = abs(found.harmonic_5), -np.angle(found.harmonic_5)
