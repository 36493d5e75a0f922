"""A case so small that it is built in seconds, in a copy of the whole project."""

from __future__ import annotations

import shutil
from pathlib import Path
from urllib.parse import unquote

from dampbalance.publishing.provenance.sources import files_of, sha256

ROOT = Path(__file__).parents[2]
CONFIGURATION = """\
case: tiny
excitation:
  frequencies: [{name: resonance, hz: 4.9}]
  levels_m: [0.004, 0.012]
estimation:
  pairs: [[1, 2]]
as_published: {step_s: 5.0e-5, cycles: 4}
published: null
"""
TINY = ("--configfile", "tiny.yaml")


def whole(checkout):
    """The copy, completed to the whole project, with the configuration of the tiny case."""
    for file in files_of(ROOT):
        target = checkout.folder / file
        if not target.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / file, target)
    (checkout.folder / "tiny.yaml").write_text(CONFIGURATION, encoding="utf-8")
    return checkout


def digests_hold(crate, folder):
    """Compare the digest of every file of a crate; returns how many there are, and those without one."""
    files = [entity for entity in crate.data_entities if entity.type == "File"]
    without = []
    for entity in files:
        path = folder / unquote(entity.id)
        assert path.is_file(), entity.id
        if entity.get("sha256") is None:
            without.append(entity.id)
        else:
            assert entity["sha256"] == sha256(path), entity.id
    return len(files), without
