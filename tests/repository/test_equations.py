"""`paper/equations.md` is true: every equation has its line, and every function and test named there exists."""

from __future__ import annotations

import importlib
import re

from folders import ROOT

TEXT = (ROOT / "paper/equations.md").read_text(encoding="utf-8")
PACKAGE = ROOT / "src/dampbalance"
LINES = [line for line in TEXT.splitlines() if re.match(r"\| \(\d+[ab]?\)", line)]
NUMBERED = range(1, 20)
TEST = re.compile(r"`(tests/[\w/]+\.py)::(\w+)`")
FUNCTION = re.compile(r"`((?:[a-z_]+)(?:\.\w+)+)`")


def number(line):
    return int(re.match(r"\| \((\d+)", line).group(1))


def module_of(name):
    """The longest part of a dotted name that is a module of the package."""
    parts = name.split(".")
    while parts and not PACKAGE.joinpath(*parts).with_suffix(".py").is_file():
        parts.pop()
    assert parts, f"dampbalance.{name} does not exist"
    return ".".join(parts)


def named_functions(text):
    return sorted({name for name in FUNCTION.findall(text) if not name.startswith("tests")})


def test_every_equation_has_its_line_in_order_with_a_function_and_a_test():
    numbers = [number(line) for line in LINES]
    assert sorted({*numbers}) == list(NUMBERED)
    assert numbers == sorted(numbers)
    for line in LINES:
        _, _, _, functions, tests, _ = re.split(r"(?<!\\)\|", line)
        assert named_functions(functions), line
        assert TEST.findall(tests), line


def test_every_function_and_test_exists():
    for name in named_functions(TEXT):
        module = module_of(name)
        found = importlib.import_module(f"dampbalance.{module}")
        for part in name.removeprefix(f"{module}.").split("."):
            assert hasattr(found, part), f"dampbalance.{name} does not exist"
            found = getattr(found, part)
    for file, test in TEST.findall(TEXT):
        text = (ROOT / file).read_text(encoding="utf-8")
        assert re.search(rf"^def {test}\(", text, re.MULTILINE), f"{file}::{test}"
