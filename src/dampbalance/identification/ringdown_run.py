"""From files of free decays to what an identification hands over, and to the files it is written to."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from .. import __version__
from ..motion.jit import interpreted
from ..project.files import write_json, write_rows, write_text
from ..project.wording import visible
from ..records.limits import LARGEST
from ..records.mapping import MappingLike, mapping_for
from ..records.measurement import Measurement
from ..records.readers import RecordWarning, read
from . import ringdown_reporting as reporting
from .outputs import RING_DOWN_FIGURES
from .ringdown import RingDown, identify_ring_downs


@dataclass(frozen=True, eq=False)
class RingDownRun:
    """An identification from free decays, and what it comes from.

    options : what it was asked for, by the keys of a configuration.   files : digests of the files read for each
    record.
    """

    result: RingDown
    options: Mapping[str, Any]
    files: tuple[Mapping[str, Any], ...]

    def text(self) -> str:
        """The table for a screen."""
        return reporting.text_table(self.result)

    def document(self) -> dict[str, Any]:
        """Everything, for JSON."""
        return reporting.document(self.result, __version__, self.options, self.files)


@interpreted(False)  # a motion of thousands of samples, hundreds of times
def ring_down_files(
    paths: Sequence[Path],
    k: float,
    *,
    mapping: MappingLike = None,
    mass: float | None = None,
    largest: int = LARGEST,
    files: Sequence[Mapping[str, Any]] = (),
) -> RingDownRun:
    """F_k, c and K_z from record files of free decays.

    k : stiffness, N/m.   mapping : what the files do not say.   mass : m, kg, if it is known.   largest : numbers
    (samples × channels) that may be read of a record.   files : their digests.

    Raises RecordError and ValueError naming the file, what is wrong, and the remedy.
    """
    told: list[str] = []
    records = [_read(path, mapping, largest, told) for path in paths]
    result = identify_ring_downs(records, k, mass=mass)
    result = replace(result, warnings=(*told, *result.warnings))
    options = {
        "kind": "ring-down",
        "stiffness_N_per_m": k,
        "mass_kg": mass,
        "mapping": str(mapping) if isinstance(mapping, str | Path) else None,
        "largest": largest,
    }
    return RingDownRun(result, options, tuple(files))


def _read(path: Path, mapping: MappingLike, largest: int, told: list[str]) -> Measurement:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RecordWarning)
        measurement = replace(read(path, mapping_for(path, mapping), largest), source=str(path))
    messages = (str(w.message) for w in caught if issubclass(w.category, RecordWarning))
    told += [visible(message) for message in dict.fromkeys(messages)]
    return measurement


def write_ring_down_tables(run: RingDownRun, folder: str | Path) -> None:
    """Write TABLES to a folder, the document last."""
    folder = Path(folder)
    write_rows(folder / "identification.csv", reporting.estimates_table(run.result))
    write_rows(folder / "features.csv", reporting.features_table(run.result))
    write_text(folder / "summary.txt", run.text())
    write_json(folder / "identification.json", run.document())


def write_ring_down_figures(run: RingDownRun, folder: str | Path) -> None:
    """Write the picture of the decays to a folder."""
    from ..figures.style import save  # slow to import, and needed for pictures only
    from .drawing import DPI
    from .ringdown_drawing import alternative_text, decays

    (name,) = RING_DOWN_FIGURES
    svg, png = (Path(folder, f"{name}.{suffix}") for suffix in ("svg", "png"))
    with warnings.catch_warnings():  # a name in a script that the font lacks shows as boxes
        warnings.filterwarnings("ignore", r"Glyph .* missing from font", UserWarning)
        save(decays(run.result), svg, png, alternative_text(run.result), DPI)
