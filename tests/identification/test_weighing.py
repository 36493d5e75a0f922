"""What is said of departures by their weights, and the rows of all that was weighed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dampbalance import identify
from dampbalance.findings.words import sentence
from dampbalance.fit.select import Model, Selection
from dampbalance.identification.weighing import DEPARTURES, departure, said_of, weighed_of
from dampbalance.records.coordinate import ROTATION, TRANSLATION
from identification.levels import measured
from paper_case import PAPER

KEYS = ("F_k", "c")


def model(name, moved=0.0, size=(0.0, 0.0)):
    return Model(name, 0.1, 0.0, np.array([1.0, 2.0 * (1.0 + moved)]), np.eye(2), None, size)


def selection(weight, moved=0.1):
    models = (model(""), model("delay", moved, (-2e-5, 1e-6)), model("many sliders", 9.0))
    return Selection(KEYS, models, (0.9 - weight, weight, 0.1))


@pytest.mark.parametrize(
    ("weight", "moved", "said"),
    [
        (0.95, 0.0, [True]),  # clearly there
        (0.6, 0.1, [False]),  # its share moves c by 6 %
        (0.3, 0.1, []),  # by 3 %, less than what makes a number useless
        (0.0, 9.0, []),
    ],
)
def test_a_departure_is_named_where_it_is_clear_or_matters(weight, moved, said):
    found = said_of(selection(weight, moved))
    assert [one.numbers["clear"] for one in found] == said
    assert all(one.effect == {} for one in found)


def test_all_that_was_weighed_is_listed_with_size_and_error():
    rows = weighed_of(selection(0.6))
    assert [one.name for one in rows] == ["delay", "", "many sliders"]
    assert rows[0][1:] == (0.6, -2e-5, 1e-6)
    assert sum(one.weight for one in rows) == pytest.approx(1.0)


@pytest.mark.parametrize("name", DEPARTURES)
def test_each_departure_has_words_with_its_size(name):
    for of in (TRANSLATION, ROTATION):
        assert "{" not in sentence(departure(name, -0.2, 0.5), of)


def test_details_and_document_list_the_weights():
    plain = identify(measured(noise=0.003, cycles=20.0), PAPER.k)
    found = replace(plain, weighed=weighed_of(selection(0.6)))
    first = found.document()["weights"][0]
    assert first == {"name": "delay", "weight": 0.6, "size": -2e-5, "error": 1e-6}
    none = replace(plain, weighed=())
    assert len(found.text().splitlines()) >= len(none.text().splitlines()) + len(found.weighed)
