"""The text of the article holds no number of a result: values come from the result files, rounded in one place."""

from __future__ import annotations

import re
import shutil

import pytest
import yaml

from dampbalance.publishing.article import compiling
from replication.routes import ROOT
from replication.typed import not_excused, typed_numbers

ARTICLE = ROOT / "paper/article"
SOURCES = {
    path.relative_to(ARTICLE).as_posix(): path.read_text(encoding="utf-8")
    for path in sorted(ARTICLE.rglob("*.typ"))
}
HELPERS = {name: SOURCES.pop(name) for name in ("template.typ", "values.typ", "numbers.typ")}
EXCEPTIONS = yaml.safe_load((ARTICLE / "exceptions.yml").read_text(encoding="utf-8"))

# --- numbers typed in the text -------------------------------------------------------------------


def left_in(texts):
    """The numbers typed in texts that no exception covers, and the exceptions that cover none."""
    found = [number for file, text in texts.items() for number in typed_numbers(file, text)]
    return not_excused(found, EXCEPTIONS)


def test_no_number_of_a_result_is_typed():
    assert sum(map(len, SOURCES.values())) > 15_000
    left, unused = left_in(SOURCES)
    assert [str(number) for number in left] == []
    assert [one["text"] for one in unused] == [], "no longer needed: take them out"
    # layout and lookup show values only; else a number could hide there
    shown = re.findall(r"\[([^\[\]#]*)\]", "".join(HELPERS.values()))
    assert [words for words in shown if re.search(r"\d", words)] == []


TYPED = ("90.0114", "5 µs", "−3", "66.6 %", "42", "twenty", "$c = 90.01$", "1.2·10⁻⁴", "208 000")


def test_a_typed_number_would_be_seen():
    file, text = next(iter(SOURCES.items()))
    for number in TYPED:
        added = f"{text}\n\nThe value is {number}, as one sees.\n"
        left, _ = left_in({file: added})
        assert left
        assert all("as one sees" in one.text for one in left)


def test_every_reference_is_cited():
    """Typst sees to it that every citation has its reference."""
    references = yaml.safe_load((ARTICLE / "references.yml").read_text(encoding="utf-8"))
    assert {*re.findall(r"@([a-z]+\d{4})\b", "\n".join(SOURCES.values()))} == references.keys()


# --- a number as it is printed -------------------------------------------------------------------


def printed(cases) -> list[str]:
    """Return entries as typst prints them.   cases : entry of a result file, form, and further parts of the style."""
    source = b"""#import "numbers.typ": *
        #metadata(json(bytes(sys.inputs.given)).map(((raw, form, more)) => printed(raw, style(form, ..more))))<text>"""
    return compiling.query(source, ARTICLE, cases, "<text>", "value")[0]


EXAMPLES = [
    ("208000.0", "plain", {}, "208\u2009000"),
    (11.1, "plain", {}, "11.1"),
    ("0.00273", "fixed", {"digits": 2, "scale": "1e3"}, "2.73"),
    ("0.25", "fixed", {"digits": 1, "signed": True}, "+0.2"),  # a tie goes to the even digit
    (0.35, "fixed", {"digits": 1}, "0.4"),
    ("-125e-5", "significant", {"digits": 2}, "−0.0012"),
    ("9.996", "significant", {"digits": 3}, "10.0"),
    ("2.5e-7", "power", {}, "2·10⁻⁷"),
    (99950.0, "power", {"digits": 2}, "1.00·10⁵"),
    ("-0.04", "fixed", {"digits": 1}, "0.0"),
    ("", "fixed", {"digits": 1}, "–"),
    ("-0.0999", "significant", {"digits": 2, "unsigned": True}, "0.10"),
    ("-3.1e-12", "bound", {}, "10⁻¹¹"),
    ("2.9E-3", "verbatim", {}, "2.9·10⁻³"),
    ("-1.280030", "verbatim", {}, "−1.280030"),
    ("5", "word", {}, "five"),
    ("133", "word", {}, "133"),
    ("last digit", "text", {}, "last digit"),
]


def test_numbers_are_printed_in_their_form():
    assert printed([case[:3] for case in EXAMPLES]) == [text for *_, text in EXAMPLES]


# --- where it comes from -------------------------------------------------------------------------

DERIVED = "id,value,unit\nswing,12.3077,µm\nstep,stiff,µs\na.number,1,\n"


@pytest.fixture
def value_of(tmp_path):
    """Return a function from a key to its value in a folder with a small table of results."""
    for name in ("values.typ", "numbers.typ"):
        shutil.copy(ARTICLE / name, tmp_path)
    for name, text in {"derived": DERIVED, "numbers": "id,exact\n", "claims": "id\n"}.items():
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    listed = dict.fromkeys(("/derived.csv", "/numbers.csv", "/claims.csv"), "a rule")
    inputs = {"results": "", "studies": "/studies", "sources": listed}

    def value(key: str) -> dict:
        source = f'#import "values.typ": value-of\n#metadata(value-of("{key}"))<value>'.encode()
        return compiling.query(source, tmp_path, inputs, "<value>", "value")[0]

    return value


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("table1.X.1.guessed", r"no result has table1\.X\.1\.guessed"),
        ("a.number", r"no form is stated for a\.number"),
        ("step", r'step: /derived\.csv: value: "stiff" is not a number'),
    ],
)
def test_a_value_that_is_not_there_or_twice_is_an_error(value_of, tmp_path, key, message):
    with pytest.raises(RuntimeError, match=message):
        value_of(key)
    with (tmp_path / "derived.csv").open("a", encoding="utf-8") as file:
        file.write("swing,13,µm\n")
    with pytest.raises(RuntimeError, match=r"derived\.csv: two rows are called swing"):
        value_of("swing")
