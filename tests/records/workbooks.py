"""Workbooks as spreadsheets write them, for tests of their readers."""

from __future__ import annotations

import zipfile

OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
STYLES = '<styleSheet><cellXfs count="2"><xf/><xf numFmtId="22" applyNumberFormat="1"/></cellXfs></styleSheet>'


def packed(path, parts):
    """An archive of parts, each a sequence of texts, which may be long together."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, texts in parts.items():
            with file.open(name, "w") as stream:
                for text in texts:
                    stream.write(text.encode())


def related(*targets):
    lines = (
        f'<Relationship Id="r{i}" Type="{OFFICE}/{kind}" Target="{target}"/>'
        for i, (kind, target) in enumerate(targets, start=1)
    )
    return [f"<Relationships>{''.join(lines)}</Relationships>"]


def xlsx(path, *sheets):
    """A workbook of sheets, each the texts of its rows; its second style of cells is a date."""
    numbers = range(1, len(sheets) + 1)
    names = "".join(f'<sheet name="s{i}" sheetId="{i}" r:id="r{i}"/>' for i in numbers)
    files = [("worksheet", f"worksheets/sheet{i}.xml") for i in numbers]
    parts = {
        "_rels/.rels": related(("officeDocument", "xl/workbook.xml")),
        "xl/workbook.xml": [f'<workbook xmlns:r="{OFFICE}"><sheets>{names}</sheets></workbook>'],
        "xl/_rels/workbook.xml.rels": related(*files, ("styles", "styles.xml")),
        "xl/styles.xml": [STYLES],
    }
    head = '<worksheet><dimension ref="A1:B2"/><sheetData>'
    for (_, name), rows in zip(files, sheets, strict=True):
        parts[f"xl/{name}"] = [head, *rows, "</sheetData></worksheet>"]
    packed(path, parts)


def row(cells, columns="", number="", style=0):
    """A row, with the letters of its columns and its number if it says them; style : of its first cell."""
    xml = ""
    for i, value in enumerate(cells):
        at = f' r="{columns[i]}{number}"' if columns else ""
        kind = ' t="str"' * isinstance(value, str) + f' s="{style}"' * (i == 0)
        xml += f"<c{at}{kind}><v>{value}</v></c>"
    return f'<row r="{number}">{xml}</row>' if columns else f"<row>{xml}</row>"
