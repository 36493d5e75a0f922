"""The house keeps its order: rooms on floors, each importing from below only, and scripts where their rules say;
slow and nightly tests are on record, and what must hold of every change is not left to the night."""

from __future__ import annotations

import ast
import re
from graphlib import TopologicalSorter
from importlib import import_module

import pytest

from folders import ROOT
from rooms import FACE, MODULES, PACKAGE, imported, reached, rooms

MOST_ROOT_MODULES = 11


def test_no_room_imports_one_that_stands_on_it():
    TopologicalSorter(rooms()).prepare()


@pytest.mark.parametrize("folder", ["trials", "examples", "paper", "workflow"])
def test_programs_import_what_the_package_has(folder):
    names = {
        (node.module, name.name)
        for path in (ROOT / folder).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("dampbalance")
        for name in node.names
    }
    assert names
    for module, name in sorted(names):
        assert f"{module}.{name}" in MODULES or hasattr(import_module(module), name), (module, name)


def test_no_import_runs_in_a_circle():
    runs = {m: imported(m, path, types=False) - FACE for m, path in MODULES.items()}
    TopologicalSorter(runs).prepare()


def test_the_method_is_a_handful_of_files():
    assert len(list(PACKAGE.glob("*.py"))) <= MOST_ROOT_MODULES


def scripts_of_rules() -> list[tuple[str, str, str, str]]:
    """(rule file, rule, the code that it names, its script) for every rule that has a script."""
    found, named_rule = [], r'\s*(?:rule (\w+):|f"([a-z]+)_\{kind)'  # the latter for each kind
    for file in sorted((ROOT / "workflow/rules").glob("*.smk")):
        rule = code = ""
        for line in file.read_text(encoding="utf-8").splitlines():
            if (named := re.match(named_rule, line)) is not None:
                rule, code = named[named.lastindex or 0], ""
            elif (rooms := re.match(r"\s*code=(.+),", line)) is not None:
                code = rooms[1]
            elif (script := re.match(r'\s*"\.\./scripts/(.+)"', line)) is not None:
                found.append((file.stem, rule, code, script[1]))
    return found


def test_a_rule_names_the_rooms_that_its_script_imports():
    """An edit in a room that is left out would rerun nothing."""
    text = "\n".join(f.read_text("utf-8") for f in sorted((ROOT / "workflow/rules").glob("*.smk")))
    values = dict(re.findall(r"^(STUDY_ROOMS|METHOD) = (\(.+?^\)|.+?$)", text, re.M | re.S))
    for _, rule, code, script in scripts_of_rules():
        path = ROOT / "workflow/scripts" / script
        from_face = re.findall(r"^from dampbalance import (.+)$", path.read_text("utf-8"), re.M)
        assert set(from_face) <= {"__version__"}  # other names may come from any room
        if code != "PACKAGE" and rule not in ("manifest", "archive", "site"):  # they have all
            names = re.findall(r'"([\w.]+)"', values["METHOD"] + values.get(code, code))
            modules = imported("scripts.script", path) - FACE
            needed = reached({module.split(".")[1] for module in modules}, rooms())
            assert needed <= {name.removesuffix(".py") for name in names}, rule
    (tour,) = [code for _, rule, code, _ in scripts_of_rules() if rule == "notebook"]
    assert tour == "PACKAGE"  # the tour takes names from the face of the package


def test_a_script_stands_where_its_rule_says_and_every_script_has_one():
    rules = [(file, rule, script) for file, rule, _, script in scripts_of_rules()]
    assert [script for file, rule, script in rules if script != f"{file}/{rule}.py"] == []
    scripts = (ROOT / "workflow/scripts").rglob("*.py")
    assert {path.relative_to(ROOT / "workflow/scripts").as_posix() for path in scripts} == {
        script for _, _, script in rules
    }


# ---- What runs when -------------------------------------------------------------------------------------------------

SLOW, NIGHTLY = (
    (ROOT / f"tests/{name}.txt").read_text(encoding="utf-8").split() for name in ("slow", "nightly")
)
NEVER_NIGHTLY = (
    *("analytic/", "motion/", "replication/test_claims.py"),
    *("replication/test_broken_rebuild.py", "repository/test_house.py"),
)
"""Claims, the broken rebuild, motion, analytic identities, the order of the house."""


@pytest.mark.parametrize("listed", [SLOW, NIGHTLY], ids=["slow", "nightly"])
def test_every_test_that_is_listed_is_there_once_and_in_order(listed):
    assert sorted({*listed}) == listed
    for file, _, test in (name.partition("::") for name in listed):
        text = (ROOT / "tests" / file).read_text(encoding="utf-8")
        assert re.search(rf"^def {test or '.*'}\(", text, re.MULTILINE), f"{file}::{test}"


def test_what_must_always_hold_is_not_left_to_the_night():
    assert [name for name in NIGHTLY if name.startswith(NEVER_NIGHTLY)] == []
