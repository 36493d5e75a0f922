#!/usr/bin/env python3
"""Compute a study on this machine alone and through SLURM, in a copy of the sources each, and compare every byte.

    export PYTHONPATH=trials:tests
    trials/cluster/loopback.sh .venv/bin/python -m cluster.same_bytes map

On a cluster, with a folder that its nodes see: python -m cluster.same_bytes --folder SHARED/FOLDER map

Exit status: 0 if all files are the same, 1 if not or if a run fails.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml

from folders import ROOT
from same_results import different, names_of
from workflow.copies import copied

LOCAL = ("-m", "snakemake", "--cores", "all")
SLURM = (
    *("-m", "snakemake", "--profile", "workflow/profiles/slurm"),
    *("--slurm-init-seconds-before-status-checks", "2"),
)


def make_smaller(folder: Path, study: str, changes: Path) -> None:
    """Replace keys of the study in a copy by those of the file of the same name in `changes`."""
    file = folder / "config/studies" / f"{study}.yaml"
    documents = [
        yaml.safe_load(path.read_text(encoding="utf-8")) for path in (file, changes / file.name)
    ]
    file.write_text(
        yaml.safe_dump(documents[0] | documents[1], allow_unicode=True), encoding="utf-8"
    )


def compute(folder: Path, study: str, how: tuple[str, ...]) -> float:
    """Compute the study in a copy of the sources; the seconds it took."""
    environment = os.environ | {
        "PYTHONPATH": str(folder / "src"),
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
    }
    command = [sys.executable, *how, f"results/studies/{study}/summary.md"]
    begun = time.perf_counter()
    subprocess.run(command, cwd=folder, env=environment, check=True)
    return time.perf_counter() - begun


def main(study: str, parent: Path | None, changes: Path | None) -> int:
    """Return both runs, and what came out, on stdout."""
    top = Path(tempfile.mkdtemp(prefix="same_bytes.", dir=parent))
    try:
        results = []
        for name, how in (("local", LOCAL), ("slurm", SLURM)):
            copied(ROOT, top / name)
            if changes:
                make_smaller(top / name, study, changes)
            print(f"{name}: {compute(top / name, study, how):.1f} s", flush=True)
            results.append(top / name / "results/studies" / study)
        unequal = different(*results)
        files = names_of(results[0])
        size = sum((results[0] / name).stat().st_size for name in files)
        for name in unequal:
            print(f"different: {name}")
        print(f"{len(files)} files, {size:,} bytes: {'different' if unequal else 'the same'}")
    except subprocess.CalledProcessError as error:
        print(f"error: {name} run failed ({error.returncode})", file=sys.stderr)
        return 1
    finally:
        shutil.rmtree(top, ignore_errors=True)
    return 1 if unequal else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("study", nargs="?", default="map")
    parser.add_argument("--folder", type=Path, help="where to put the copies; the temporary folder")
    parser.add_argument("--config-of", type=Path, help="folder with keys to replace in the study")
    options = parser.parse_args()
    sys.exit(main(options.study, options.folder, options.config_of))
