"""Run tests as on a processor that lacks instructions of this one.

NumPy, Numba, OpenBLAS and the C library then use other instructions, and the last bits of results differ. Use it after
a change of a tolerance, or when a test fails on another machine only.

    make processors                                        the tests that compare closely, as on each such processor
    cd trials && python -m processors without-avx2 ARGUMENTS    those of pytest, as on one of them

Exit status: that of pytest; 0 where the processor here lacks the same instructions, so that no test needs another run.
"""

from __future__ import annotations

import hashlib
import math
import os
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]

PROCESSORS = {
    # like an AMD EPYC before Zen 4
    "without-avx512": {
        "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR",
        "NUMBA_CPU_NAME": "znver3",
        "NUMBA_CPU_FEATURES": "",
        "OPENBLAS_CORETYPE": "Haswell",
    },
    # the least that NumPy runs on: no sum of a product is rounded only once
    "without-avx2": {
        "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
        "NUMBA_CPU_NAME": "nehalem",
        "NUMBA_CPU_FEATURES": "",
        "OPENBLAS_CORETYPE": "Nehalem",
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX,-AVX2,-FMA",
    },
}
"""Name → the environment in which a process and its children compute as on that processor."""

CLOSE = (
    "law",
    "motion",
    "studies/test_terms.py",
    "method/test_balance.py",
    "method/test_features.py",
)
"""Folders and files of the tests that compare closely and quickly; those that are slow are left out."""

INSIDE = "--inside"
"""Of the process that has the environment and runs pytest."""


def traits() -> dict[str, Any]:
    """Return what this process computes with: features of NumPy; targets of OpenBLAS and of Numba, which keeps its
    kernels by them; a digest of the last bits of the C library's functions."""
    import scipy.linalg  # noqa: F401  has a separate OpenBLAS
    from numba.core.registry import cpu_target
    from numpy._core._multiarray_umath import __cpu_features__
    from threadpoolctl import threadpool_info

    values = [f(0.01 + 0.0037 * i) for i in range(20000) for f in (math.sin, math.exp, math.log)]
    libraries = (one for one in threadpool_info() if one["internal_api"] == "openblas")
    return {
        "numpy": {name for name, on in __cpu_features__.items() if on},
        "openblas": {one["architecture"] for one in libraries},
        "numba": cpu_target.target_context.codegen().magic_tuple()[1:],
        "libm": hashlib.sha256(struct.pack(f"{len(values)}d", *values)).hexdigest(),
    }


def lacking(name: str, here: dict[str, Any]) -> set[str]:
    """Return NumPy's features that a process has and the processor of that name has not."""
    return here["numpy"] & set(PROCESSORS[name]["NPY_DISABLE_CPU_FEATURES"].split())


def check(name: str) -> None:
    """Raise RuntimeError unless this process computes as on the processor of that name."""
    settings, here = PROCESSORS[name], traits()
    wrong = [f"NumPy uses {feature}" for feature in sorted(lacking(name, here))]
    if here["openblas"] != {settings["OPENBLAS_CORETYPE"]}:
        wrong.append(f"OpenBLAS computes for {', '.join(sorted(here['openblas']))}")
    if here["numba"] != (settings["NUMBA_CPU_NAME"], settings["NUMBA_CPU_FEATURES"]):
        wrong.append(f"Numba compiles for {' '.join(here['numba'])}")
    if "GLIBC_TUNABLES" in settings and here["libm"] == _libm_without("GLIBC_TUNABLES"):
        wrong.append("the C library computes as it does without GLIBC_TUNABLES")
    if wrong:
        raise RuntimeError(f"this is no processor {name}: {'; '.join(wrong)}")


def _libm_without(variable: str) -> str:
    """Return the C library's digest in a process without that variable."""
    program = "import processors; print(processors.traits()['libm'])"
    environment = {key: value for key, value in os.environ.items() if key != variable}
    found = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT / "trials", env=environment, check=True, capture_output=True, text=True,
    )  # fmt: skip
    return found.stdout.strip()


def run(name: str, arguments: list[str]) -> int:
    """Run pytest as on the processor of that name; its exit status."""
    if not lacking(name, traits()):
        print(f"{name}: the processor here lacks the same instructions. Nothing to run.")
        return 0
    print(f"{name}: pytest {' '.join(arguments)}", flush=True)
    inside = [sys.executable, "-m", "processors", INSIDE, name, *arguments]
    environment = os.environ | PROCESSORS[name]
    return subprocess.run(inside, cwd=ROOT / "trials", env=environment, check=False).returncode


def main(arguments: list[str]) -> int:
    """Return the command line."""
    if arguments[:1] == [INSIDE]:
        check(arguments[1])
        os.chdir(ROOT)
        return pytest.main(arguments[2:])
    if arguments and arguments[0] in PROCESSORS:
        return run(arguments[0], arguments[1:])
    close = [f"tests/{path}" for path in CLOSE]
    return max(
        [run(name, [*close, "-m", "not slow or computing", *arguments]) for name in PROCESSORS]
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
