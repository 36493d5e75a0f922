"""The page of the interface, `paper/site/reference/interface.md`, lists what the code has: no more and no less.

An entry of the page is a line "- `owner`: `name`, `name`"; here it is (owner, names).
"""

from __future__ import annotations

import argparse
import inspect
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

import dampbalance
from dampbalance import Oscillator, Result, identify, measured_ring_down
from dampbalance.balance import APPROACHES
from dampbalance.commands.main import parser
from dampbalance.identification.answer import DOUBTFUL, NONE, USABLE
from dampbalance.identification.outputs import REPORT, TABLES
from dampbalance.law.terms import KNOWN_TERMS
from dampbalance.project.files import plain
from dampbalance.replication import numbers
from dampbalance.replication.claims.table import CLAIM_COLUMNS
from dampbalance.replication.claims.verdicts import KINDS, VERDICTS
from folders import ROOT
from identification.levels import measured
from paper_case import PAPER
from schemas import schema_of

pytestmark = pytest.mark.slow

PAGE = "paper/site/reference/interface.md"
BUILT = "BaseMotion", "Oscillator"  # classes whose objects a user makes
REGISTERED = {None: (), "approach": APPROACHES, "term": KNOWN_TERMS}
NAMED = "approaches", "verdicts", "sensitivities", "contacts"  # whose keys are names
Entries = Iterator[tuple[str, list[str]]]


@cache
def results() -> list[Result[Any]]:
    """A result of each kind of records."""
    ringing = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=20800.0, F_k=0.5)
    decay = measured_ring_down(ringing, x=0.01, rate_hz=500.0, duration=2.0, noise=0.001)
    t, v = np.linspace(0.0, 10.0, 2001), np.arange(-3.0, 3.1, 0.4)
    x = np.sin(2.0 * np.pi * t)
    slipping = 50.0 * x + 5.0 * np.tanh(20.0 * np.cos(2.0 * np.pi * t))
    falling = np.sign(v) * (1.0 + np.exp(-(v**2))) + 0.5 * v + 0.01 * np.cos(9.0 * v)
    return [
        identify(measured(rate_hz=500.0), PAPER.k, laws=True),
        identify(decay, ringing.k),
        identify(ROOT / "config/records/stepped/levels.csv"),
        identify({"time_s": t, "displacement_mm": x, "force_N": slipping}, normal_force=50.0),
        identify({"velocity_m_per_s": v, "force_N": falling}),
    ]


def call(name: str, function: Any) -> tuple[str, list[str]]:
    """A call by position, "identify(records, stiffness=None)", and the parameters that are given by name."""
    given = [p.replace(annotation=p.empty) for p in inspect.signature(function).parameters.values()]
    given = [p for p in given if p.name not in ("self", "cls", "unknown")]
    named = [p for p in given if p.kind in (p.KEYWORD_ONLY, p.VAR_KEYWORD)]
    return f"{name}({', '.join(str(p) for p in given if p not in named)})", [*map(str, named)]


def attributes(name: str, of: type) -> Entries:
    """What a class does not have from Python; of a result, what is completed."""
    own = [base for base in of.__mro__ if base.__module__.startswith("dampbalance")]
    found = {n for base in own for n in vars(base)} | {*getattr(of, "__dataclass_fields__", ())}
    found &= {*dir(results()[0])} if of is Result else found
    shown = []
    for attribute in sorted(n for n in found if n[0] != "_"):
        member = inspect.getattr_static(of, attribute, None)
        member = getattr(member, "__func__", member)  # of a class method
        head, named = call(attribute, member) if inspect.isfunction(member) else (attribute, [])
        shown.append(head)
        yield f"{name}.{head}", named
    yield (call(name, of)[0] if name in BUILT else name), shown


def python() -> Entries:
    for name in dampbalance.__all__:
        item = getattr(dampbalance, name)
        if not inspect.isclass(item):
            yield call(name, item)
        elif issubclass(item, Exception):
            yield name, [item.__base__.__name__]
        else:
            yield from attributes(name, item)
    yield "Result.summary()", [*results()[0].summary()]
    yield "verdicts", [USABLE, DOUBTFUL, NONE]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    yield "extras", [*project["optional-dependencies"]]


