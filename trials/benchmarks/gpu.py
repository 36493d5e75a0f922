"""Steady orbits on a GPU and on the processor, in one run: make bench BENCH_ARGS=gpu, with the extra `cuda`.

Both solve the same cases with the same kernels and all 15 features. On the GPU the results stay on the device, or come
back to the memory of the processor; compilation is timed by itself.
"""

from __future__ import annotations

import time
from importlib.util import find_spec
from pathlib import Path

from dampbalance import steady_orbits
from dampbalance.project.files import write_text
from dampbalance.project.wording import markdown_table

from .cases import sweep
from .measuring import Contestant, interleaved, machine, ratios

CASES = 1 << 26
"""Cases of a call on the GPU: 67 million; the processor solves 1/64 of them."""

REFERENCE = "GPU, results stay there"


def missing() -> str:
    """Return why no GPU can be timed here; "" where one can."""
    if not find_spec("numba_cuda"):
        return "numba-cuda is not installed: pip install '.[cuda]'"
    from numba import cuda

    return "" if cuda.is_available() else "Numba finds no NVIDIA GPU with its driver"


def run(out: Path, repetitions: int = 9, size: int = CASES) -> None:
    """Measure, and write gpu.md into the folder `out`; without a GPU it says why there is nothing."""
    if reason := missing():
        write_text(out / "gpu.md", f"Not measured: {reason}.\n")
        return
    from numba import cuda

    arguments, few = sweep(size).arguments(), sweep(size // 64 or 1)
    began = time.perf_counter()
    steady_orbits(**few.arguments(), device="cuda")
    compilation = time.perf_counter() - began

    def on_device() -> None:
        steady_orbits(**arguments, device="cuda", fetch=False)
        cuda.synchronize()

    contestants = [
        Contestant(REFERENCE, size, on_device),
        Contestant("GPU, results fetched", size, lambda: steady_orbits(**arguments, device="cuda")),
        Contestant("processor", len(few), lambda: steady_orbits(**few.arguments())),
    ]
    timings = interleaved(contestants, repetitions)
    times = timings.groupby("name")["wall_s_per_case"].median()
    relative = ratios(timings, REFERENCE, "wall_s_per_case").set_index("name")
    rows = [
        [
            name,
            f"{1e9 * times[name]:.3g} ns",
            f"{of['median']:.3g}",
            f"{of['low']:.3g} – {of['high']:.3g}",
        ]
        for name, of in relative.iterrows()
    ]
    table = markdown_table(["where", "wall time per case", "ratio", "its range"], rows)
    device = cuda.get_current_device().name
    device = device.decode() if isinstance(device, bytes) else device
    text = f"{device}; {machine()}. Compilation and first call: {compilation:.3g} s, not counted.\n"
    write_text(out / "gpu.md", f"{table}\n\n{text}")
