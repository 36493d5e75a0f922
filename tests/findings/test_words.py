"""A finding is data until the last moment: its sentence comes from the one table, in the words of a coordinate."""

from __future__ import annotations

import math
import pickle
import re

import pytest

from dampbalance.findings.finding import Finding, grouped
from dampbalance.findings.sentences import SENTENCES, Sentence
from dampbalance.findings.words import in_a_sentence, sentence
from dampbalance.records.coordinate import ROTATION, TRANSLATION
from rooms import PACKAGE
from toys import TOY

SOURCES = ["data/a.csv", "data/b.csv", "data/c.csv"]
SAME_NAME = ["one/a.csv", "two/a.csv", "three/b.csv"]
MANY = [f"{i}.csv" for i in range(20)]
TOYS = {
    "drift": ("drifts by {by:g %} in {t:.0f s}", "let it warm up"),
    "toy": ("{quantity:noun} is {X:.3g mm} off, of [late?{late:± µs}|no] delay",),
    "worse": ("{times:factor} times worse",),
    "cause": ("{what} hides {F_k} of {values:values}: {causes}[others? or {others}]",),
}


@pytest.fixture(autouse=True)
def toys(monkeypatch):
    """A finding is one line in the table."""
    for code, words in TOYS.items():
        monkeypatch.setitem(SENTENCES, code, Sentence(*words))


def drift(by, of=""):
    return Finding("drift", {"by": by, "t": 20.0}, of=of)


def toy(quantity, of="", **more):
    return Finding("toy", {"quantity": quantity, "X": 2e-3, **more}, of=of)


def worse(times, of):
    return Finding("worse", {"times": times}, of=of)


def said(make, numbers, sources):
    """The sentences on findings of the first of the records, one of each."""
    found = grouped(map(make, numbers, sources))
    return [in_a_sentence(group, sources, TRANSLATION) for group in found]


def test_the_same_finding_on_several_records_is_one_sentence_with_its_range():
    drifts = "drifts by {} to 3.5 % in 20 s; let it warm up"
    assert said(drift, (0.035, 1e-7), SOURCES) == ["a.csv and b.csv: " + drifts.format("1·10⁻⁵")]
    assert said(drift, (0.035, 1e-7, -0.02), SOURCES) == ["all 3 records: " + drifts.format("−2")]
    (factors,) = said(worse, (450.2, 3883747.0, 12.4), SOURCES)
    assert factors == "all 3 records: 12 to more than 1,000 times worse"
    off = "x is 2 mm off, of no delay"
    assert said(toy, "xx", SAME_NAME) == [f"one/a.csv and two/a.csv: {off}"]
    some = "9 of 20 records (0.csv, 1.csv, 2.csv, 3.csv, 4.csv …)"
    assert said(toy, "x" * 9, MANY) == [f"{some}: {off}"]
    different = said(toy, ("x", "acc{2}"), SOURCES)
    assert different == [f"a.csv: {off}", f"b.csv: {off.replace('x', 'acc{2}', 1)}"]


def test_a_rotation_has_its_units_nouns_and_symbols_and_names_of_records_stay():
    name = "F_k of 3 N.csv"
    late = toy("base_displacement", name, late=(2e-6, 1e-7))
    words = in_a_sentence([late], [name], ROTATION)
    assert words == f"{name}: base_angle is 2 mrad off, of 2.00 ± 0.10 µs delay"
    numbers = {
        "what": "force of 3 N",  # a name
        "values": (("F_k[A]", 1.28), ("m", 2.42)),
        "causes": (toy("force"), toy("velocity")),
        "others": ((toy("x"), toy("y")), (toy("z"),)),
    }
    off = " is 2 mrad off, of no delay"
    assert sentence(Finding("cause", numbers), ROTATION) == (
        f"force of 3 N hides T_k of T_k[A] = 1.28 N m, J = 2.42 kg m²: torque{off} and angular velocity{off} or "
        f"x{off} and y{off} or z{off}"
    )


def test_a_finding_has_effects_survives_a_process_boundary_and_has_a_sentence():
    one = Finding("drift", {"by": 1.0, "t": 1.0}, {"": 0.1, "c": math.nan})
    assert (one.shift("F_k"), one.shift("c"), one.largest) == (0.1, math.inf, math.inf)
    assert drift(1.0).largest == 0.0
    assert pickle.loads(pickle.dumps(drift(0.02))) == drift(0.02)
    with pytest.raises(KeyError, match="nobody"):
        Finding("nobody")


def test_each_code_in_the_package_has_a_sentence_and_each_sentence_a_use():
    sources = [path.read_text("utf-8") for path in PACKAGE.rglob("*.py")]
    made = {code for text in sources for code in re.findall(r'Finding\(\s*"([^"]+)"', text)}
    assert made - {*SENTENCES} == set()
    parts = {part for one in SENTENCES.values() for part in re.findall(r"\{@(.+?)\}", one.words)}
    named = {code for text in sources for code in re.findall(r'"([^"\n]+)"', text)}
    assert {*SENTENCES} - made - parts - named - TOYS.keys() - {TOY} == set()


def test_the_marks_of_each_sentence_are_paired():
    for text in (text for of in SENTENCES.values() for text in of[:2]):
        left = re.sub(r"\{[^{}\[\]]+\}", "", text)
        while left != (left := re.sub(r"\[\w+\?[^\[\]]*\]", "", left)):
            pass
        assert not set("{}[]|") & set(left), text
