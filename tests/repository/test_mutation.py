"""Mutation testing: it puts in the errors it says, kills a planted one, and its list of equivalents is up to date."""

from __future__ import annotations

import pytest

from mutation import __main__ as command
from mutation.mutants import mutants
from mutation.trials import PACKAGE, ROOT, Bench

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


def test_every_equivalent_mutant_is_still_a_mutant():
    for described, reason in command.equivalents().items():
        module = described[0]
        assert described in {command.described(mutant) for mutant in command.mutants_of(module)}
        assert len(reason) > 20


MODULES = {
    **dict.fromkeys(
        ["__init__.py", "arguments.py", "arrays.py", "model.py", "record.py", "motion/__init__.py"],
        "",
    ),
    "motion/jit.py": (ROOT / PACKAGE / "motion/jit.py").read_text(encoding="utf-8"),
    "motion/twice.py": "from .jit import jit\n\n\n@jit\ndef twice(x):\n    return 2.0 * x\n",
    "law.py": """
from .motion.twice import twice

LIMIT = 5


def four_times(x):
    return twice(twice(x))


def up_to_the_limit(n):
    while n < LIMIT:
        n += 1
    return n


def same(x):
    return x * 1.0
""",
}
TESTS = """
import os

import pytest

from dampbalance.law import four_times, same, up_to_the_limit


def test_four_times():
    assert four_times(1.0) == 4.0


def test_compiled():
    assert four_times(2.0) == 8.0 and __import__("dampbalance.motion.jit").motion.jit._left == 0.0


def test_same():
    assert same(3.0) > 2.0


def test_limit():
    assert up_to_the_limit(2) == 5


def test_wrong():
    assert same(3.0) == 4.0


@pytest.mark.slow
def test_slow():
    assert same(3.0) == 3.0
"""


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A project of a few modules and their tests, one of which fails whatever the package does."""
    for name, text in MODULES.items():
        path = tmp_path / "toy" / PACKAGE / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    (tmp_path / "toy/tests/unit").mkdir(parents=True)
    (tmp_path / "toy/tests/unit/test_law.py").write_text(TESTS, encoding="utf-8")
    (tmp_path / "toy/pytest.ini").write_text("[pytest]\nmarkers = slow\n", encoding="utf-8")
    monkeypatch.setattr("mutation.trials.ROOT", tmp_path / "toy")
    monkeypatch.setattr("mutation.trials.HEAVY", ["numba", "pytest"])
    monkeypatch.setattr("mutation.trials.SHORTEST", 2.0)
    monkeypatch.setattr("mutation.trials.FACTOR", 1.0)
    return Bench(tmp_path / "bench", {}, budget=60.0)


def test_a_mutant_meets_the_tests_that_call_its_function(bench, capsys):
    (file,) = bench.files
    called = {
        name.partition("::")[2]: test["called"] for name, test in bench.baseline(file).items()
    }
    assert capsys.readouterr().out.endswith(f": {file}::test_wrong\n")
    assert set(called) == {"test_four_times", "test_compiled", "test_same", "test_limit"}
    assert {"law.py:four_times", "motion/twice.py:twice"} <= {*called["test_compiled"]}
    assert "law.py:up_to_the_limit" in called["test_limit"]
    assert {*bench.baseline(file, interpreted=True)} >= {f"{file}::test_four_times"}
    assert f"{file}::test_compiled" not in bench.baseline(file, interpreted=True)

    verdicts = {}
    for module in ("law.py", "motion/twice.py"):
        for mutant in mutants(module, MODULES[module]):
            verdicts[mutant.after] = bench.trial(mutant)
            assert (bench.project / PACKAGE / module).read_text(encoding="utf-8") == MODULES[module]
    assert verdicts == {
        "6": ("killed", f"{file}::test_limit"),  # of a constant: the function that uses it
        "n <= LIMIT": ("killed", f"{file}::test_limit"),
        "n -= 1": ("timed out", ""),
        "2": ("killed", f"{file}::test_limit"),
        "not n < LIMIT": ("killed", f"{file}::test_limit"),
        "x / 1.0": ("survived", "4 tests"),
        "2.0": ("survived", "4 tests"),
        "2.0 / x": ("killed", f"{file}::test_four_times"),
        "4.0": ("killed", f"{file}::test_four_times"),
    }


def test_a_run_says_what_became_of_its_mutants_and_goes_on_where_it_stopped(
    bench, monkeypatch, capsys
):
    monkeypatch.setattr(command, "ROOT", bench.folder.parent / "toy")
    output = bench.folder.parent / "output"
    arguments = ["law.py", "--seed", "1", "--number", "4", "--output", str(output)]
    with pytest.raises(SystemExit):
        command.main(["lore.py"])
    assert "known are arguments.py, arrays.py, law.py" in capsys.readouterr().err
    status = command.main(arguments)
    text = (output / "table.md").read_text(encoding="utf-8")
    (counts,) = (line for line in text.splitlines() if line.startswith("| all "))
    number, killed, timed_out, equivalent, survived = map(int, counts.split("|")[2:-1])
    assert (number, equivalent) == (4, 0)
    assert status == int(survived > 0.4)
    assert text.startswith("Seed 1.")
    assert text.count("\n- law.py:") == survived
    assert f"Killed: {killed + timed_out} of 4 that are not equivalent" in text
    trials = (output / "trials.jsonl").read_text(encoding="utf-8").count("\n")
    monkeypatch.setattr(Bench, "trial", lambda bench, mutant: ("survived", "0 tests"))
    assert command.main(arguments) == status
    again = (output / "trials.jsonl").read_text(encoding="utf-8").count("\n")
    assert (trials, again) == (4, 4 + survived)  # those that survived are tried again
