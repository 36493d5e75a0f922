"""The kernels on a GPU give what they give on the processor; without one, CUDA's simulator runs them in Python."""

from __future__ import annotations

import os
import sys
from unittest.mock import patch

import numpy as np
import pytest
from numba import cuda

from analytic.cases import dimensions
from dampbalance import Orbits, steady_orbits
from dampbalance.jit import _Kernel
from processes import output_of

SIMULATED = "NUMBA_ENABLE_CUDASIM" in os.environ
# The sums of an orbit are the same but for fused multiplications and the last digits of sin, exp and log.
TOLERANCE = 1e-12
# of X: what rounding leaves of a third or fifth harmonic that hardly exists
ROUNDING = 1e-14


def cases(rows: int) -> dict[str, np.ndarray]:
    """The arguments of 4 · rows cases of all regimes, which broadcast along both axes."""
    rng = np.random.default_rng(20261127)

    def between(low: float, high: float, *shape: int) -> np.ndarray:
        return low * (high / low) ** rng.random(shape)

    F = between(1e-3, 3.0, rows, 4)
    F[::25] = 0.0
    zeta, K = between(1e-2, 2.0, rows, 1), between(1.0, 1e3, rows, 1)
    return dimensions(zeta, between(0.2, 3.0, 4), K, F)


def in_python(kernel: _Kernel, *arguments: object) -> object:
    """A call of a kernel from the simulator, whose arrays no compiled kernel takes."""
    return kernel.py_func(*arguments)


def assert_same_as_the_processor(rows: int, fetch: bool) -> None:
    given = cases(rows)
    expected = steady_orbits(**given)
    with patch.object(_Kernel, "__call__", in_python if SIMULATED else _Kernel.__call__):
        got = steady_orbits(**given, device="cuda", fetch=fetch)
    if not fetch and not SIMULATED:  # as CuPy and PyTorch see it
        assert got.X.__cuda_array_interface__["shape"] == (rows, 4)
    regimes = np.asarray(got.regime)
    assert set(regimes.ravel()) >= {1, 2, 3, 4}
    np.testing.assert_array_equal(regimes, expected.regime)
    for name in ("X", "X_s", "V_s", "t_s", "phi", "phi_zero_crossing", "a", "b", "W"):
        np.testing.assert_allclose(getattr(got, name), getattr(expected, name), TOLERANCE)
    for n in (1, 3, 5):  # a phase has as many digits as its amplitude
        error = abs(harmonic(got, n) - harmonic(expected, n))
        assert (error <= TOLERANCE * abs(harmonic(expected, n)) + ROUNDING * expected.X).all(), n


def harmonic(orbits: Orbits, n: int) -> np.ndarray:
    X_n, phi_n = (np.asarray(getattr(orbits, f"{name}_{n}")) for name in ("X", "phi"))
    return X_n * np.exp(-1j * phi_n)


@pytest.mark.parametrize("fetch", [True, False])
def test_on_a_GPU(fetch):
    if not cuda.is_available():
        pytest.skip("no NVIDIA GPU with its driver, or the extra cuda is not installed")
    assert_same_as_the_processor(2500, fetch)


def in_simulator() -> None:
    """Compare results that are fetched and that stay, of several blocks, a last one that is not full, no axis at all
    and no case at all. To be called where Numba simulates CUDA, which it decides when it is imported."""
    from dampbalance.motion import device

    assert_same_as_the_processor(16, fetch=False)
    device._BLOCK = 25
    assert_same_as_the_processor(16, fetch=True)
    case = {name: np.ravel(values)[-1] for name, values in cases(1).items()}
    with patch.object(_Kernel, "__call__", in_python):
        assert steady_orbits(**case, device="cuda").X.shape == ()
        assert steady_orbits(**case | {"Y": []}, device="cuda").X.shape == (0,)


def test_in_the_simulator():
    program = "from motion import test_device\ntest_device.in_simulator()"
    folders = os.pathsep.join(path for path in sys.path if path)
    output_of(sys.executable, "-c", program, NUMBA_ENABLE_CUDASIM="1", PYTHONPATH=folders)


def test_without_a_GPU_no_result_of_the_processor_passes_for_one(monkeypatch):
    monkeypatch.setattr(cuda, "is_available", lambda: False)
    case = {name: np.ravel(values)[-1] for name, values in cases(1).items()}
    with pytest.raises(RuntimeError, match=r"NVIDIA GPU.*install 'dampbalance\[cuda\]'"):
        steady_orbits(**case, device="cuda")
