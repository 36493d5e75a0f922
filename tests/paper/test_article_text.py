"""The text of the article holds no number of a result: values come from files, made into text in one place."""

from __future__ import annotations

import re

import pytest
import yaml

import dampbalance
from dampbalance.publishing.article.book import Book
from dampbalance.publishing.article.places import MissingValue, Place, ResultFiles
from dampbalance.publishing.article.software import software
from dampbalance.publishing.article.style import Style
from paper.routes import ROOT
from paper.typed import not_excused, typed_numbers

ARTICLE = ROOT / "paper/article"


# --- numbers typed in the text -------------------------------------------------------------------


def sources() -> dict[str, str]:
    """The texts of the article; template.typ is layout and helpers, and is looked at by a test of its own."""
    files = [path for path in sorted(ARTICLE.rglob("*.typ")) if path.name != "template.typ"]
    return {
        path.relative_to(ARTICLE).as_posix(): path.read_text(encoding="utf-8") for path in files
    }


def exceptions() -> list[dict[str, str]]:
    return yaml.safe_load((ARTICLE / "exceptions.yml").read_text(encoding="utf-8"))


def typed(texts: dict[str, str]) -> list:
    return [number for file, text in texts.items() for number in typed_numbers(file, text)]


def test_there_are_texts_to_scan():
    assert sum(len(text) for text in sources().values()) > 15_000


def test_no_number_of_a_result_is_typed():
    left, unused = not_excused(typed(sources()), exceptions())
    assert [str(number) for number in left] == []
    assert [exception["text"] for exception in unused] == [], "no longer needed: take them out"


@pytest.mark.parametrize(
    "number",
    [
        "90.0114",
        "5 µs",
        "1.28 N",
        "−3",
        "66.6 %",
        "42",
        "twenty",
        "$c = 90.01$",
        "1.2·10⁻⁴",
        "208 000",
    ],
)
@pytest.mark.parametrize("file", sorted(sources()))
def test_a_typed_number_would_be_seen(file, number):
    texts = sources()
    place = texts[file].rindex("\n\n")
    texts[file] = (
        f"{texts[file][:place]}\n\nThe value is {number}, as one sees.\n{texts[file][place:]}"
    )
    left, _ = not_excused(typed(texts), exceptions())
    assert left
    assert all("as one sees" in one.text for one in left)


def test_a_number_in_a_caption_or_an_alternative_text_would_be_seen():
    assert typed_numbers("x", 'caption: [Off by 1.5 %.], alt: "at 4.92 Hz"')
    assert not typed_numbers("x", '#n("level.0") of @table-1, width: 62%, $x_1^2$ // 1.5')


def test_every_exception_says_why():
    assert all(exception["why"] for exception in exceptions())


def test_the_template_holds_no_prose():
    """What template.typ shows comes from values; else a number could hide there."""
    text = (ARTICLE / "template.typ").read_text(encoding="utf-8")
    shown = re.findall(r"\[([^\[\]#]*)\]", text)
    assert [words for words in shown if re.search(r"\d", words)] == []


def test_no_semicolon_is_lost():
    """typst takes a semicolon after an expression for its end: one that is to be read is written twice."""
    prose = {
        file: re.sub(r"^#(?:import|set|show|let).*", "", text, flags=re.MULTILINE)
        for file, text in sources().items()
    }
    lost = [
        f"{file}: {match[0]}"
        for file, text in prose.items()
        for match in re.finditer(r"#\w+(?:\((?:\"[^\"]*\"|\$[^$]*\$)\))?;(?!;).{0,20}", text)
    ]
    assert lost == []


# --- references and names -------------------------------------------------------------------------


def test_every_reference_is_cited():
    """That every citation has its reference typst sees to."""
    references = yaml.safe_load((ARTICLE / "references.yml").read_text(encoding="utf-8"))
    cited = set(re.findall(r"@([a-z]+\d{4})\b", "\n".join(sources().values())))
    assert cited == references.keys()


def test_the_tables_figures_and_equations_of_the_paper_are_called_lf():
    """Those of the article are referred to by label: a number in the text would be one of the paper's."""
    bare = [
        f"{file}: {match[0]}"
        for file, text in sources().items()
        for match in re.finditer(r"(?:[Tt]able|[Ff]igure|[Ee]quation|Eq\.)s?\s+\(?\d\w*", text)
    ]
    assert bare == []


