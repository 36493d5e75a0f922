"""The built article prints the numbers of its files, and the PDF is an archive that can be read aloud."""

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
from pypdf.generic import ArrayObject, IndirectObject

from dampbalance.figures.style import DARK, STYLE, follows_the_screen
from dampbalance.publishing.article import compiling
from publishing.article_case import INPUTS, SOURCES
from replication.routes import ROOT

pytestmark = pytest.mark.slow

# --- the values ---------------------------------------------------------------------------


@pytest.fixture(scope="module")
def values(article) -> dict:
    return article.printed()


@lru_cache
def content(path: Path) -> list[dict[str, str]]:
    """Return the rows of a result file, as text, read without the code under test."""
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


WHAT = ("frequency", "quantity", "approach", "kind", "phase", "sharing", "line")
"""The columns of the table of numbers that say what a number is, besides its unit."""


def raw(article, value: dict) -> str:
    """Return the entry in the file that a value names."""
    rows = content(article.folder / value["file"])
    row = rows[value["line"] - 2]
    if row["id"] != value["id"]:  # nothing is printed of it: its id says what it is
        said = [row[column] for column in WHAT if row[column] not in ("", "all")]
        said += ["error"] if row["unit"] == "%" else []
        assert sorted(said) == sorted(value["id"].split(".")), value["key"]
    assert [*csv.DictReader([",".join(row), *_lines(article, value)])] == [row]
    return row[value["column"]]


def _lines(article, value: dict) -> list[str]:
    text = (article.folder / value["file"]).read_text(encoding="utf-8")
    return text.split("\n")[value["line"] - 1 : value["line"]]


ASCII = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789", "\u2009")


def number(text: str) -> tuple[float, float]:
    """Return the printed number and one unit of its last digit."""
    mantissa, _, exponent = text.translate(ASCII).replace("10-", "10^-").partition("·10")
    if not exponent and mantissa.startswith("10^"):
        return 10.0 ** int(mantissa[3:]), 0.0
    power = 10.0 ** int(exponent.removeprefix("^") or 0)
    return float(mantissa) * power, 10.0 ** Decimal(mantissa).as_tuple().exponent * power


WORDS = ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"]


def agrees(value: dict, entry: object) -> bool:
    """Return whether the printed text is that entry: rounded, in the scale stated, below a bound, or word for word."""
    style = value["style"]
    if style["form"] == "text":
        return value["text"] == str(entry)
    if value["text"] == "–":
        return entry in ("", None)
    wanted = float(str(entry)) * float(style["scale"])
    wanted = abs(wanted) if style["unsigned"] else wanted
    if style["form"] == "word":
        return (
            WORDS.index(value["text"]) if value["text"] in WORDS else int(value["text"])
        ) == wanted
    shown, unit = number(value["text"])
    if style["form"] == "bound":
        return wanted <= shown < 10.0 * wanted or wanted == shown == 0.0
    return math.isclose(shown, wanted, rel_tol=1e-13, abs_tol=0.5 * unit * (1.0 + 1e-9))


def test_the_attached_list_holds_every_printed_value_and_its_source(values, reader):
    attached = json.loads(attachments(reader)["values.json"])
    assert len(values) > 2000
    assert attached["values"] == values
    assert {source["file"]: source["rule"] for source in attached["sources"]} == SOURCES
    for value in values.values():
        source = attached["sources"][value["source"] - 1]
        assert (value["file"], value["rule"]) == (source["file"], source["rule"])


def test_every_key_of_the_article_is_printed(article, values):
    """values.typ holds no form that nothing is printed in, derived.csv nothing that the article does not print or a
    study does not say, and every claim stands in the tables."""
    source = b"""#import "paper/article/values.typ": forms, derived, claims
        #metadata((forms.keys(), derived.keys(), claims.keys()))<keys>"""
    forms, derived, claims = compiling.query(source, article.folder, INPUTS, "<keys>", "value")[0]
    begins = {".".join(parts[:n]) for key in values for parts in [key.split(".")] for n in range(9)}
    assert set(forms) - begins - values.keys() == set()
    unprinted = [key for key in derived if key not in values]
    assert [
        key
        for key in unprinted
        if not re.match("(verdict|study|range|moved|instants|cause)\\.", key)
    ] == []
    assert {f"claim.{claim}.printed" for claim in claims} - values.keys() == set()


