"""The text of the article holds no number of a result: values come from the result files, rounded in one place."""

from __future__ import annotations

import random
import re
import shutil
from decimal import Decimal

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


@pytest.mark.parametrize("file", SOURCES)
def test_a_typed_number_would_be_seen(file):
    place = SOURCES[file].rindex("\n\n")
    for number in TYPED:
        added = f"\n\nThe value is {number}, as one sees.\n"
        text = f"{SOURCES[file][:place]}{added}{SOURCES[file][place:]}"
        left, _ = left_in({file: text})
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
    (2310.0, "plain", {}, "2310"),
    (11.1, "plain", {}, "11.1"),
    ("0.00273", "fixed", {"digits": 2, "scale": "1e3"}, "2.73"),
    ("0.25", "fixed", {"digits": 1, "signed": True}, "+0.2"),
    ("-0.04", "fixed", {"digits": 1}, "0.0"),
    ("nan", "fixed", {"digits": 1}, "–"),
    ("", "fixed", {"digits": 1}, "–"),
    ("-0.0999", "significant", {"digits": 2, "unsigned": True}, "0.10"),
    ("-3.1e-12", "bound", {}, "10⁻¹¹"),
    ("1e-12", "bound", {}, "10⁻¹²"),
    ("2.9E-3", "verbatim", {}, "2.9·10⁻³"),
    ("-1.280030", "verbatim", {}, "−1.280030"),
    ("5", "word", {}, "five"),
    ("133", "word", {}, "133"),
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
    for _ in range(1000):
        digits, form = chance.randint(1, 5), chance.choice(["fixed", "significant", "power"])
        mantissa = chance.randrange(1, 10 ** chance.randint(1, 17))
        exponent = chance.randint(-25, -9)
        if chance.random() < 0.5:  # a tie: …5 in the place behind the last one
            mantissa = 10 * chance.randrange(10 ** (digits - 1), 10**digits) + 5
            exponent = -digits - 1 if form == "fixed" else chance.randint(-15, 2)
        raw = f"{chance.choice(['', '-'])}{mantissa}e{exponent}"
        places = {"digits": digits - 1 if form == "power" else digits}
        cases.append((chance.choice([raw, float(raw)]), form, places))
    ascii_ = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789", "\u2009")
    for case, text in zip(cases, printed(cases), strict=True):
        assert text.translate(ascii_) == by_python(case[0], case[1], **case[2]), case


# --- where it comes from -------------------------------------------------------------------------

FILES = {
    "results/derived.csv": "id,value,unit\nswing,12.3077,µm\nstep,stiff,µs\na.number,1,\n",
    "results/numbers.csv": """id,frequency,quantity,approach,kind,phase,sharing,line,unit,exact,as_published
parameter.m,,m,,parameter,,,all,kg,2.42,
table1.X.1,omega1,X,,level,,,1,m,0.0027279,0.00273
,omega2,F_k,X_s,least_squares,reversal,common,all,%,-19.4871,
,omega2,F_k,direct,largest,,,all,%,-3e-12,
""",
    "results/claims.csv": "id,printed,unit,verdict\nparameter.m,2.42,kg,reproduced\n"
    "table1.X.1,2.73E-3,m,simulated\n",
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


def test_a_value_names_its_place(value_of):
    value = value_of("error.omega2.F_k.least_squares.X_s.reversal.common")
    assert (value["text"], value["unit"], value["rule"]) == ("−19", "%", "a rule")
    assert (value["file"], value["line"], value["source"]) == ("results/numbers.csv", 4, 2)
    given = [value_of(f"{way}table1.X.1.printed")["text"] for way in ("", "claim.")]
    assert given == ["2.73", "2.73·10⁻³"]
    assert value_of("swing")["text"] == "12.308"
    assert value_of("error.omega2.F_k.largest.direct")["text"] == "10⁻¹¹"


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("table1.X.1.guessed", r"no result has table1\.X\.1\.guessed"),
        ("a.number", r"no form is stated for a\.number"),
        ("step", r'step: results/derived\.csv: value: "stiff" is not a number'),
    ],
)
def test_a_value_that_is_not_there_or_twice_is_an_error(value_of, tmp_path, key, message):
    with pytest.raises(RuntimeError, match=message):
        value_of(key)
    with (tmp_path / "results/derived.csv").open("a", encoding="utf-8") as file:
        file.write("swing,13,µm\n")
    with pytest.raises(RuntimeError, match=r"derived\.csv: two rows are called swing"):
        value_of("swing")
