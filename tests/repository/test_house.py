"""The house keeps its order: rooms on floors, each importing from below only, and scripts where their rules say."""

from __future__ import annotations

import ast
import re
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from folders import ROOT

SOURCE = ROOT / "src"
PACKAGE = SOURCE / "dampbalance"

# From the ground up. The method is the files at the root; a room is a folder.
FLOORS = (
    "arrays",
    "arguments",
    "model",
    "record",
    "law",
    "motion",
    "features",
    "balance",
    "solver",
    "estimates",
    "project",
    "records",
    "signals",
    "fit",
    "figures",
    "identification",
    "joints",
    "loops",
    "measured",
    "replication",
    "studies",
    "publishing",
    "commands",
)
MOST_ROOT_MODULES = 11
MODULES = {
    ".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__"): path
    for path in sorted(PACKAGE.rglob("*.py"))
}
VERSION = {"dampbalance"}  # the face of the package, from which others take the version alone


def imported(module: str, path: Path, text: str | None = None) -> set[str]:
    """The modules of the package that a module imports, anywhere in it."""
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    found = set()
    for node in ast.walk(ast.parse(text or path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.ImportFrom):
            continue
        base = package[: len(package) - node.level + 1] if node.level else []
        start = ".".join([*base, *([node.module] if node.module else [])])
        for alias in node.names:
            inner = f"{start}.{alias.name}"
            found.add(inner if inner in MODULES else start)
    return {name for name in found if name in MODULES} - {module}


@cache
def graph() -> dict[str, set[str]]:
    return {module: imported(module, path) for module, path in MODULES.items()}


def floor(module: str) -> int:
    return FLOORS.index(module.split(".")[1])


def test_every_room_has_its_floor():
    rooms = {module.split(".")[1] for module in MODULES if "." in module}
    assert rooms - {"__main__"} == set(FLOORS)


def test_nothing_is_imported_from_a_higher_floor():
    upward = [
        f"{module} imports {other}"
        for module, others in graph().items()
        for other in others
        if module not in (*VERSION, "dampbalance.__main__")
        and other not in VERSION
        and floor(other) > floor(module)
    ]
    assert upward == []


def test_an_import_from_a_higher_floor_would_be_seen():
    text = "def late():\n    from .measured import identify\n"
    found = imported("dampbalance.solver", PACKAGE / "solver.py", text)
    assert found == {"dampbalance.measured"}
    assert floor(found.pop()) > floor("dampbalance.solver")


@pytest.mark.parametrize("room", ["joints", "loops"])
def test_joints_and_loops_are_known_to_the_module_that_hands_records_over_and_to_no_other(room):
    inside = {module for module in MODULES if module.split(".")[1:2] == [room]}
    importing = {module for module, others in graph().items() if others & inside}
    assert importing - inside - VERSION == {"dampbalance.measured"}


def test_no_import_runs_in_a_circle():
    TopologicalSorter({m: others - VERSION for m, others in graph().items()}).prepare()


def test_the_method_is_a_handful_of_files():
    assert len(list(PACKAGE.glob("*.py"))) <= MOST_ROOT_MODULES


@pytest.mark.parametrize(
    "face", sorted(PACKAGE.rglob("*/__init__.py")), ids=lambda path: path.parent.name
)
def test_a_room_says_what_it_is_for(face):
    words = ast.get_docstring(ast.parse(face.read_text(encoding="utf-8")))
    assert words
    assert words.split("\n")[0].endswith(".")


def scripts_of_rules() -> list[tuple[str, str, str]]:
    """(rule file, rule, its script) for every rule that has one."""
    found = []
    for file in sorted((ROOT / "workflow/rules").glob("*.smk")):
        rule = ""
        for line in file.read_text(encoding="utf-8").splitlines():
            if (named := re.match(r"\s*rule (\w+):", line)) is not None:
                rule = named[1]
            elif (script := re.match(r'\s*"\.\./scripts/(.+)"', line)) is not None:
                found.append((file.stem, rule, script[1]))
    return found


def test_a_script_stands_where_its_rule_says_and_every_script_has_one():
    rules = scripts_of_rules()
    assert [script for file, rule, script in rules if script != f"{file}/{rule}.py"] == []
    scripts = (ROOT / "workflow/scripts").rglob("*.py")
    assert {path.relative_to(ROOT / "workflow/scripts").as_posix() for path in scripts} == {
        script for _, _, script in rules
    }