def test_every_value_is_what_its_file_says(article, values):
    wrong = [key for key, value in values.items() if not agrees(value, raw(article, value))]
    assert wrong == []


def test_a_value_that_is_off_by_one_digit_would_be_seen(article, values):
    """Change the last digit of every printed number: none may still agree."""
    forms = {"fixed", "significant", "power", "verbatim", "plain"}
    chosen = {
        key: v for key, v in values.items() if v["style"]["form"] in forms and v["text"] != "–"
    }
    assert len(chosen) > 500
    still = []
    for key, value in chosen.items():
        mantissa, dot, exponent = value["text"].partition("·")
        last = (int(mantissa[-1]) + 1) % 10
        changed = value | {"text": f"{mantissa[:-1]}{last}{dot}{exponent}"}
        if agrees(changed, raw(article, value)):
            still.append(key)
    assert still == []


BY_HAND = {
    # as the paper prints them, in the units of the article's tables
    "parameter.F_k": "1.28",
    "parameter.omega3": "11.1",
    "table1.Y.5": "12",
    "verdicts.all.computed": "100",
    "table1.X.1.printed": "2.73",
    "table1.V_s.1.printed": "7.74",
    "table1.t_s.1.printed": "2.9",
    "table2.a.1.printed": "10.885625",
    "table2.b.1.printed": "727.29",
    "table2.W.1.printed": "79.39719",
    "claim.table2.c.2-3.printed": "90.0114",
    "text.c_direct_ls.printed": "90.0115",
    # by arithmetic
    "swing": "12.308",  # 2 F_k/K_z = 2.56/208 000 m
    "parameter.omega1_natural": "4.9172",  # sqrt(2310/2.42)/2π
    "added": "0.0116",  # mω²h = 2.42 (2π 4.92)² 5e-6 = 0.01156
    "c.rounded": "89.9998",  # 37.19 · 2.42
    "effective": "90.0114",  # 37.19 · 2.42 + mω²h
    "c.by_hand": "90.0114",
    "c_over_m": "37.19",  # 90/2.42 = 37.190083
    "k_over_m": "954.545",  # 2310/2.42 = 954.545455
    "share.omega1.first": "18",  # a F_k/W = 0.0108872 · 1.28/0.0794072 = 0.1755
    "dev.W": "−1.27·10⁻⁴",  # 0.81655453/0.816658098 − 1
    "text.t_s_mean": "2.17",  # (2.98421 + 2.37779 + 2.03537 + 1.80811 + 1.64318)/5
    "c.trapezoidal": "89.9998",  # 37.19 · 2.42: no damping of its own
    "c.backward-euler": "90.0114",  # 37.19 · 2.42 + 0.01156, as the paper prints it
    "c.explicit-euler": "89.9883",  # with the other sign
    # a_1 b_2 − a_2 b_1 = 7.6911e-6, beside 4 Z_m (b_2 − b_1) = 2.46154e-5 · 1.15010e-3 = 2.8310e-8
    "study.rigid_contact.pair_F_omega1": "−0.367 %",
    "study.rigid_contact.paper_K_z_over_k": "90.04329",  # 208 000/2310
    # of the studies' files and of CITATION.cff
    "range.contact_stiffness.K_z_over_k.low": "2",
    "range.contact_stiffness.K_z_over_k.high": "1\u2009000\u2009000",
    "range.damping.zeta.low": "0.01",
    "study.level.highest_Y_m": "80",
    "study.step_size.coarsest_step_s": "80",
    "author.0": "the dampbalance authors",
    # known from an earlier computation with other code
    "spread.omega2.reversal": "0.48",
    "error.omega2.F_k.least_squares.X_s.fundamental.common": "−18",
    "error.omega3.F_k.least_squares.X_s.fundamental.common": "−67",
    "error.omega2.F_k.least_squares.X_s.reversal.common": "−19",
    "error.omega3.F_k.least_squares.X_s.reversal.common": "−66",
    "error.omega1.F_k.largest.lock_in": "0.77",
    "error.omega1.F_k.least_squares.lock_in": "+0.46",
    "error.omega3.F_k.largest.lock_in": "0.24",
    "error.omega2.F_k.largest.X_s.zero_crossing.individual": "6.3",
    "error.omega3.F_k.largest.X_s.reversal.individual": "13",
    "error.omega3.F_k.largest.X_s.reversal.common": "67",
    "error.omega1.F_k.least_squares.fourier": "+0.021",
    "study.read_out.fourier_five": "+0.773 %",
    "study.read_out.fourier_phase": "+2.79 %",
    "study.read_out.fourier_table_1_below": "+3.09 %",
    "study.read_out.fourier_one_more": "+0.353 %",
    "b_fifth.omega2.size": "0.012",
    "b_fifth.omega2.last": "0.0011",
    "rebuilt.b.first": "1.6·10⁻⁵",
    "rebuilt.W": "3.4·10⁻⁷",
    "by_hand.W": "2.3·10⁻⁷",
    "c_over_m.W": "5.9·10⁻⁷",
    "step_from_W.rounded.min": "4.987",
    "step_from_W.rounded.max": "5.003",
    "step_from_W.c_over_m.min": "5.008",
    "step_from_W.c_over_m.max": "5.023",
    "step_from_W.exact.max": "4.937",
    "instants.by_hand.max": "0.27",
    # counted in `config/config.yaml`: four that have a name, two roundings, five starts of a, six rules of reading
    "choices.discrete": "17",
    "table_3.inputs": "nine",  # X_1 … X_5, X + X_s, t_s, φ, the sign
    "table_3.given_by_exact_X": "six",
}


