"""Formulas of LaTeX as MathML, and the font that they are shown in.

Without a font that has a table for mathematics, browsers guess where accents and indices belong, and the dots of ẍ fall
between letters. Few machines have such a font. So pages carry what their formulas need of New Computer Modern Math,
in which the article is set, too. typst brings it along, under the GUST Font License.
"""

from __future__ import annotations

import base64
import html
import io
import re
import struct
import unicodedata
from functools import cache
from pathlib import Path

import typst
from docutils.utils.math.latex2mathml import tex2mathml
from fontTools import subset  # type: ignore[import-untyped]
from fontTools.ttLib import TTFont  # type: ignore[import-untyped]

FONT = "NewCMMath-Book"  # NewCMMath-Regular is too light for a screen
FAMILY = "New Computer Modern Math"  # as style sheets call it
_FORMULA = re.compile(r"<math\b.*?</math>", re.DOTALL)
# A function has a thin space before it, and one behind it unless its argument has brackets.
_BEFORE = re.compile(
    r"(?:(?<=</m[in]>)|(?<=</msu[bp]>))(?=<mi>[a-z]{2,}</mi><mo>&ApplyFunction;</mo>)"
)
_BEHIND = re.compile(r"(?<=<mo>&ApplyFunction;</mo>)(?!<mo[^>]*>\()")
_THIN = '<mspace width="0.167em" />'
_ITALIC = {  # what browsers show for a single letter in <mi>
    chr(int(unicodedata.decomposition(chr(code)).split()[1], 16)): chr(code)
    for code in (
        0x210E,
        *range(0x1D434, 0x1D455),
        *range(0x1D456, 0x1D468),
        *range(0x1D6E2, 0x1D71C),
    )
}


class FontError(RuntimeError):
    """The installed typst does not hold the font of formulas."""


def inline(latex: str) -> str:
    """A formula in a line of text as MathML."""
    return _spaced(tex2mathml(latex, as_block=False))


def displayed(latex: str) -> str:
    """A formula between paragraphs as HTML; on a narrow screen its parts, at \\qquad, stand below each other.

    What is still too wide scrolls in its own box, which the keyboard reaches.
    """
    parts = (_spaced(tex2mathml(part, as_block=True)) for part in latex.split(r"\qquad"))
    label = 'role="group" tabindex="0" aria-label="Equation"'
    return f'<div class="equation" {label}>{"".join(parts)}</div>'


def _spaced(mathml: str) -> str:
    lines = "".join(map(str.strip, mathml.splitlines()))
    return _BEHIND.sub(_THIN, _BEFORE.sub(_THIN, lines))


def font_face(page: str) -> str:
    """The CSS that holds the font for the formulas in this HTML, and makes it known as `FAMILY`."""
    data = base64.b64encode(font_for(page)).decode()
    source = f'url("data:font/otf;base64,{data}") format("opentype")'
    return f'@font-face {{ font-family: "{FAMILY}"; src: {source}; }}\n'


def font_for(page: str) -> bytes:
    """An OpenType font with all characters of the formulas in this HTML, and with its table for mathematics.

    Raises FontError where typst does not bring the font along.
    """
    options = subset.Options(hinting=False, desubroutinize=True, name_IDs=[0, 1, 2, 6, 13])
    options.layout_features = ["ssty"]  # the forms of indices
    options.drop_tables += ["FFTM", "PfEd"]  # notes of the editor of fonts
    font = TTFont(io.BytesIO(_whole()), recalcTimestamp=False)
    chosen = subset.Subsetter(options)
    chosen.populate(text="".join(sorted(characters(page))))
    chosen.subset(font)
    written = io.BytesIO()
    font.save(written)
    return written.getvalue()


def characters(page: str) -> set[str]:
    """The characters that the formulas in this HTML are shown with, among them italic letters and the radical sign."""
    formulas = "".join(_FORMULA.findall(page))
    plain = set(html.unescape(re.sub(r"<[^>]*>", "", formulas)))
    return plain | {_ITALIC[letter] for letter in plain & _ITALIC.keys()} | {"√"}


@cache
def _whole() -> bytes:
    """The whole font, found in typst's library by the signature of OpenType and by its name."""
    for library in sorted(Path(typst.__file__).parent.glob("_typst*")):
        data = library.read_bytes()
        for start in (match.start() for match in re.finditer(rb"OTTO\0[\x05-\x28]", data)):
            (count,) = struct.unpack_from(">H", data, start + 4)
            entries = struct.iter_unpack(">4s3L", data[start + 12 : start + 12 + 16 * count])
            tables = {tag: (offset, length) for tag, _, offset, length in entries}
            outlines = start + tables.get(b"CFF ", (0, 0))[0]
            if FONT.encode() in data[outlines : outlines + 40]:
                return data[start : start + max(map(sum, tables.values()))]
    raise FontError(f"typst does not bring {FONT} along: name one that it does in {__name__}")
