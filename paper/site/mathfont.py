"""The font of formulas, as CSS.

Without a font that has a table for mathematics, browsers guess where accents and indices belong, and the dots of ẍ fall
between letters. Few machines have such a font. So the site carries the letters and signs of formulas from New Computer
Modern Math, in which the article is set, too. typst brings it along, under the GUST Font License.
"""

from __future__ import annotations

import base64
import io
import re
import struct
from pathlib import Path

import typst
from fontTools import subset
from fontTools.ttLib import TTFont

NAME = b"NewCMMath-Book"  # NewCMMath-Regular is too light for a screen
# ASCII, Greek, thin spaces and the sign of differentiation, letters, arrows and operators, italic letters
BLOCKS = (
    (0x20, 0x7F),
    (0xA0, 0xD8),
    (0x370, 0x400),
    (0x2000, 0x2070),
    (0x2100, 0x2300),
    (0x1D434, 0x1D7CC),
)


def font_face() -> str:
    """The CSS that makes the font known as "New Computer Modern Math"."""
    options = subset.Options(hinting=False, desubroutinize=True, name_IDs=[0, 1, 2, 6, 13])
    options.layout_features = ["ssty"]  # the forms of indices
    options.drop_tables += ["FFTM", "PfEd"]  # notes of the editor of fonts
    font = TTFont(io.BytesIO(_whole()), recalcTimestamp=False)
    chosen = subset.Subsetter(options)
    chosen.populate(unicodes=[code for block in BLOCKS for code in range(*block)])
    chosen.subset(font)
    written = io.BytesIO()
    font.save(written)
    source = f"data:font/otf;base64,{base64.b64encode(written.getvalue()).decode()}"
    return f'@font-face {{ font-family: "New Computer Modern Math"; src: url("{source}"); }}\n'


def _whole() -> bytes:
    """The whole font, found in typst's library by the signature of OpenType and by its name."""
    for library in sorted(Path(typst.__file__).parent.glob("_typst*")):
        data = library.read_bytes()
        for start in (match.start() for match in re.finditer(rb"OTTO\0[\x05-\x28]", data)):
            (count,) = struct.unpack_from(">H", data, start + 4)
            entries = struct.iter_unpack(">4s3L", data[start + 12 : start + 12 + 16 * count])
            tables = {tag: (offset, length) for tag, _, offset, length in entries}
            outlines = start + tables.get(b"CFF ", (0, 0))[0]
            if NAME in data[outlines : outlines + 40]:
                return data[start : start + max(map(sum, tables.values()))]
    raise LookupError(
        f"typst does not bring {NAME.decode()} along: name one that it does in {__file__}"
    )