def test_the_values_speak_of_the_case(values):
    """Keys, places, scales and the numbers behind them agree with numbers that are known otherwise."""
    assert {key: values[key]["text"] for key in BY_HAND} == BY_HAND


# The README of the results quotes the errors of the pairs; tests/repository/test_readme.py sees to those of the causes.
ERRORS_OF_PAIRS = (
    ("up to {} % in F_k at resonance", "error.omega1.F_k.largest.X_s.reversal.common"),
    ("resonance, {} % at 3.5 Hz", "error.omega2.F_k.largest.X_s.reversal.common"),
    (
        "3.5 Hz and {} % at 11.1 Hz, for three reasons",
        "error.omega3.F_k.largest.X_s.reversal.common",
    ),
)


@pytest.mark.parametrize(("words", "key"), ERRORS_OF_PAIRS, ids=[key for _, key in ERRORS_OF_PAIRS])
def test_the_readme_has_the_numbers_of_the_article(values, words, key):
    readme = " ".join((ROOT / "results/README.md").read_text(encoding="utf-8").split())
    assert words.format(values[key]["text"]) in readme


@pytest.mark.parametrize("quantity", ["F_k", "c"])
def test_one_bound_holds_for_all_errors_of_direct_integration(values, quantity):
    """The text states the largest of those in the table, over frequencies, pairs and fits."""
    in_table = [
        number(value["text"])[0]
        for key, value in values.items()
        if re.fullmatch(rf"error\.\w+\.{quantity}\.\w+\.direct", key)
    ]
    assert len(in_table) == 6
    assert number(values[f"largest.direct.{quantity}"]["text"])[0] == max(in_table)


def test_the_slip_that_ends_a_is_detected_within_a_sample(values):
    """The as-published route reads a between samples; a whole one off would be another rule of reading."""
    assert float(values["rebuilt.a.samples"]["text"]) < 1.0


def test_each_source_is_named_with_the_rule_of_the_workflow_that_makes_it(values):
    workflow = "\n".join(
        p.read_text(encoding="utf-8") for p in (ROOT / "workflow/rules").glob("*.smk")
    )
    assert {value["file"] for value in values.values()} == SOURCES.keys()
    for file, rule in SOURCES.items():
        lines = re.search(rf"^ *rule {rule}:\n(.*?)(?=^ *rule |\Z)", workflow, re.M | re.S)
        assert lines, rule
        outputs = lines[1].partition("output:")[2].partition("message:")[0]
        assert file.rpartition("/")[2] in outputs, (file, rule)


