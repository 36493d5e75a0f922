"""Examples in docstrings run, and say what comes out: those of every public name."""

from __future__ import annotations

import doctest
import inspect

import pytest

import dampbalance

FINDER = doctest.DocTestFinder()
FUNCTIONS = [name for name in dampbalance.__all__ if inspect.isfunction(getattr(dampbalance, name))]


def examples(name):
    """The docstrings of a public name and its methods that hold examples."""
    return [test for test in FINDER.find(getattr(dampbalance, name), name) if test.examples]


@pytest.mark.parametrize("name", [name for name in dampbalance.__all__ if examples(name)])
def test_its_examples_say_what_comes_out(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said: list[str] = []
    for test in examples(name):
        doctest.DocTestRunner(verbose=False).run(test, out=said.append)
    assert "".join(said) == ""


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_public_function_has_one(name):
    assert examples(name)


def test_the_package_shows_its_public_names_and_no_other():
    assert dir(dampbalance) == sorted(["__version__", *dampbalance.__all__])
    assert all(hasattr(dampbalance, name) for name in dir(dampbalance))


def test_a_wrong_example_would_be_seen():
    test = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, None)
    said: list[str] = []
    doctest.DocTestRunner().run(test, out=said.append)
    assert "Expected:\n    3" in "".join(said)
