"""Text of a user shows as it is: in Markdown, in figures, on the page; numbers, shares and units as a person writes
them."""

from __future__ import annotations

import html
import math
import re
from xml.etree import ElementTree

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from jinja2.utils import htmlsafe_json_dumps
from markdown_it import MarkdownIt
from matplotlib.figure import Figure

from dampbalance.figures.style import save
from dampbalance.project.wording import (
    change_text,
    factor,
    in_figure,
    in_markdown,
    label_with_unit,
    larger_by,
    markdown_table,
    minus,
    number_text,
    part,
    percent,
    sentence,
    signed,
    signed_percent,
    times,
    unit_text,
    with_unit,
)
from dampbalance.publishing.typesetting import rich_markup
from slips import KINDS, slips

TEXTS = [
    "<script>alert('x')</script>",
    "a | b || c",
    "costs $5, or $x$ and $\\frac{1}{2}$",
    "back\\slash \\alpha \\\\ end\\",
    "`code` and ``more``",
    "*stars* **two** _under_ __two__ snake_case F_k",
    "[a link](http:x) ![image](y) [^1] <b>",
    "# heading",
    "1. one",
    "- item",
    "+ item",
    "===",
    "~~gone~~ H~2~O",
    "&lt; &amp; &#x41;",
    "</script><!-- comment -->",
    "plain ω/ω_n = 2.25, 10 %, a–b",
]


def in_html(text):
    return MarkdownIt("commonmark").enable(["table", "strikethrough"]).render(text)


@pytest.mark.parametrize("text", TEXTS)
def test_markdown_shows_the_text(text):
    page = in_html(in_markdown(text))
    assert re.fullmatch(r"<p>[^<>]*</p>\s*", page), page  # a paragraph, and no other element
    assert html.unescape(page.strip()[3:-4]) == text.strip()


@pytest.mark.parametrize("text", TEXTS)
def test_a_cell_of_a_markdown_table_shows_the_text(text):
    page = in_html(f"| a | b |\n|---|---|\n| {in_markdown(text)} | end |\n")
    cells = re.findall(r"<td>(.*?)</td>", page)
    assert [html.unescape(cell) for cell in cells] == [text.strip(), "end"]


@pytest.mark.parametrize("text", TEXTS)
def test_a_figure_shows_the_text(tmp_path, text):
    figure = Figure(figsize=(8, 1))
    label = figure.text(0.0, 0.5, in_figure(text))
    assert label._preprocess_math(label.get_text()) == (text, False)
    save(figure, tmp_path / "a.svg", tmp_path / "a.png", text)
    described = ElementTree.parse(tmp_path / "a.svg").getroot().itertext()
    assert text in "".join(described)


@pytest.mark.parametrize("text", TEXTS)
def test_the_page_shows_the_text(text):
    shown = re.sub(
        r"</?i>|</sub>", "", str(rich_markup(text)).replace("<sub>", "_")
    )  # X_s has its index
    assert html.unescape(shown).replace("\xa0", " ") == text
    script = str(htmlsafe_json_dumps({"text": text}))
    assert "</" not in script
    assert "<!--" not in script


def test_a_table_in_markdown():
    rows = [["a", "b", "1"], ["", "c", "2"]]
    assert markdown_table(["", "name", "n"], rows, "llr").splitlines() == [
        "| | name | n |",
        "|---|---|---:|",
        "| a | b | 1 |",
        "|  | c | 2 |",
    ]
    assert markdown_table(["x", "y"], []) == "| x | y |\n|---|---|"


# --- numbers, shares, units ---------------------------------------------------------------------------------------