# --- the PDF -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def reader(article) -> PdfReader:
    return PdfReader(article.pdf)


def attachments(reader: PdfReader) -> dict[str, bytes]:
    """Return the attached files by name."""
    return {Path(name).name: contents[0] for name, contents in reader.attachments.items()}


def test_the_same_bytes_each_time_and_wherever_the_results_are_kept(article, tmp_path):
    kept = shutil.copytree(article.folder / "results", tmp_path / "ours/results")
    afresh = INPUTS | {
        "unread": "so that typst lays out again what it has laid out in this process"
    }
    made = compiling.article(article.folder / "paper/article", kept, afresh)
    assert made == article.pdf.read_bytes()


def test_the_article_is_an_archive_with_the_claims_in_it(article, reader):
    assert attachments(reader).keys() == {"claims.csv", "values.json"}
    claims = (article.folder / "results/paper/claims.csv").read_bytes()
    assert attachments(reader)["claims.csv"] == claims
    root = reader.trailer["/Root"]
    kinds = {one.get_object()["/AFRelationship"] for one in root["/AF"]}
    assert kinds == {"/Data"}
    packet = reader.xmp_metadata.stream.get_data().decode()
    assert re.search(r"pdfaid:part>3<.*pdfaid:conformance>A<", packet, re.DOTALL)
    assert re.search(r"pdfuaid:part>1<", packet)
    assert root["/OutputIntents"]
    assert root["/MarkInfo"]["/Marked"]
    assert reader.metadata.title.startswith("[Re] Balancing energy")
    assert reader.metadata.author == "the dampbalance authors"


def structure(element) -> list[dict]:
    """Return all elements of the tree in which a PDF says what is a heading, a table, a figure."""
    element = element.get_object()
    if not isinstance(element, dict) or ("/S" not in element and "/K" not in element):
        return []
    below = element.get("/K", [])
    below = below.get_object() if hasattr(below, "get_object") else below
    below = below if isinstance(below, list) else [below]
    return [element, *(e for one in below if hasattr(one, "get_object") for e in structure(one))]


def test_every_equation_and_figure_can_be_read_aloud(article, reader):
    """In the sources none is without alternative text, or with symbols only; in the PDF none was lost."""
    for kind in ("math.equation", "image"):
        texts = article.query(kind, "alt")
        assert texts
        assert all(text and re.search(r"\w", text) for text in texts), kind
    elements = structure(reader.trailer["/Root"]["/StructTreeRoot"])
    for kind, least in {"/Figure": 6, "/Formula": 100}.items():
        shown = [e for e in elements if e.get("/S") == kind]
        assert len(shown) >= least
        assert all(str(e.get("/Alt", "")).strip() for e in shown), kind


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


def chunks(page) -> list[tuple[str, float, float]]:
    """Return the pieces of text of a page, with the places where they begin."""
    pieces = []

    def keep(text, cm, tm, *_):
        x, y = tm[4], tm[5]
        place = (cm[0] * x + cm[2] * y + cm[4], cm[1] * x + cm[3] * y + cm[5])
        pieces.append((text.strip(), *place))

    page.extract_text(visitor_text=keep)
    return [piece for piece in pieces if piece[0]]


def test_numbers_are_links_to_their_lines(values, reader):
    """A link covers the text of a value and leads to the number of its line."""
    pairs = {(value["text"], str(value["line"])) for value in values.values()}
    at = {page.indirect_reference.idnum: number for number, page in enumerate(reader.pages)}
    pages = [chunks(page) for page in reader.pages]
    followed = set()
    for page, pieces in zip(reader.pages, pages, strict=True):
        for note in (note.get_object() for note in page.get("/Annots", [])):
            if not isinstance(note.get("/Dest"), ArrayObject | IndirectObject):
                continue
            aim, _, x, y, _ = note["/Dest"].get_object()
            left, low, right, high = note["/Rect"]
            covered = [t for t, u, v in pieces if left - 0.5 <= u < right and low <= v <= high]
            # A destination lies 10 pt above the line of writing, and the number of a line within 7 mm of it.
            aimed = [
                t for t, u, v in pages[at[aim.idnum]] if abs(v + 10.0 - y) < 0.6 and 0 <= u - x < 22
            ]
            if len(covered) == 1 and aimed and aimed[0].isdigit():
                followed.add((covered[0], aimed[0]))
    assert followed - pairs == set()
    assert len(followed) > 300
    text = "".join(page.extract_text() for page in reader.pages[-6:])
    assert "results/paper/derived.csv" in text
    assert "article_numbers" in text


