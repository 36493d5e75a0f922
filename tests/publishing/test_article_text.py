"""The text of the article holds no number of a result: values come from the result files, rounded in one place."""

from __future__ import annotations

import random
import re
import shutil
from decimal import Decimal

import pytest
import yaml

import dampbalance
from dampbalance.publishing.article import compiling
from dampbalance.publishing.provenance.manifest import software
from replication.routes import ROOT
from replication.typed import not_excused, typed_numbers

ARTICLE = ROOT / "paper/article"
HELPERS = ("template.typ", "values.typ", "numbers.typ")

# --- numbers typed in the text -------------------------------------------------------------------


def sources() -> dict[str, str]:
    """Return the texts of the article; a separate test sees to it that the other sources contain no prose."""
    files = [path for path in sorted(ARTICLE.rglob("*.typ")) if path.name not in HELPERS]
    return {
        path.relative_to(ARTICLE).as_posix(): path.read_text(encoding="utf-8") for path in files
    }


def exceptions() -> list[dict[str, str]]:
    return yaml.safe_load((ARTICLE / "exceptions.yml").read_text(encoding="utf-8"))


def typed(texts: dict[str, str]) -> list:
    return [number for file, text in texts.items() for number in typed_numbers(file, text)]


def test_the_abstract_has_at_most_eight_numbers():
    """Values that are looked up; no typed one gets in (below)."""
    abstract = sources()["sections/findings.typ"].partition("*Abstract.*")[2].partition("\n]\n")[0]
    numbers = re.findall(r"#[nv]\(\"([^\"]+)\"\)", abstract)
    assert 3 < len(numbers) <= 8
    assert "the simplest explanation" in " ".join(abstract.split())


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


@pytest.mark.parametrize("file", HELPERS)
def test_layout_and_lookup_hold_no_prose(file):
    """They show values only; else a number could hide there."""
    text = (ARTICLE / file).read_text(encoding="utf-8")
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
    """Typst sees to it that every citation has its reference."""
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
        "contact": [{"name": "a group", "email": "a@b"}, {"family-names": "Vries"}],
    }
    assert software(stated) == {
        "version": "1.2.0",
        "licence": "BSD-3-Clause",
        "authors": ["Ada de Vries", "a group"],
        "addresses": {
            "repository": "a place",
            "commit": "0123abc",
            "contact": "a group a@b, Vries",
        },
    }


def test_nothing_is_stated_that_the_citation_lacks():
    own = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert software(own)["version"] == dampbalance.__version__
    known = {
        "repository-code",
        "repository",
        "url",
        "repository-artifact",
        "doi",
        "commit",
        "contact",
    }
    assert len(software(own)["addresses"]) == len(known & own.keys())


# --- a number as it is printed -------------------------------------------------------------------


def printed(cases) -> list[str]:
    """Return entries as typst prints them.   cases : entry of a result file, form, and further parts of the style."""
    source = b"""#import "numbers.typ": *
        #metadata(json(bytes(sys.inputs.given)).map(((raw, form, more)) => printed(raw, style(form, ..more))))<text>"""
    return compiling.query(source, ARTICLE, cases, "<text>", "value")[0]


EXAMPLES = [
    ("208000.0", "plain", {}, "208\u2009000"),
    (1234567.0, "plain", {}, "1\u2009234\u2009567"),
    (2310.0, "plain", {}, "2310"),
    (11.1, "plain", {}, "11.1"),
    (0, "plain", {}, "0"),
    ("0.00273", "fixed", {"digits": 2, "scale": "1e3"}, "2.73"),
    ("0.25", "fixed", {"digits": 1, "signed": True}, "+0.2"),
    ("-0.04", "fixed", {"digits": 1}, "0.0"),
    ("0.04", "fixed", {"digits": 1, "signed": True}, "0.0"),
    ("nan", "fixed", {"digits": 1}, "–"),
    ("", "fixed", {"digits": 1}, "–"),
    (None, "fixed", {"digits": 1}, "–"),
    ("0", "significant", {"digits": 2}, "0"),
    ("-0.0999", "significant", {"digits": 2, "unsigned": True}, "0.10"),
    ("3.1e-12", "bound", {}, "10⁻¹¹"),
    ("-3.1e-12", "bound", {}, "10⁻¹¹"),
    ("1e-12", "bound", {}, "10⁻¹²"),
    ("2.9E-3", "verbatim", {}, "2.9·10⁻³"),
    ("1.280030", "verbatim", {}, "1.280030"),
    ("-1.280030", "verbatim", {}, "−1.280030"),
    ("5", "word", {}, "five"),
    (2.0, "word", {}, "two"),
    ("133", "word", {}, "133"),
    ("2.5", "word", {}, "2.5"),
    ("last digit", "text", {}, "last digit"),
]


def test_numbers_are_printed_in_their_form():
    assert printed([case[:3] for case in EXAMPLES]) == [text for *_, text in EXAMPLES]


def by_python(raw: object, form: str, digits: int) -> str:
    """Return a number in a form by Python's own formatting, which rounds half to even; ASCII, without spaces."""
    number = Decimal(str(raw))
    if form == "fixed":
        text = f"{number:.{digits}f}"
        return text if text.strip("-0.") else text.removeprefix("-")
    if form == "significant":
        return f"{Decimal(f'{number:.{digits - 1}e}'):f}"
    mantissa, _, exponent = f"{number:.{digits}e}".partition("e")
    return f"{mantissa}·10{int(exponent)}"


