"""Writers of records as delimited text or for MATLAB; the same record gives the same bytes.

Values are 64-bit floats in SI units, under names that `read` recognises (displacement_m), next to the times. pandas
converts such a text to other formats: `pandas.read_csv("run.csv").to_parquet("run.parquet")`.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from .. import arguments
from ..arguments import instance
from ..arrays import Array
from ..project.files import replacing
from ..project.wording import shortened
from .errors import RecordError
from .readers.formats import FORMATS
from .record import Record


def write(path: str | Path, record: Record) -> Path:
    """Write a record as text (.csv with commas; .tsv, .txt, .dat, .asc with tabs) or for MATLAB 5 (.mat), depending on
    the suffix; return the file.

    Raises RecordError, before anything is written, for another suffix and for a record with a correction.
    """
    path = arguments.path("path", path, "the path of a file")
    instance("record", record, Record)
    suffix = path.suffix.lower()
    written = (*FORMATS["text"].suffixes, *FORMATS["matlab"].suffixes)
    if suffix not in written:
        raise RecordError(
            f"{path}: records are not written as {shortened(path.suffix)}, but as {', '.join(written)}; pandas or the "
            "library of a format converts one of these"
        )
    if corrected := [q for q in record if record[q].correction]:
        raise RecordError(
            f"{path}: cannot store the correction of the {corrected[0]} for gain, delay or filters; keep the "
            "original with its mapping"
        )
    columns = record.columns()
    with replacing(path) as temporary:
        if suffix == ".mat":
            _write_matlab(temporary, columns)
        else:
            # The shorter columns are empty at the end.
            frame = pd.DataFrame({name: pd.Series(values) for name, values in columns.items()})
            delimiter = "," if suffix == ".csv" else "\t"
            frame.to_csv(temporary, sep=delimiter, index=False, lineterminator="\n")
    return path


def _write_matlab(path: Path, columns: dict[str, Array]) -> None:
    from scipy.io import savemat

    savemat(path, columns, appendmat=False, oned_as="column")
    with open(path, "r+b") as stream:  # the library puts the time of day here
        # 116 bytes of description at the start of a MATLAB file
        stream.write(b"MATLAB 5.0 MAT-file, written by dampbalance".ljust(116))
