"""The files of a study: one Parquet file of all cases, written a part and read a column at a time, and a manifest.

The table has a row per case. Column names end in their unit, or name a pure number; the metadata of the file
hold unit and meaning of each column, too. The same study gives the same bytes, whatever the number of cores or the
order of chunks.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from ..arrays import Words
from ..law.terms import KNOWN_TERMS
from ..project.files import replacing, write_json
from .cases import REGIME_NAMES, case_columns
from .study_file import CONTACT, Listed, Study

CasesLike: TypeAlias = str | Path | pd.DataFrame
"""The table of cases: its file, or the table itself."""

MANY = 100_000
"""From this number of cases on the table is written uncompressed: distinct numbers hardly compress, and compressing
them takes longer than computing them."""


def column_of(cases: CasesLike, name: str) -> Words:
    """Return one column of the table of cases."""
    if isinstance(cases, pd.DataFrame):
        return cases[name].to_numpy()
    with pq.ParquetFile(cases) as file:
        return file.read([name])[name].to_numpy()


def terms_of(cases: CasesLike) -> list[str]:
    """Return the symbols of the coefficients, K_z among them, whose errors the table of cases holds."""
    columns = cases.columns if isinstance(cases, pd.DataFrame) else pq.read_schema(cases).names
    symbols = {column.partition("_relative_error__")[0] for column in columns}
    return [symbol for symbol in (*KNOWN_TERMS, CONTACT) if symbol in symbols]


def write_parts(
    path: str | Path, parts: Iterable[pd.DataFrame], study: Study, version: str
) -> None:
    """Write the cases of a chunk that come in parts, a row group each; the file appears complete or not at all."""
    schema = _schema(study, version)

    def array(values: Any, kind: pa.DataType) -> pa.Array:
        if not pa.types.is_dictionary(kind):
            return pa.array(values, kind)
        codes, words = pd.factorize(values, sort=True)
        coded = pa.array(codes, pa.int32()), pa.array(list(words), pa.string())
        return pa.DictionaryArray.from_arrays(*coded)

    columns = ([array(part[of.name].to_numpy(), of.type) for of in schema] for part in parts)
    _write(path, (pa.Table.from_arrays(each, schema=schema) for each in columns), schema, study)


def _write(path: str | Path, tables: Iterable[pa.Table], schema: pa.Schema, study: Study) -> None:
    """Write tables as row groups of one file."""
    with (
        replacing(path) as temporary,
        pq.ParquetWriter(temporary, schema, **_packing(study)) as writer,
    ):
        for table in tables:
            writer.write_table(table, row_group_size=max(table.num_rows, 1))


def join_chunks(path: str | Path, chunks: Sequence[str | Path], study: Study) -> None:
    """Write the row groups of the chunks one after the other into one file, holding one in memory at a time."""
    tables = (
        file.read_row_group(group)
        for file in map(pq.ParquetFile, chunks)
        for group in range(file.num_row_groups)
    )
    _write(path, tables, pq.read_schema(chunks[0]), study)


def write_manifest(path: str | Path, cases: str | Path, study: Study, version: str) -> None:
    """Write what the table of cases is: study, version, seeds, settings, cases per regime, columns with units."""
    counts = Counter(column_of(cases, "regime"))
    seen = {word for pattern in counts for word in pattern.split(", ")}
    write_json(
        path,
        {
            "study": study.name,
            "dampbalance": version,
            "cases": study.cases,
            "levels": list(study.levels),
            "levels_are": "multiples of Y_m" if study.levels_relative else "m",
            "seeds": study.seeds,
            "cases_per_regime": dict(sorted(counts.items(), key=lambda item: (-item[1], item[0]))),
            "regimes": {name: words for words, name in REGIME_NAMES.items() if name in seen},
            "settings": dict(study.settings),
            "columns": [column._asdict() for column in case_columns(study)],
        },
    )


def _packing(study: Study) -> dict[str, Any]:
    """Return how the columns are compressed."""
    packed: dict[str, Any] = {"write_statistics": False, "compression_level": 1}
    if study.cases < MANY:
        return packed | {"compression": "zstd"}
    listed = {name for b in study.blocks if isinstance(b, Listed) for name in b.axes}
    columns = case_columns(study)
    repeated = [c.name for c in columns if c.words or c.name in listed]
    kinds = {c.name: "zstd" if c.name in repeated else "none" for c in columns}
    levels = dict.fromkeys(repeated, 1)
    return packed | {"use_dictionary": repeated, "compression": kinds, "compression_level": levels}


def _schema(study: Study, version: str) -> pa.Schema:
    """Return names, types, units and meanings of the columns; the study and its settings as metadata of the file."""
    words, fields = pa.dictionary(pa.int32(), pa.string()), []
    for c in case_columns(study):
        kind = words if c.words else pa.int64() if c.name == "case" else pa.float64()
        fields.append(pa.field(c.name, kind, metadata={"unit": c.unit, "meaning": c.meaning}))
    settings = json.dumps(study.settings, sort_keys=True, ensure_ascii=False)
    about = {"study": study.name, "dampbalance": version, "settings": settings}
    return pa.schema(fields, metadata=about)