WORDS = [
    (percent, (0.0,), "0 %"),
    (percent, (-0.0,), "0 %"),
    (percent, (math.nan,), "–"),
    (percent, (math.inf,), "–"),
    (percent, (1e307,), "–"),  # a hundred times as much is no float
    (percent, (3e-11,), "10⁻⁸ %"),
    (percent, (9.96e-6,), "0.0010 %"),
    (percent, (9.64e-6,), "9.6·10⁻⁴ %"),
    (percent, (1.5e-4,), "0.0150 %"),
    (percent, (0.099996,), "10.0 %"),
    (percent, (-0.658,), "65.8 %"),
    (percent, (0.9997,), "99.97 %"),
    (percent, (0.99996,), "99.99 %"),  # which is not all
    (percent, (1.0,), "100 %"),
    (percent, (12.256,), "1226 %"),
    (percent, (122.56,), "1.2·10⁴ %"),
    (percent, (0.996, 2), "99.6 %"),
    (percent, (0.0478, 2), "4.8 %"),
    (signed_percent, (0.0137,), "+1.37 %"),
    (signed_percent, (-0.658,), "−65.8 %"),
    (signed_percent, (0.5, ""), "50.0 %"),
    (signed_percent, (-0.5, ""), "−50.0 %"),
    (signed_percent, (-0.0,), "0 %"),
    (signed_percent, (-math.inf,), "–"),
    (number_text, (9.9999, 2), "10"),
    (number_text, (-0.0,), "0"),
    (number_text, (-2.5, 3), "−2.50"),
    (number_text, (9.97e-7, 2), "1.0·10⁻⁶"),
    (number_text, (math.nan,), "–"),
    (signed, (1.36, 1), "+1.4"),
    (signed, (-0.3, 1), "−0.3"),
    (signed, (-0.04, 1), "0.0"),
    (signed, (0.4,), "0"),
    (minus, ("-0.00 to -0.05, level-1, -12",), "0.00 to −0.05, level-1, −12"),
    (part, (0.01,), "1 %"),
    (part, (0.0478,), "4.8 %"),
    (part, (6.1,), "610 %"),
    (larger_by, (0.92,), "92 %"),
    (larger_by, (1.0,), "a factor of 2"),
    (larger_by, (6.14,), "a factor of 7.1"),
    (larger_by, (119.2,), "a factor of 120"),
    (larger_by, (4.1e83,), "a factor of more than 1000"),
    (change_text, (2.0, 0.1), "+5 %"),
    (change_text, (2.0, -0.62, "N"), "−31 %"),
    (change_text, (2.0, 12.28, "N"), "a factor of 7.1"),
    (change_text, (2.0, math.inf, "N"), "a factor of more than 1000"),
    (change_text, (1e-84, 0.0413, "N"), "+0.041 N"),
    (change_text, (0.0, -0.0413), "−0.041"),
    (change_text, (0.1, -0.3, "N"), "−0.30 N"),  # less than nothing is no share
    (change_text, (2.0, 0.0, "N"), "0 %"),
    (change_text, (math.nan, 1.0, "N"), "–"),
    (factor, (3.21,), "3.2"),
    (factor, (450.2,), "450"),
    (factor, (1e9,), "more than 1000"),
    (times, (3.21,), "3.2 times"),
    (unit_text, ("m^2/s",), "m²/s"),
    (unit_text, ("1",), ""),
    (with_unit, ("0.5", "N"), "0.5 N"),
    (with_unit, ("0.02", ""), "0.02"),
    (with_unit, ("0.02", "1"), "0.02"),
    (label_with_unit, ("F_k", "N"), "F_k (N)"),
    (label_with_unit, ("eta", ""), "eta"),
    (label_with_unit, ("residual", "1"), "residual"),
    (sentence, ("are two channels exchanged?",), "Are two channels exchanged?"),
    (sentence, ("a gap",), "A gap."),
    (sentence, ("a gap.",), "A gap."),
    (sentence, ("F_k is usable",), "F_k is usable."),
    (sentence, ("level1.csv: a gap",), "level1.csv: a gap."),
]


@pytest.mark.parametrize(("function", "of", "words"), WORDS)
def test_a_formatter_writes_as_a_person_would(function, of, words):
    assert f"{function(*of)}" == words


NUMBERS = st.floats(allow_nan=True, allow_infinity=True, allow_subnormal=True)


@given(NUMBERS, NUMBERS)
@example(-0.0, 0.0)
@example(-1e-320, -5e-324)
@example(0.99996, 4.133e81)
@example(math.inf, math.nan)
def test_no_share_or_change_slips_out(one, other):
    """Four significant digits at the most, powers of ten apart, and none of the words that slip out of a program."""
    shares = [percent(one), percent(one, 2), signed_percent(one), part(one), larger_by(abs(one))]
    for text in map("{}".format, [*shares, change_text(one, other, "N"), change_text(one, other)]):
        assert slips(text) == []
        digits = re.sub(r"·?10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+|\D", "", text).lstrip("0")
        assert len(digits) <= 4, text
        assert text.count("−") <= 1


@given(st.floats(0.0, 1.0, exclude_max=True))
def test_only_all_is_100_percent(share):
    for digits in (1, 2, 3):
        text = percent(share, digits)
        assert not text.startswith("100")
        # two digits of a power of ten, and three otherwise, are within 5 % and 0.5 %
        if share > 1e-3 and digits > 1:
            shown = 0.01 * float(text.removesuffix(" %"))
            assert shown == pytest.approx(share, rel=0.5 * 10.0 ** (1 - digits) * (1.0 + 1e-9))


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("rho by up to +12256 %", "an internal name"),
        ("F_k by +12256 %", "a share of more than four digits"),
        ("changes F_k by +6.1e+02 %", "a power of ten of a program"),
        (
            "up to 413345686774928024750240204289814132 % stiffer",
            "a share of more than four digits",
        ),
        ("the response lags the drive by −1753 ± 2 µs", "a negative lag"),
        ("are two channels exchanged?.", "two marks"),
        ("at 0.10200000000000001 s", "rounding"),
        ("residual norm ()", "no unit"),
        ("off by -0.0 %", "a minus of zero"),
        ("from −0.0° on", "a minus of zero"),
        ("+−3 %", "two signs"),
        ("eta = 0.02 , c = 1", "a gap"),
        ("nan %", "a number that is none"),
    ],
)
def test_slips_are_seen(text, kind):
    assert kind in [one for one, _ in slips(text)]


def test_what_a_person_writes_is_no_slip():
    assert len(KINDS) == 11
    text = "−0.05 to 0.5 %, 10⁻¹¹ %, 1.2·10⁻³ N, a … b, is it? F_k (N); −60 ± 150 µs, 2310±10, p < 1e-6, 200000 N/m."
    assert slips(text) == []
