"""Text of a user shows as it is: in Markdown, in figures, on the page; numbers, shares and units as a person writes
them."""

from __future__ import annotations

import html
import math
import re

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from jinja2.utils import htmlsafe_json_dumps
from markdown_it import MarkdownIt
from matplotlib.figure import Figure

from dampbalance.project import wording as w
from dampbalance.publishing import typesetting as t
from slips import slips

TEXTS = [
    "a | b || c, costs $5, or $x$ and $\\frac{1}{2}$",
    "back\\slash \\alpha \\\\ end\\",
    "*stars* **two** _under_ __two__ snake_case F_k",
    "[a link](http:x) ![image](y) [^1] <b>",
    "# heading",
    "1. one",
    "- item",
    "===",
    "~~gone~~ H~2~O &lt; &amp; &#x41;",
    "</script><!-- comment -->",
    "plain ω/ω_n = 2.25, 10 %, a–b",
]


@pytest.mark.parametrize("text", TEXTS)
def test_text_of_a_user_is_shown_as_it_is(text):
    markdown = MarkdownIt("commonmark").enable(["table", "strikethrough"])
    page = markdown.render(w.in_markdown(text))
    assert re.fullmatch(r"<p>[^<>]*</p>\s*", page), page  # a paragraph, and no other element
    assert html.unescape(page.strip()[3:-4]) == text
    page = markdown.render(f"| a | b |\n|---|---|\n| {w.in_markdown(text)} | end |\n")
    cells = re.findall(r"<td>(.*?)</td>", page)
    assert [html.unescape(cell) for cell in cells] == [text, "end"]
    label = Figure().text(0.0, 0.5, w.in_figure(text))
    assert label._preprocess_math(label.get_text()) == (text, False)
    # X_s has its index on the page
    shown = re.sub(r"</?i>|</sub>", "", str(t.rich_markup(text)).replace("<sub>", "_"))
    assert html.unescape(shown).replace("\xa0", " ") == text
    assert not re.search("</|<!--", str(htmlsafe_json_dumps({"text": text})))


