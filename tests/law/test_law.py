"""Laws that are possible, and the records that distinguish their terms."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.balance import Rows
from dampbalance.law.law import Law, law_of
from dampbalance.law.terms import KNOWN_TERMS, in_order, term
from dampbalance.solver import solve


def test_the_law_of_the_paper_is_the_one_that_is_meant_by_none():
    law = Law()
    assert law.keys == law.unknowns == ("F_k", "c")
    assert law.nonlinear == ()
    assert law_of(None, None, None) == law
    law = law_of(None, {"c_r": 0.669}, None)
    assert law.terms == ("F_k", "c", "c_r")
    assert law.unknowns == ("F_k", "c")  # what is given is none


def test_terms_come_in_the_order_of_the_registry_each_once():
    assert Law(("c_2", "F_k", "c", "c_2")).terms == ("F_k", "c", "c_2")
    assert in_order(reversed(KNOWN_TERMS)) == tuple(KNOWN_TERMS)
    assert Law(("F_k", "c_3", "eta", "c_2")).nonlinear == ("c_2", "c_3")


def test_a_group_has_a_coefficient_of_its_own():
    law = Law(("F_k", "c"), groups={"F_k": ("250 g", "350 g", "250 g")})
    assert law.unknowns == ("F_k[250 g]", "F_k[350 g]", "c")
    assert [law.key("F_k", i) for i in range(3)] == ["F_k[250 g]", "F_k[350 g]", "F_k[250 g]"]
    assert law.key("c", 1) == "c"
    assert law.keys_of("F_k") == ("F_k[250 g]", "F_k[350 g]")
    assert (term("F_k[250 g]").symbol, term("F_k[250 g]").group) == ("F_k", "250 g")
    assert term("F_k[250 g]").column == "F_k_250_g_N"
    assert term("F_k[250 g]").integral_column == "a_250_g_m"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((("F_k", "c_9"),), "unknown term 'c_9'; known are F_k, c, c_r"),
        ((("c", "c_2"),), "needs the friction force F_k, got the terms c, c_2"),
        ((("F_k",), {"c": 1.0}), "c is given and no term of the law: add it to the terms F_k"),
        ((("F_k", "c"), {"c": -1.0}), r"the given c \(N s/m\) must be a number, .* got -1.0"),
        ((("F_k", "c"), {"F_k": 0.0}), "the given F_k must be a positive number of N, got 0.0"),
        ((("F_k", "c"), {"c": 1.0}, {"c": ("a", "b")}), "c is given and cannot have groups"),
        ((("F_k", "c"), {}, {"F_k": ("a]", "b")}), "must be names without brackets"),
        ((("F_k", "c"), {}, {"c_2": ("a", "b")}), "c_2 is grouped and no term of the law"),
    ],
)
def test_a_law_that_makes_no_sense_is_refused_by_name(arguments, message):
    with pytest.raises(ValueError, match=message.replace("[", r"\[")):
        Law(*arguments)


@pytest.mark.parametrize(
    ("law", "frequencies", "message"),
    [
        (Law(), [3.5], "2 coefficients need responses at two levels or more, got 1"),
        (Law(("F_k", "c", "c_2")), [3.5, 4.0], "3 coefficients need responses at 3 levels or more"),
        (Law(("F_k", "c", "eta")), [3.5] * 4, "act alike, c = eta k/omega: leave out one of them"),
        (Law(groups={"F_k": ("a", "b")}), [3.5] * 4, "have 2 labels for 4 records"),
        (Law(given={"F_k": 1.0, "c": 2.0}), [3.5], "leave out one, to identify it"),
    ],
)
def test_records_that_cannot_tell_the_terms_apart_are_refused(law, frequencies, message):
    with pytest.raises(ValueError, match=message):
        law.require(frequencies)
    Law(given={"c": 90.0}).require([3.5])  # one record is enough for one unknown
    Law(("F_k", "c", "eta")).require([3.5, 3.5, 7.0])


def test_rows_have_a_column_for_each_group_and_the_solver_tells_them_apart():
    """Two friction forces and one c, from rows that hold them exactly."""
    a, b = np.array([1.0, 2.0, 1.5, 4.0]), np.array([1.0, 4.0, 3.0, 2.5])
    labels = ("light", "heavy", "light", "heavy")
    F_k = np.array([2.0, 3.0, 2.0, 3.0])
    law = Law(groups={"F_k": labels})
    rows = Rows({"F_k": a, "c": b}, F_k * a + 0.5 * b).of_law(law)
    np.testing.assert_array_equal(rows.terms["F_k[light]"], [1.0, 0.0, 1.5, 0.0])
    found = solve(rows)
    values = [float(found[key]) for key in law.unknowns]
    assert values == pytest.approx([2.0, 3.0, 0.5], rel=1e-13)


def test_rows_take_what_is_given_as_known():
    a, b = np.array([1.0, 2.0]), np.array([1.0, 4.0])
    found = solve(Rows({"F_k": a, "c": b}, 2.0 * a + 0.5 * b).of_law(Law(given={"c": 0.5})))
    assert list(found.values) == ["F_k"]
    assert float(found["F_k"]) == pytest.approx(2.0, rel=1e-14)