def command(of: argparse.ArgumentParser, name: str = "dampbalance") -> Entries:
    """Options with their defaults, and the words that can be chosen."""
    for action in of._actions:
        option = (*action.option_strings, action.dest)[0]
        if isinstance(action, argparse._SubParsersAction):
            for inner, below in action.choices.items():
                yield from command(below, f"{name} {inner}")
        elif option != "-h":
            none = any(action.default is one for one in (None, False, argparse.SUPPRESS))
            yield name, [option if none else f"{option} {action.default}"]
            yield f"{name} {option}", [*(action.choices or ())]


def keys(schema: Any, node: Any, path: str = "") -> Entries:
    """The keys of each mapping and the words of each value; * for those of several keys that are described alike."""
    node = node | schema.get("$defs", {}).get(node.get("$ref", "").rpartition("/")[2], {})
    words = *REGISTERED[node.get("registered")], *node.get("also", ()), *node.get("enum", ())
    inside = node.get("properties", {})
    yield path, [*(str(w) if str(w).strip() else repr(w) for w in words), *inside]
    for name, child in inside.items():
        alike = [*inside.values()].count(child) > 1
        yield from keys(schema, child, f"{path}.{'*' if alike else name}")
    for word, mark in (("items", "[]"), ("additionalProperties", ".*")):
        if isinstance(node.get(word), dict):
            yield from keys(schema, node[word], path + mark)
    for child in node.get("anyOf", ()):
        yield from keys(schema, child, path)


def within(value: Any, path: str = "") -> Entries:
    """The keys of plain data, * for names; those of a finding depend on its code."""
    if isinstance(value, list):
        for item in value:
            yield from within(item, f"{path}[]")
    elif isinstance(value, dict):
        yield path.replace("maximum_likelihood", "approaches.*"), [*value]
        for key, inner in value.items():
            if not path.endswith("findings[]"):
                yield from within(inner, f"{path}.{'*' if path.endswith(NAMED) else key}")


def identification() -> Entries:
    for result in results():
        yield from within(plain(result.document()))
    yield "files", [*TABLES, REPORT]


def paper() -> Entries:
    yield "claims.csv", [*CLAIM_COLUMNS]
    yield "verdict", [*VERDICTS]
    yield "kind", [*KINDS]
    yield "numbers.csv", ["id", *numbers.Key._fields, *numbers.COLUMNS]


SECTIONS = {
    "Python": python,
    "Command line": lambda: command(parser()),
    "Configuration": lambda: keys(schema_of("config"), schema_of("config")),
    "Mappings": lambda: keys(schema_of("mapping"), schema_of("mapping")),
    "Studies": lambda: keys(schema_of("study"), schema_of("study")),
    "Results of an identification": identification,
    "Results of the paper": paper,
}


def on_page(section: str) -> set[tuple[str, str]]:
    """(owner, name) of all entries of a section; a function that takes nothing by name has the name ""."""
    (text,) = re.findall(
        rf"^## {section}\n(.*?)(?=^## |\Z)", (ROOT / PAGE).read_text("utf-8"), re.M | re.S
    )
    found = set()
    for entry in re.findall(r"^- (.+(?:\n  .+)*)", text, re.M):
        owners, _, names = entry.partition("`: ")
        for owner in re.findall("`([^`]+)`", f"{owners}`"):
            found |= {
                (owner, " ".join(name.split())) for name in re.findall("`([^`]+)`", names) or [""]
            }
    return found


@pytest.mark.parametrize("section", SECTIONS)
def test_the_interface_is_what_its_page_lists(section):
    code = set()
    for path, names in SECTIONS[section]():
        owner = path.strip(".") or "top level"
        code |= {(owner, name) for name in names or [""] * (owner[-1] == ")" and "." not in owner)}
    kept, left_out = on_page(section), on_page("Left out")
    gone, new = sorted(kept - code), sorted(code - kept - left_out)
    assert gone == [], f"{PAGE} lists what is gone: bring it back, or this is a new major version"
    assert new == [], f"a new minor version: list it in {PAGE}"
