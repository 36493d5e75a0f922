"""All benchmarks, or those named: make bench BENCH_ARGS="[PART …] [--output DIR]"."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from . import gpu, identification, loops, peers

# A further part is a module with `run(folder)`, named here.
PARTS: dict[str, Callable[[Path], None]] = {
    "peers": peers.run,
    "identification": identification.run,
    "loops": loops.run,
    "gpu": gpu.run,
}


def main(arguments: list[str] | None = None) -> None:
    """Run the parts that the command line names, all by default."""
    parser = argparse.ArgumentParser(prog="benchmarks", description=__doc__)
    parser.add_argument("parts", nargs="*", help=f"{', '.join(PARTS)} (default: all)")
    parser.add_argument("--output", type=Path, default=Path("results/benchmarks"))
    options = parser.parse_args(arguments)
    for part in options.parts or PARTS:
        if part not in PARTS:
            parser.error(f"there is no part {part}; known are {', '.join(PARTS)}")
    for part in options.parts or PARTS:
        print(f"{part} …", flush=True)
        PARTS[part](options.output)
        print((options.output / f"{part}.md").read_text(encoding="utf-8"), flush=True)


if __name__ == "__main__":
    main()
