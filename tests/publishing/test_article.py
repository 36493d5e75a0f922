"""The built article prints the numbers of its files, and the PDF is an archive with them in it."""

from __future__ import annotations

import csv
import json
import math
import re
import shutil
from decimal import Decimal
from functools import lru_cache
from pathlib import Path

import pytest
from pypdf import PdfReader

from dampbalance.figures.style import DARK, follows_the_screen
from dampbalance.publishing.article import compiling
from publishing.article_case import INPUTS, SOURCES

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def values(article) -> dict:
    return article.printed()


@pytest.fixture(scope="module")
def reader(article) -> PdfReader:
    return PdfReader(article.pdf)


@lru_cache
def content(path: Path) -> list[dict[str, str]]:
    """Return the rows of a result file, as text, read without the code under test."""
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


WHAT = ("frequency", "quantity", "approach", "kind", "phase", "sharing", "line")
"""The columns of the table of numbers that say what a number is, besides its unit."""


def raw(article, value: dict) -> str:
    """Return the entry in the file that a value names."""
    row = content(article.folder / value["file"])[value["line"] - 2]
    if row["id"] != value["id"]:  # nothing is printed of it: its id says what it is
        said = [row[column] for column in WHAT if row[column] not in ("", "all")]
        said += ["error"] if row["unit"] == "%" else []
        assert sorted(said) == sorted(value["id"].split(".")), value["key"]
    return row[value["column"]]


ASCII = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789", "\u2009")
WORDS = ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"]


def number(text: str) -> tuple[float, float]:
    """Return the printed number and one unit of its last digit."""
    if text in WORDS:
        return WORDS.index(text), 0.0
    mantissa, _, exponent = text.translate(ASCII).replace("10-", "10^-").partition("·10")
    if not exponent and mantissa.startswith("10^"):
        return 10.0 ** int(mantissa[3:]), 0.0
    power = 10.0 ** int(exponent.removeprefix("^") or 0)
    return float(mantissa) * power, 10.0 ** Decimal(mantissa).as_tuple().exponent * power


def agrees(value: dict, entry: str) -> bool:
    """Return whether the printed text is that entry: rounded, in the scale stated, below a bound, or word for word."""
    style = value["style"]
    if style["form"] == "text":
        return value["text"] == entry
    if value["text"] == "–":
        return entry == ""
    wanted = float(entry) * float(style["scale"])
    wanted = abs(wanted) if style["unsigned"] else wanted
    shown, unit = number(value["text"])
    if style["form"] == "bound":
        return wanted <= shown < 10.0 * wanted or wanted == shown == 0.0
    return math.isclose(shown, wanted, rel_tol=1e-13, abs_tol=0.5 * unit * (1.0 + 1e-9))


def test_every_value_is_what_its_file_says_and_one_that_is_off_by_a_digit_is_not(article, values):
    assert len(values) > 700
    changed = 0
    for key, value in values.items():
        entry = raw(article, value)
        assert agrees(value, entry), key
        if value["style"]["form"] not in ("text", "word", "bound") and value["text"] != "–":
            mantissa, dot, exponent = value["text"].partition("·")
            last = (int(mantissa[-1]) + 1) % 10
            changed += 1
            assert not agrees(value | {"text": f"{mantissa[:-1]}{last}{dot}{exponent}"}, entry), key
    assert changed > 500


BY_HAND = {
    # as the paper prints them, in the units of the article's tables
    "parameter.F_k": "1.28",
    "table1.Y.5": "12",
    "table1.X.1.printed": "2.73",
    "table2.W.1.printed": "79.39719",
    "claim.text.max_error_F_k.printed": "1.5",
    # by arithmetic
    "swing": "12.308",  # 2 F_k/K_z = 2.56/208 000 m
    "parameter.omega1_natural": "4.9172",  # sqrt(2310/2.42)/2π
    "added": "0.0116",  # mω²h = 2.42 (2π 4.92)² 5e-6 = 0.01156
    "effective": "90.0114",  # 37.19 · 2.42 + mω²h
    "c_over_m": "37.19",  # 90/2.42 = 37.190083
    "dev.W": "−1.27·10⁻⁴",  # 0.81655453/0.816658098 − 1
    "c.backward-euler": "90.0114",  # 37.19 · 2.42 + 0.01156, as the paper prints it
    # a_1 b_2 − a_2 b_1 = 7.6911e-6, beside 4 Z_m (b_2 − b_1) = 2.46154e-5 · 1.15010e-3 = 2.8310e-8
    "study.rigid_contact.pair_F_omega1": "−0.367 %",
    "study.rigid_contact.paper_K_z_over_k": "90.04329",  # 208 000/2310
    # of the studies' files and of CITATION.cff
    "range.contact_stiffness.K_z_over_k.high": "1\u2009000\u2009000",
    "study.step_size.coarsest_step_s": "80",
    # known from an earlier computation with other code
    "spread.omega2.reversal": "0.48",
    "error.omega3.F_k.least_squares.X_s.reversal.common": "−66",
    "error.omega2.F_k.largest.X_s.zero_crossing.individual": "6.3",
    "error.omega1.F_k.least_squares.fourier": "+0.021",
    "b_fifth.omega2.size": "0.012",
    "rebuilt.b.first": "1.6·10⁻⁵",
    "W_shared.omega3.first": "−8.3",
    "W_shared_right.omega3.last": "+5.1",
    "rounding.omega1.table_1.median": "3.5",
    "c.print_but_first": "90.0113",
    "chance.but_V_s.p": "0.47",
    # counted in `config/config.yaml`: four that have a name, two roundings, five starts of a, six rules of reading
    "choices.discrete": "17",
    "table_3.inputs": "nine",  # X_1 … X_5, X + X_s, t_s, φ, the sign
    "table_3.given_by_exact_X": "six",
}


