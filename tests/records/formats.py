"""Records in every format that is read, as each format's own library or a spreadsheet writes them."""

from __future__ import annotations

import json
import warnings
import zipfile

import h5py
import nptdms
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pyuff
import scipy.io
from scipy.io import wavfile

# MATLAB 7.3 is HDF5 behind a block that begins with these bytes.
MATLAB_73 = b"MATLAB 7.3 MAT-file".ljust(116) + bytes(8) + b"\x00\x02IM"

# units by the end of a column's name, with the types of data that universal files give them
UNITS = {"m": ("m", 8), "m_per_s": ("m/s", 11), "m_per_s2": ("m/s2", 12), "N": ("N", 13)}


def of_name(name):
    """The quantity, the unit and the type in universal files of a column, displacement_m."""
    end = max((end for end in UNITS if name.endswith(f"_{end}")), key=len)
    return name.removesuffix(f"_{end}"), *UNITS[end]


def write_columns(path, columns, matlab_73=False):
    """Write columns by their names, which end in a unit, in the format of the suffix, times first; give the path.

    A WAV gets a whole number of samples per second and a mapping next to it.
    """
    match path.suffix:
        case ".csv" | ".tsv":
            pd.DataFrame(columns).to_csv(path, index=False, sep=",\t"[path.suffix == ".tsv"])
        case ".parquet":
            pq.write_table(pa.table(columns), path)
        case ".mat" if not matlab_73:
            scipy.io.savemat(path, columns, do_compression=True, oned_as="column")
        case ".mat" | ".h5":
            with h5py.File(path, "w", userblock_size=512 if matlab_73 else 0) as file:
                for name, values in columns.items():
                    # A column of MATLAB, n × 1, is stored 1 × n.
                    data = file.create_dataset(name, data=[values] if matlab_73 else values)
                    if matlab_73:
                        data.attrs["MATLAB_class"] = np.bytes_("double")
            if matlab_73:
                with open(path, "r+b") as stream:
                    stream.write(MATLAB_73)
        case ".uff":
            (_, t), *signals = columns.items()
            write_uff(path, [uff_set(t, *signal) for signal in signals])
        case ".tdms":
            with nptdms.TdmsWriter(str(path)) as file:
                file.write_segment(
                    [nptdms.ChannelObject("g", name, v) for name, v in columns.items()]
                )
        case ".wav":
            (_, t), *signals = columns.items()
            samples = np.stack([values for _, values in signals], axis=1)
            wavfile.write(path, round((len(t) - 1) / (t[-1] - t[0])), samples)
            units = [of_name(name)[:2] for name, _ in signals]
            rules = {q: {"channel": i, "unit": unit} for i, (q, unit) in enumerate(units, start=1)}
            path.with_name(f"{path.name}.yaml").write_text(json.dumps({"channels": rules}))
    return path


def text_file(path, head, columns, delimiter=",", decimal=".", encoding="utf-8", end="\n"):
    """Write the lines of a head and rows as text; give the path."""
    rows = (delimiter.join(map(repr, row)) for row in np.column_stack(columns).tolist())
    lines = [*head, *(row.replace(".", decimal) for row in rows), ""]
    path.write_bytes(end.join(lines).encode(encoding))
    return path


def uff_set(t, name, values):
    quantity, unit, kind = of_name(name)
    return {
        "type": 58, "binary": 1, "func_type": 1, "rsp_node": 1, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3,
        "abscissa_spacing": 0, "abscissa_spec_data_type": 17, "orddenom_spec_data_type": 0, "x": t, "data": values,
        "id1": quantity, "ordinate_axis_units_lab": unit, "ordinate_spec_data_type": kind,
    }  # fmt: skip


def write_uff(path, sets):
    """Write data sets of a universal file."""
    with warnings.catch_warnings():
        # pyuff leaves closing to the garbage collector; "overwrite" loses the header of a binary set
        warnings.simplefilter("ignore", ResourceWarning)
        path.unlink(missing_ok=True)
        pyuff.UFF(str(path)).write_sets(sets, mode="add")


# Workbooks

OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
STYLES = '<styleSheet><cellXfs count="2"><xf/><xf numFmtId="22" applyNumberFormat="1"/></cellXfs></styleSheet>'


def related(*targets):
    lines = (
        f'<Relationship Id="r{i}" Type="{OFFICE}/{kind}" Target="{target}"/>'
        for i, (kind, target) in enumerate(targets, start=1)
    )
    return f"<Relationships>{''.join(lines)}</Relationships>"


def xlsx(path, *sheets):
    """A workbook of sheets, each the texts of its rows; its second style of cells is a date."""
    numbers = range(1, len(sheets) + 1)
    names = "".join(f'<sheet name="s{i}" sheetId="{i}" r:id="r{i}"/>' for i in numbers)
    files = [("worksheet", f"worksheets/sheet{i}.xml") for i in numbers]
    parts = {
        "_rels/.rels": related(("officeDocument", "xl/workbook.xml")),
        "xl/workbook.xml": f'<workbook xmlns:r="{OFFICE}"><sheets>{names}</sheets></workbook>',
        "xl/_rels/workbook.xml.rels": related(*files, ("styles", "styles.xml")),
        "xl/styles.xml": STYLES,
    }
    head = '<worksheet><dimension ref="A1:B2"/><sheetData>'
    for (_, name), rows in zip(files, sheets, strict=True):
        parts[f"xl/{name}"] = "".join([head, *rows, "</sheetData></worksheet>"])
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, text in parts.items():
            file.writestr(name, text)


def row(cells, style=0):
    """A row; style : of its first cell."""
    kinds = (
        ' t="str"' * isinstance(v, str) + f' s="{style}"' * (i == 0) for i, v in enumerate(cells)
    )
    return (
        f"<row>{''.join(f'<c{k}><v>{v}</v></c>' for k, v in zip(kinds, cells, strict=True))}</row>"
    )
