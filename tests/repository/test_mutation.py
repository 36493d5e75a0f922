"""Mutation testing: it puts in the errors it says, kills a planted one, and its list of equivalents is up to date."""

from __future__ import annotations

import sys

import pytest

from mutation import __main__ as command
from mutation.mutants import mutants
from mutation.trials import PACKAGE, ROOT, Bench, answering, files_in, modules

SOURCE = '''\
"""A module of 1 + 1 lines."""

LIMIT: float = 2.5


def clipped(values: list[float], low: int = 0) -> float:
    if not values or len(values) < 3:
        raise ValueError(f"{1 + 1} values")
    total = 0.0
    for value in values:
        total += min(value, LIMIT) * -low
        if value == LIMIT:
            break
    values.sort()
    return total


class ω:
    flag = True and None is None
'''


def test_the_errors_are_these():
    found = [(m.number, m.where, m.before, m.after) for m in mutants("toy.py", SOURCE)]
    inside = "clipped"
    condition = "not values or len(values) < 3"
    assert sorted(found) == [
        (3, "", "2.5", "5.0"),
        (6, inside, "0", "1"),
        (7, inside, "3", "4"),
        (7, inside, "len(values) < 3", "len(values) <= 3"),
        (7, inside, "not values", "values"),
        (7, inside, condition, "not (not values or len(values) < 3)"),
        (7, inside, condition, "not values and len(values) < 3"),
        (8, inside, "raise ValueError(f'{1 + 1} values')", "pass"),
        (9, inside, "0.0", "1.0"),
        (11, inside, "-low", "low"),
        (11, inside, "min", "max"),
        (11, inside, "min(value, LIMIT) * -low", "min(value, LIMIT) / -low"),
        (11, inside, "total += min(value, LIMIT) * -low", "total -= min(value, LIMIT) * -low"),
        (12, inside, "value == LIMIT", "value != LIMIT"),
        (13, inside, "break", "continue"),
        (14, inside, "values.sort()", "pass"),
        (19, "ω", "None is None", "None is not None"),
        (19, "ω", "True", "False"),
        (19, "ω", "True and None is None", "True or None is None"),
    ]


def test_a_mutant_differs_from_the_original_in_its_place_alone():
    for mutant in mutants("toy.py", SOURCE):
        changed = mutant.source(SOURCE)
        differing = [
            number
            for number, lines in enumerate(
                zip(SOURCE.splitlines(), changed.splitlines(), strict=True), start=1
            )
            if lines[0] != lines[1]
        ]
        assert differing == [mutant.number]


def test_a_sample_stays_the_same_while_other_lines_are_edited():
    def drawn(source):
        every = sorted(mutants("toy.py", source), key=lambda mutant: mutant.rank(5))
        return [(mutant.line, mutant.before, mutant.after) for mutant in every[:6]]

    edited = SOURCE.replace(
        "    values.sort()\n", "    # sorted, from low to high\n\n    values.sort()\n"
    )
    assert drawn(edited) == drawn(SOURCE)
    other = sorted(mutants("toy.py", SOURCE), key=lambda mutant: mutant.rank(6))
    assert [(m.line, m.before, m.after) for m in other[:6]] != drawn(SOURCE)


def test_every_module_of_the_method_has_tests_that_are_there():
    for module in modules():
        if not mutants(module, (ROOT / PACKAGE / module).read_text(encoding="utf-8")):
            continue  # names of types
        for name in answering(module):
            assert (ROOT / "tests" / name).exists(), name
            assert files_in(ROOT, [name])


def test_every_equivalent_mutant_is_still_a_mutant():
    for described, reason in command.equivalents().items():
        module = described[0]
        source = (ROOT / PACKAGE / module).read_text(encoding="utf-8")
        assert described in {command.described(mutant) for mutant in mutants(module, source)}
        assert len(reason) > 20


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A project of one module and its tests, one of which fails where kernels are interpreted."""
    package, tests = tmp_path / "toy" / PACKAGE, tmp_path / "toy/tests/unit"
    package.mkdir(parents=True)
    tests.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "model.py").write_text(
        "def half(x):\n    return 0.5 * x\n\n\ndef same(x):\n    return x * 1.0\n"
    )
    (tests / "test_model.py").write_text(
        "import os\n\nfrom dampbalance.model import half, same\n\n\n"
        "def test_half():\n    assert 'NUMBA_DISABLE_JIT' not in os.environ\n    assert half(4.0) == 2.0\n\n\n"
        "def test_same():\n    assert same(3.0) > 2.0\n"
    )
    monkeypatch.setattr("mutation.trials.ROOT", tmp_path / "toy")
    monkeypatch.setattr("mutation.trials.HEAVY", ["numba", "pytest"])
    monkeypatch.setitem(sys.modules["mutation.trials"].TESTS, "model.py", ("unit/test_model.py",))
    return Bench(tmp_path / "bench", tmp_path / "known.json")


def test_a_planted_error_is_killed_and_a_harmless_one_survives(bench):
    source = (bench.project / PACKAGE / "model.py").read_text(encoding="utf-8")
    every = {mutant.after: mutant for mutant in mutants("model.py", source)}
    assert set(every) == {"0.5 / x", "1.5", "x / 1.0", "2.0"}
    assert bench.trial(every["1.5"], quick=True) == ("survived", "")
    assert bench.trial(every["1.5"], quick=False) == (
        "killed",
        "tests/unit/test_model.py::test_half",
    )
    assert bench.trial(every["x / 1.0"], quick=False) == ("survived", "")
    assert (bench.project / PACKAGE / "model.py").read_text(encoding="utf-8") == source