def test_the_article_is_set_in_the_face_of_its_figures(reader):
    """The face sets the text and the letters of equations."""
    fonts = [
        font.get_object()["/BaseFont"].partition("+")[2]
        for font in reader.pages[3]["/Resources"]["/Font"].values()
    ]
    assert any(font.startswith(f"{STYLE['font.family']}-Regular") for font in fonts)
    assert any(font.startswith(f"{STYLE['font.family']}-Italic") for font in fonts)


def test_the_summary_for_editors_fills_one_page(reader):
    first, second = (" ".join(page.extract_text().split()) for page in reader.pages[:2])
    parts = ("Question.", "What we did.", "What we found.", "What is new.", "Data and code.")
    assert all(part in first for part in parts)
    assert "the dampbalance authors" in first
    assert "Data and code." not in second
    assert second.startswith("[Re] Balancing energy")


def test_a_changed_result_changes_the_page(article, tmp_path):
    """Article and results in another folder: another number in a result file is printed in its place."""
    changed = article.copy(tmp_path)
    changed.change("largest.fourier.F_k", 77.774)
    changed.typeset()
    first, other = (PdfReader(of.pdf).pages[0].extract_text().split() for of in (article, changed))
    assert "78" not in first
    assert "78" in other
    changed.change("added")
    before = changed.pdf.read_bytes()
    with pytest.raises(SystemExit, match="no result has added"):
        changed.typeset()
    assert changed.pdf.read_bytes() == before


# --- typst ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ('#set document(title: "t")\n#set text(font: "No Such Font")\n= A\nText', "warnings"),
        ('#set document(title: "t")\n= A\n$x$', "alt text"),
        ('#set document(title: "t")\n#nothing', "unknown variable"),
    ],
    ids=["warning", "no alternative text", "error"],
)
def test_what_typst_complains_about_stops_the_build(tmp_path, source, message):
    (tmp_path / "a.typ").write_text(source, encoding="utf-8")
    with pytest.raises(compiling.ArticleError, match=message):
        compiling.pdf(tmp_path / "a.typ", tmp_path, {})


def test_an_address_is_printed_where_citation_states_one(article, tmp_path):
    """Without one, the article says so, and claims no openness."""
    unstated = "names no public address"

    def text(pages, at):
        return " ".join(pages[at].extract_text().split())

    pages = PdfReader(article.pdf).pages
    at = next(i for i in reversed(range(len(pages))) if unstated in text(pages, i))
    changed = article.copy(tmp_path)
    changed.change("software.address.commit", "0123abc")
    changed.typeset()
    changed_text = text(PdfReader(changed.pdf).pages, at)
    assert "states for it: commit 0123abc" in changed_text
    assert unstated not in changed_text


def test_the_version_of_typst_is_that_of_the_creator(article, reader):
    rows = content(article.folder / "results/paper/derived.csv")
    (version,) = (row["value"] for row in rows if row["id"] == "typesetter")
    assert reader.metadata.creator == f"Typst {version}"


def test_a_warning_of_typst_fails_the_article_itself(article, tmp_path):
    """A reference to a font that is not there, in the article: no PDF, and the reason."""
    changed = article.copy(tmp_path)
    changed.pdf.unlink()
    text = changed.source.read_text(encoding="utf-8")
    changed.source.write_text(f'{text}\n#text(font: "No Such Font")[x]\n', encoding="utf-8")
    with pytest.raises(SystemExit, match="warnings, which count as errors"):
        changed.typeset()
    assert not changed.pdf.exists()