def test_numbers_are_rounded_as_python_rounds_them():
    """Text and floats of up to seventeen digits; every second one is a tie, half a unit of the last digit printed."""
    chance = random.Random(2010)
    cases = []
    for _ in range(4000):
        digits, form = chance.randint(1, 5), chance.choice(["fixed", "significant", "power"])
        mantissa, exponent = (
            chance.randrange(1, 10 ** chance.randint(1, 17)),
            chance.randint(-25, -9),
        )
        if chance.random() < 0.5:  # a tie: …5 in the place behind the last one
            mantissa = 10 * chance.randrange(10 ** (digits - 1), 10**digits) + 5
            exponent = -digits - 1 if form == "fixed" else chance.randint(-15, 2)
        raw = f"{chance.choice(['', '-'])}{mantissa}e{exponent}"
        places = {"digits": digits - 1 if form == "power" else digits}
        cases.append((chance.choice([raw, float(raw)]), form, places))
    ascii_ = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789", "\u2009")
    expected = [by_python(raw, form, **places) for raw, form, places in cases]
    wrong = [
        (case, text, wanted)
        for case, text, wanted in zip(cases, printed(cases), expected, strict=True)
        if text.translate(ascii_) != wanted
    ]
    assert wrong == []


# --- where it comes from -------------------------------------------------------------------------

FILES = {
    "results/derived.csv": """id,value,unit
swing,12.3077,µm
step,stiff,µs
a.number,1,
""",
    "results/numbers.csv": """id,frequency,quantity,approach,kind,phase,sharing,line,unit,exact,as_published
parameter.m,,m,,parameter,,,all,kg,2.42,
table1.X.1,omega1,X,,level,,,1,m,0.0027279,0.00273
,omega2,F_k,X_s,least_squares,reversal,common,all,%,-19.4871,
,omega2,F_k,direct,largest,,,all,%,-3e-12,
""",
    "results/claims.csv": """id,printed,unit,verdict
parameter.m,2.42,kg,reproduced
table1.X.1,2.73E-3,m,simulated
""",
}


@pytest.fixture
def value_of(tmp_path):
    """Return a function from a key to its value in a folder with three small results."""
    (tmp_path / "results").mkdir()
    for name in ("values.typ", "numbers.typ"):
        shutil.copy(ARTICLE / name, tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    listed = dict.fromkeys(FILES, "a rule")
    inputs = {"results": "/results", "studies": "/studies", "sources": listed}

    def value(key: str) -> dict:
        source = f'#import "values.typ": value-of\n#metadata(value-of("{key}"))<value>'.encode()
        return compiling.query(source, tmp_path, inputs, "<value>", "value")[0]

    return value


@pytest.mark.parametrize(
    ("key", "text", "unit", "file", "line", "name", "column"),
    [
        ("swing", "12.308", "µm", "derived", 2, "swing", "value"),
        ("parameter.m", "2.42", "kg", "numbers", 2, "parameter.m", "exact"),
        ("table1.X.1.printed", "2.73", "m", "claims", 3, "table1.X.1", "printed"),
        ("table1.X.1.exact", "2.7279", "m", "numbers", 3, "table1.X.1", "exact"),
        ("table1.X.1.as_published", "2.73", "m", "numbers", 3, "table1.X.1", "as_published"),
        ("table1.X.1.verdict", "simulated", "m", "claims", 3, "table1.X.1", "verdict"),
        ("claim.table1.X.1.printed", "2.73·10⁻³", "m", "claims", 3, "table1.X.1", "printed"),
        *(
            (
                f"error.omega2.F_k.{way}",
                text,
                "%",
                "numbers",
                line,
                f"error.omega2.F_k.{way}",
                "exact",
            )
            for way, text, line in (
                ("least_squares.X_s.reversal.common", "−19", 4),
                ("largest.direct", "10⁻¹¹", 5),
            )
        ),
    ],
)
def test_a_value_names_its_place(value_of, key, text, unit, file, line, name, column):
    value = value_of(key)
    assert (value["text"], value["unit"]) == (text, unit)
    assert value["file"] == f"results/{file}.csv"
    assert (value["line"], value["id"], value["column"]) == (line, name, column)
    assert (value["rule"], value["source"]) == (
        "a rule",
        ["derived", "numbers", "claims"].index(file) + 1,
    )


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("mass", "no result has mass"),
        ("table1.X.2.exact", r"no result has table1\.X\.2\.exact"),
        ("table1.X.1.guessed", r"no result has table1\.X\.1\.guessed"),
        ("error.omega2.F_k.largest", r"no result has error\.omega2\.F_k\.largest"),
        ("a.number", r"no form is stated for a\.number"),
        ("step", r'step: results/derived\.csv: value: "stiff" is not a number'),
    ],
)
def test_a_value_that_is_not_there_is_an_error(value_of, key, message):
    with pytest.raises(RuntimeError, match=message):
        value_of(key)


def test_two_rows_of_one_id_are_an_error(value_of, tmp_path):
    file = tmp_path / "results/derived.csv"
    file.write_text(f"{file.read_text('utf-8')}swing,13,µm\n", encoding="utf-8")
    with pytest.raises(RuntimeError, match=r"derived\.csv: two rows are called swing"):
        value_of("swing")


def test_a_result_that_is_not_there_is_an_error(value_of, tmp_path):
    (tmp_path / "results/claims.csv").unlink()
    with pytest.raises(RuntimeError, match=r"file not found .*results/claims\.csv"):
        value_of("swing")