@pytest.mark.parametrize("folder", ["src/dampbalance", "paper/article"])
def test_there_is_one_shape_of_phi(folder):
    """The one of the text, φ: matplotlib's \\phi and typst's phi.alt look like ϕ."""
    files = [p for p in (ROOT / folder).rglob("*") if p.suffix in (".py", ".typ", ".j2")]
    assert len(files) > 10
    other = re.compile(r"\\phi\b|phi\.alt|\u03d5")
    assert [p.name for p in files if other.search(p.read_text(encoding="utf-8"))] == []


# --- what CITATION.cff states ---------------------------------------------------------------------


def test_authors_and_addresses_are_those_of_the_citation():
    stated = {
        "version": "1.2.0",
        "license": "BSD-3-Clause",
        "authors": [
            {"given-names": "Ada", "name-particle": "de", "family-names": "Vries"},
            {"name": "a group"},
        ],
        "repository-code": "a place",
        "commit": "0123abc",
    }
    assert software(stated) == {
        "version": "1.2.0",
        "licence": "BSD-3-Clause",
        "authors": ["Ada de Vries", "a group"],
        "addresses": {"repository": "a place", "commit": "0123abc"},
    }


def test_nothing_is_stated_that_the_citation_lacks():
    own = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert software(own)["version"] == dampbalance.__version__
    known = {"repository-code", "repository", "url", "repository-artifact", "doi", "commit"}
    assert len(software(own)["addresses"]) == len(known & own.keys())


# --- a number as it is printed -------------------------------------------------------------------


@pytest.mark.parametrize(
    ("style", "raw", "text"),
    [
        (Style("plain"), "208000.0", "208\u2009000"),
        (Style("plain"), 2310.0, "2310"),
        (Style("plain"), 11.1, "11.1"),
        (Style("fixed", 2), "-0.125", "−0.12"),  # half to even, in decimal
        (Style("fixed", 2, scale="1e3"), "0.00273", "2.73"),
        (Style("fixed", 1, signed=True), "0.25", "+0.2"),
        (Style("fixed", 1), "-0.04", "0.0"),
        (Style("fixed", 1, signed=True), "0.04", "0.0"),
        (Style("fixed", 1), "nan", "–"),
        (Style("fixed", 1), "", "–"),
        (Style("fixed", 1), None, "–"),
        (Style("significant", 2), "66.6", "67"),
        (Style("significant", 2), "0.0999", "0.10"),
        (Style("significant", 2), "0", "0"),
        (Style("power", 1), "-1.27e-4", "−1.3·10⁻⁴"),
        (Style("significant", 2, unsigned=True), "-0.0999", "0.10"),
        (Style("bound"), "3.1e-12", "10⁻¹¹"),
        (Style("bound"), "1e-12", "10⁻¹²"),
        (Style("verbatim"), "2.9E-3", "2.9·10⁻³"),
        (Style("verbatim"), "1.280030", "1.280030"),
        (Style("word"), "5", "five"),
        (Style("word"), "133", "133"),
        (Style("text"), "last digit", "last digit"),
    ],
)
def test_style(style, raw, text):
    assert style.render(raw) == text


def test_text_is_no_number():
    with pytest.raises(ValueError, match="is not a number"):
        Style("fixed", 2).render("degraded")


# --- where it comes from -------------------------------------------------------------------------


@pytest.fixture
def results(tmp_path):
    (tmp_path / "t.csv").write_text("id,x\na,1.0\nb,2.0\nb,3.0\n", encoding="utf-8")
    (tmp_path / "d.json").write_text('{"p": {"q": [7]}}', encoding="utf-8")
    return ResultFiles(tmp_path)


def test_places(results):
    assert results.at(Place("t.csv", row={"id": "a"}, column="x")) == "1.0"
    assert results.at(Place("d.json", pointer="/p/q/0")) == 7


@pytest.mark.parametrize(
    ("place", "message"),
    [
        (Place("t.csv", row={"id": "b"}, column="x"), "2 rows"),
        (Place("t.csv", row={"id": "z"}, column="x"), "0 rows"),
        (Place("t.csv", row={"id": "a"}, column="y"), "no column 'y'"),
        (Place("d.json", pointer="/p/q/1"), "nothing at /p/q/1"),
        (Place("d.json", pointer="/p/r"), "nothing at /p/r"),
    ],
)
def test_a_value_that_is_not_there_is_an_error(results, place, message):
    with pytest.raises(MissingValue, match=message):
        results.at(place)


def test_a_value_needs_a_rule_and_a_key_of_its_own(results):
    book = Book(results, {"results/t.csv": "make_t"}, "results")
    with pytest.raises(ValueError, match=r"d\.json is not among the inputs"):
        book.item("q", "d.json", "/p/q/0", Style("plain"))
