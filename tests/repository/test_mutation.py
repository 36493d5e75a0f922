"""Mutation testing: it puts in the errors it says, kills a planted one, and its list of equivalents is up to date."""

from __future__ import annotations

import re

import pytest

from mutation import __main__ as command
from mutation.__main__ import PACKAGE, ROOT, Bench
from mutation.mutants import mutants

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
MUTANTS = [*mutants("toy.py", SOURCE.encode())]


def test_the_errors_are_these():
    found = [(m.number, m.where, m.before, m.after) for m in MUTANTS]
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
    for mutant in MUTANTS:
        changed = mutant.source(SOURCE.encode()).decode().splitlines()
        pairs = enumerate(zip(SOURCE.splitlines(), changed, strict=True), start=1)
        assert [number for number, (before, after) in pairs if before != after] == [mutant.number]
        compile("\n".join(changed), "toy.py", "exec")


def test_the_samples_on_record_name_no_module_that_is_gone():
    text = (ROOT / "trials/mutation/README.md").read_text(encoding="utf-8")
    folders = (ROOT / PACKAGE, ROOT / PACKAGE / "replication/claims", ROOT / "trials/mutation")
    names = re.findall(r"[\w/]+\.py\b", text)
    assert names
    for name in names:
        assert any((folder / name).is_file() for folder in folders), name
    # a survivor: its module, its line, and the code that stands there
    for name, code in re.findall(r"^- ([\w/]+\.py):\d+ `([^`]+)`", text, re.MULTILINE):
        assert code in (ROOT / PACKAGE / name).read_text(encoding="utf-8"), f"{name} has no {code}"


def test_a_sample_stays_the_same_while_other_lines_are_edited():
    def drawn(source, seed):
        every = sorted(mutants("toy.py", source.encode()), key=lambda mutant: mutant.rank(seed))
        return [(mutant.line, mutant.before, mutant.after) for mutant in every[:6]]

    edited = SOURCE.replace("    values.sort()\n", "    # from low to high\n\n    values.sort()\n")
    assert drawn(edited, 5) == drawn(SOURCE, 5)
    assert drawn(SOURCE, 6) != drawn(SOURCE, 5)


@pytest.mark.parametrize(
    ("module", "entry"),
    [(m, entry) for m, listed in command.EQUIVALENT.items() for entry in listed],
)
def test_every_equivalent_mutant_is_still_a_mutant(module, entry, monkeypatch):
    monkeypatch.setattr(command, "EQUIVALENT", {module: [entry]})
    assert any(map(command.equivalent, command.mutants_of(module)))
    assert len(entry["reason"]) > 20


MODULES = {
    **dict.fromkeys(
        ["__init__.py", "arguments.py", "arrays.py", "model.py", "record.py", "motion/__init__.py"],
        "",
    ),
    "motion/jit.py": (ROOT / PACKAGE / "motion/jit.py").read_text(encoding="utf-8"),
    "motion/twice.py": "from .jit import jit\n\n\n@jit\ndef twice(x):\n    return 2.0 * x\n",
    "law.py": """
import time

from .motion.twice import twice

LIMIT = 5


def four_times(x):
    return twice(twice(x))


def up_to_the_limit(n):
    while n < LIMIT:
        time.sleep(0.001)  # a mutant without an end leaves the processor to others
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
    (tmp_path / "toy/tests/method").mkdir(parents=True)
    (tmp_path / "toy/tests/method/test_law.py").write_text(TESTS, encoding="utf-8")
    (tmp_path / "toy/pytest.ini").write_text("[pytest]\nmarkers = slow\n", encoding="utf-8")
    monkeypatch.setattr(command, "ROOT", tmp_path / "toy")
    monkeypatch.setattr(command, "SHORTEST", 10.0)  # s: a mutant without an end takes all of them
    monkeypatch.setattr(command, "COMPILING", 20.0)
    return Bench(tmp_path / "bench")


@pytest.mark.slow
def test_a_mutant_meets_the_tests_that_call_its_function(bench, capsys):
    (file,) = bench.files
    passing = bench.passing(file)
    called = {name.partition("::")[2]: test["called"] for name, test in passing.items()}
    assert capsys.readouterr().out.endswith(f": {file}::test_wrong\n")
    assert {*called} == {"test_four_times", "test_compiled", "test_same", "test_limit"}
    assert {"law.py:four_times", "motion/twice.py:twice"} <= {*called["test_compiled"]}
    assert "law.py:up_to_the_limit" in called["test_limit"]
    assert {*bench.passing(file, True)} == {*passing} - {f"{file}::test_compiled"}

    # one mutant of each kind of verdict, as each starts pytest anew
    expected = {
        "6": ("killed", f"{file}::test_limit"),  # of a constant: the function that uses it
        "n -= 1": ("timed out", ""),
        "x / 1.0": ("survived", "4 tests"),
        "2.0 / x": ("killed", f"{file}::test_four_times"),
    }
    verdicts = {}
    for module in ("law.py", "motion/twice.py"):
        for mutant in mutants(module, MODULES[module].encode()):
            if mutant.after in expected:
                verdicts[mutant.after] = bench.trial(mutant, budget=60.0)
                kept = (bench.project / PACKAGE / module).read_text(encoding="utf-8")
                assert kept == MODULES[module]
    assert verdicts == expected


def test_a_run_reports_what_became_of_its_mutants(tmp_path, monkeypatch, capsys):
    class Fake:
        def __init__(self, folder):
            folder.mkdir()

        def trial(self, mutant, budget):
            return ("killed", "a test") if "1.0" in mutant.before else ("survived", f"{budget} s")

    monkeypatch.setattr(command, "Bench", Fake)
    monkeypatch.setattr(command, "modules", lambda: ["law.py", "motion/twice.py"])
    monkeypatch.setattr(command, "EQUIVALENT", {"law.py": [{"after": "6", "reason": "none asks"}]})
    monkeypatch.setattr(
        command, "mutants_of", lambda module: [*mutants(module, MODULES[module].encode())]
    )
    with pytest.raises(SystemExit):
        command.main(["lore.py"])
    assert "known are law.py, motion/twice.py" in capsys.readouterr().err
    arguments = ["--seed", "1", "--number", "50", "--budget", "9", "--output"]
    assert command.main([*arguments, str(tmp_path / "all")]) == 1
    text = (tmp_path / "all/table.md").read_text(encoding="utf-8")
    assert text.startswith("Seed 1.\n\n| room | mutants | killed | timed out | equivalent | ")
    assert "\n| law.py | 9 | 2 | 0 | 1 | 6 |\n| motion | 2 | 0 | 0 | 0 | 2 |\n" in text
    assert "Killed: 2 of 10 that are not equivalent; the goal is 90%." in text
    assert "\n- motion/twice.py:6 `2.0 * x` → `2.0 / x` in `return 2.0 * x` (9.0 s)\n" in text
    command.main([*arguments[:3], "4", "--output", str(tmp_path / "some")])
    assert "\n| all | 4 |" in (tmp_path / "some/table.md").read_text(encoding="utf-8")