WORDS = [
    (w.percent, (math.nan,), "–"),
    (w.percent, (1e307,), "–"),  # a hundred times as much is no float
    (w.percent, (3e-11,), "10⁻⁸ %"),
    (w.percent, (9.96e-6,), "0.0010 %"),
    (w.percent, (9.64e-6,), "9.6·10⁻⁴ %"),
    (w.percent, (0.99996,), "99.99 %"),  # which is not all
    (w.percent, (1.0,), "100 %"),
    (w.percent, (12.256,), "1226 %"),
    (w.percent, (122.56,), "1.2·10⁴ %"),
    (w.percent, (0.996, 2), "99.6 %"),
    (w.signed_percent, (0.0137,), "+1.37 %"),
    (w.signed_percent, (-0.5, ""), "−50.0 %"),
    (w.signed_percent, (-math.inf,), "–"),
    (w.number_text, (9.9999, 2), "10"),
    (w.number_text, (90.0,), "90.00000"),
    (w.number_text, (math.nan,), "–"),
    (w.number_text, (-9.97e-7, 2), "−1.0·10⁻⁶"),
    (w.power_of_ten, (3e-12,), "10⁻¹¹"),  # a bound is not below what it bounds
    (w.power_of_ten, (1e-11,), "10⁻¹¹"),
    (w.signed, (1.36, 1), "+1.4"),
    (w.signed, (-0.04, 1), "0.0"),
    (w.minus, ("-0.00 to -0.05, level-1, -12",), "0.00 to −0.05, level-1, −12"),
    (w.larger_by, (0.92,), "92 %"),
    (w.larger_by, (1.0,), "a factor of 2"),
    (w.larger_by, (119.2,), "a factor of 120"),
    (w.change_text, (2.0, -0.62, "N"), "−31 %"),
    (w.change_text, (2.0, 12.28, "N"), "a factor of 7.1"),
    (w.change_text, (2.0, math.inf, "N"), "a factor of more than 1,000"),
    (w.change_text, (1e-84, 0.0413, "N"), "+0.041 N"),
    (w.change_text, (0.0, -0.0413), "−0.041"),
    (w.change_text, (0.1, -0.3, "N"), "−0.30 N"),  # less than nothing is no share
    (w.change_text, (math.nan, 1.0, "N"), "–"),
    (w.factor, (450.2,), "450"),
    (w.factor, (1e9,), "more than 1,000"),
    (w.times, (3.21,), "3.21 times"),
    (w.times, (1730.4,), "1,730 times"),
    (w.times, (2.004,), "twice"),
    (w.times, (0.2496,), "a quarter of"),
    (w.times, (0.0283,), "0.0283 times"),
    (w.rounded, (1234.567, 0.0312), "1234.567"),
    (w.rounded, (2.5, 0.0), "2.5"),
    (w.rounded, (3.21e-9, 4.6e-11), "3.210·10⁻⁹"),
    (w.unit_text, ("m^2/s",), "m²/s"),
    (w.with_unit, ("0.02", "1"), "0.02"),
    (w.label_with_unit, ("F_k", "N"), "F_k (N)"),
    (w.label_with_unit, ("residual", "1"), "residual"),
    (w.sentence, ("are two channels exchanged?",), "Are two channels exchanged?"),
    (w.sentence, ("F_k is usable",), "F_k is usable."),
    (w.plain_text, ("F_k by X_s, K_z",), "Fₖ by Xₛ, K_z"),
    (w.frequency_name, ("omega2",), "ω₂"),
    (w.frequency_name, ("resonance",), "resonance"),
    (w.visible, ("a\nb\u202e \ud800",), "a\\nb\\u202e \\ud800"),
    (w.markdown_table, (["", "n"], [["a", "1"]], "lr"), "| | n |\n|---|---:|\n| a | 1 |"),
    (t.rich_markup, ("X_s of 1 < 2",), "<i>X</i><sub>s</sub> of 1 &lt; 2"),
    (t.rich_markup, ("ω/ω_n of phi",), "ω/<i>ω</i><sub>n</sub> of <i>φ</i>"),
    (t.rich_markup, ("least_squares, 5 % at 4 mm",), "least_squares, 5\xa0% at 4\xa0mm"),
    (t.titled, ("*c* at ω₁, 4.92 Hz",), "<i>c</i> at <i>ω</i><sub>1</sub>, 4.92\xa0Hz"),
    (t.symbol, ("c by X_s",), "<i>c</i> by <i>X</i><sub>s</sub>"),
    (t.quantity_markup, ("a: norm of w",), "<i>a</i>: norm of <i>w</i>"),
    (t.quantity_markup, ("share of a bound",), "share of a bound"),
    (t.reason, ("c is mω²h, N s/m",), "<i>c</i> is <i>m</i>ω²<i>h</i>, N s/m"),
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
    of_one = (w.percent, w.signed_percent, w.part, lambda share: w.larger_by(abs(share)))
    of_both = (w.change_text(one, other, "N"), w.change_text(one, other), w.percent(one, 2))
    for text in (*(f"{function(one)}" for function in of_one), *of_both):
        assert slips(text) == []
        digits = re.sub(r"·?10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+|\D", "", text).lstrip("0")
        assert len(digits) <= 4, text
        assert text.count("−") <= 1


@given(st.floats(0.0, 1.0, exclude_max=True))
def test_only_all_is_100_percent(share):
    for digits in (1, 2, 3):
        text = w.percent(share, digits)
        assert not text.startswith("100")
        # two digits of a power of ten, and three otherwise, are within 5 % and 0.5 %
        if share > 1e-3 and digits > 1:
            shown = 0.01 * float(text.removesuffix(" %"))
            assert shown == pytest.approx(share, rel=0.5 * 10.0 ** (1 - digits) * (1.0 + 1e-9))