def test_the_values_speak_of_the_case(values):
    """Keys, places, scales and the numbers behind them agree with numbers that are known otherwise."""
    assert {key: values[key]["text"] for key in BY_HAND} == BY_HAND
    # the as-published route reads a between samples; a whole one off would be another rule of reading
    assert number(values["rebuilt.a.samples"]["text"])[0] < 1.0


def test_the_article_is_an_archive_with_its_values_and_claims_in_it(article, values, reader):
    attached = {Path(name).name: contents[0] for name, contents in reader.attachments.items()}
    tables = {Path(file).name: (article.folder / file).read_bytes() for file in SOURCES}
    assert attached == {**tables, "values.json": attached["values.json"]}
    listed = json.loads(attached["values.json"])
    assert listed["values"] == values
    assert {value["file"] for value in values.values()} == SOURCES.keys()
    assert {source["file"]: source["rule"] for source in listed["sources"]} == SOURCES
    for value in values.values():
        assert listed["sources"][value["source"] - 1]["file"] == value["file"]
    packet = reader.xmp_metadata.stream.get_data().decode()
    assert re.search(r"pdfaid:part>3<.*pdfaid:conformance>A<", packet, re.DOTALL)
    assert re.search(r"pdfuaid:part>1<", packet)
    assert reader.metadata.author == "the dampbalance authors"
    assert reader.metadata.creator.startswith("Typst ")


def test_the_article_is_as_long_as_a_conference_paper(reader):
    pages = [page.extract_text() for page in reader.pages]
    (first,) = (n for n, text in enumerate(pages) if text.startswith("Supplement\n"))
    assert first <= 8
    assert len(pages) - first <= 9


def test_the_same_bytes_each_time_and_wherever_the_results_are_kept(article, tmp_path):
    kept = shutil.copytree(article.folder / "results", tmp_path / "ours/results")
    afresh = INPUTS | {"unread": "so that typst does not take what it has laid out before"}
    made = compiling.article(article.folder / "paper/article", kept, afresh)
    assert made == article.pdf.read_bytes()


def test_every_figure_can_be_read_and_has_a_dark_partner_of_each_colour(article):
    """In figures of the article and of its studies no text lies on another, and every colour is of the palette."""
    files = [*article.folder.glob("results/**/*.svg")]
    assert len(files) == len(article.faults) == 14
    assert {name for name, found in article.faults.items() if found} == set()
    palette = {colour.lower() for colour in DARK}
    for file in files:
        svg = file.read_text(encoding="utf-8")
        colours = set(re.findall(r"\b(?:fill|stroke): (#\w+)", svg))
        assert colours - palette == set(), file
        rules = follows_the_screen(svg).partition("<style>")[2].partition("</style>")[0]
        assert all(f": {colour}" in rules for colour in colours)


def test_a_changed_result_changes_the_page_and_a_missing_one_stops_the_build(article, tmp_path):
    """Article and results in another folder: another number in a result file is printed in its place, and an address
    where CITATION.cff states one."""

    def text(pdf):
        return [" ".join(page.extract_text().split()) for page in PdfReader(pdf).pages]

    changed = article.copy(tmp_path)
    changed.change("largest.fourier.F_k", 77.774)
    changed.change("software.address.commit", "0123abc")
    changed.typeset()
    before, after = text(article.pdf), text(changed.pdf)
    assert "78" not in before[0].split()
    assert "78" in after[0].split()
    unstated, stated = "names no public address", "states for it: commit 0123abc"
    assert [any(words in page for page in before) for words in (unstated, stated)] == [True, False]
    assert [any(words in page for page in after) for words in (unstated, stated)] == [False, True]
    changed.change("added")
    made = changed.pdf.read_bytes()
    with pytest.raises(SystemExit, match="no result has added"):
        changed.typeset()
    assert changed.pdf.read_bytes() == made


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ('#text(font: "No Such Font")[Text]', "warnings"),
        ("$x$", "alt text"),
        ("#nothing", "unknown variable"),
    ],
)
def test_what_typst_complains_about_stops_the_build(tmp_path, source, message):
    text = f'#set document(title: "t")\n= A\n{source}'
    (tmp_path / "a.typ").write_text(text, encoding="utf-8")
    with pytest.raises(compiling.ArticleError, match=message):
        compiling.pdf(tmp_path / "a.typ", tmp_path, {})
