"""Examples in docstrings run, and say what comes out: those of every public name."""

from __future__ import annotations

import doctest
import inspect

import pytest

import dampbalance

FINDER = doctest.DocTestFinder()


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


def test_every_public_function_has_one_and_the_package_shows_no_other_name():
    functions = [n for n in dampbalance.__all__ if inspect.isfunction(getattr(dampbalance, n))]
    assert [name for name in functions if not examples(name)] == []
    assert dir(dampbalance) == sorted(["__version__", *dampbalance.__all__])
