"""The page of the interface, `paper/site/reference/interface.md`, lists what the code has: no more and no less.

Each section of the page is a list of names by what they belong to, "- `owner`: `name`, `name`".
"""

from __future__ import annotations

import argparse
import dataclasses
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

PAGE = ROOT / "paper/site/reference/interface.md"
BUILT = "BaseMotion", "Oscillator"  # classes whose objects a user makes
REGISTERED = {"approach": APPROACHES, "term": KNOWN_TERMS}
Names = Iterator[tuple[str, list[str]]]


# --- Python ---------------------------------------------------------------------------------------


def call(name: str, function: Any) -> tuple[str, list[str]]:
    """A call by position, "identify(records, stiffness=None)", and the parameters that only a name gives."""
    given = [p.replace(annotation=p.empty) for p in inspect.signature(function).parameters.values()]
    given = [p for p in given if p.name not in ("self", "cls", "unknown")]
    named = [p for p in given if p.kind in (p.KEYWORD_ONLY, p.VAR_KEYWORD)]
    return f"{name}({', '.join(str(p) for p in given if p not in named)})", [*map(str, named)]


def members(name: str, of: type) -> Names:
    """The attributes of a class that it does not inherit from Python, and calls of its methods."""
    places = [vars(base) for base in of.__mro__ if base.__module__.startswith("dampbalance")]
    fields = [f.name for f in dataclasses.fields(of)] if dataclasses.is_dataclass(of) else []
    public = dict.fromkeys(n for n in [*fields, *(n for v in places for n in v)] if n[0] != "_")
    if of is Result:
        public = dict.fromkeys(n for n in public if n in dir(results()[0]))
    listed = []
    for attribute in public:
        member = inspect.getattr_static(of, attribute, None)
        member = getattr(member, "__func__", member)
        head, named = call(attribute, member) if inspect.isfunction(member) else (attribute, [])
        listed += [head] * (not named)
        yield from [(f"{name}.{head}", named)] * bool(named)
    head, _ = call(name, of) if name in BUILT else (name, None)
    yield head, [n for n in listed if f"{n}=" not in head and n not in re.findall(r"\w+", head)[1:]]


def python() -> Names:
    for name in dampbalance.__all__:
        item = getattr(dampbalance, name)
        if not inspect.isclass(item):
            yield call(name, item)
        elif issubclass(item, Exception):
            yield name, [item.__base__.__name__]
        else:
            yield from members(name, item)
    yield "Result.summary()", [*results()[0].summary()]
    yield "verdicts", [USABLE, DOUBTFUL, NONE]
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    yield "extras", [*extras["optional-dependencies"]]


# --- the command line -----------------------------------------------------------------------------


def command_line() -> Names:
    waiting = [("dampbalance", parser())]
    while waiting:
        name, of = waiting.pop()
        listed = []
        for action in of._actions:
            if isinstance(action, argparse._SubParsersAction):
                waiting += [(f"{name} {command}", sub) for command, sub in action.choices.items()]
            elif action.dest != "help":
                none = any(action.default is one for one in (None, False, argparse.SUPPRESS))
                option = action.option_strings[0] if action.option_strings else action.dest
                listed.append(option if none else f"{option} {action.default}")
                if action.choices:
                    yield f"{name} {option}", [*action.choices]
        yield name, listed


# --- files that are read --------------------------------------------------------------------------


def keys(schema: Any, node: Any, path: str = "") -> Names:
    """The keys of each mapping and the words of each value; * for any key of those that are described alike."""
    node = node | schema.get("$defs", {}).get(node.get("$ref", "").rpartition("/")[2], {})
    words = [*REGISTERED.get(node.get("registered"), ()), *node.get("also", ()), *node.get("enum", ())]
    yield path, [str(w) if str(w).strip() else repr(w) for w in words]
    inside = node.get("properties", {})
    yield path, [*inside]
    for name, child in inside.items():
        alike = [*inside.values()].count(child) > 1
        yield from keys(schema, child, f"{path}.{'*' if alike else name}")
    for word, mark in (("items", "[]"), ("additionalProperties", ".*")):
        if isinstance(node.get(word), dict):
            yield from keys(schema, node[word], path + mark)
    for child in node.get("anyOf", ()):
        yield from keys(schema, child, path)


def file(name: str) -> Names:
    return keys(schema_of(name), schema_of(name))


# --- files that are written -----------------------------------------------------------------------


@cache
def results() -> list[Result[Any]]:
    """A result of each kind of records."""
    ringing = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=20800.0, F_k=0.5)
    decay = measured_ring_down(ringing, x=0.01, rate_hz=500.0, duration=2.0, noise=0.001)
    t, (v, force) = np.linspace(0.0, 10.0, 2001), np.array([np.arange(-3.0, 3.1, 0.4)] * 2)
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


NAMED = "approaches", "verdicts", "sensitivities", "contacts"  # by what is their own name


def within(value: Any, path: str = "") -> Names:
    """The keys of plain data, * for any of those that are names; what a finding says has keys of its own."""
    if isinstance(value, list):
        for item in value:
            yield from within(item, f"{path}[]")
    elif isinstance(value, dict):
        yield path.replace("maximum_likelihood", "approaches.*"), [*value]
        for key, inner in value.items():
            if not path.endswith("findings[]"):
                yield from within(inner, f"{path}.{'*' if path.endswith(NAMED) else key}")


def identification() -> Names:
    for result in results():
        yield from within(plain(result.document()))
    yield "files", [*TABLES, REPORT]


def paper() -> Names:
    yield "claims.csv", [*CLAIM_COLUMNS]
    yield "verdict", [*VERDICTS]
    yield "kind", [*KINDS]
    yield "numbers.csv", ["id", *numbers.Key._fields, *numbers.COLUMNS]


SECTIONS = {
    "Python": python,
    "Command line": command_line,
    "Configuration": lambda: file("config"),
    "Mappings": lambda: file("mapping"),
    "Studies": lambda: file("study"),
    "Results of an identification": identification,
    "Results of the paper": paper,
}


def of_code(section: str) -> set[tuple[str, str]]:
    """(owner, name) of all that the code has; a call has an empty name, too."""
    lists = [(of.strip(".") or "top level", names) for of, names in SECTIONS[section]()]
    return {(of, n) for of, names in lists for n in [*names, *[""] * ("(" in of)]}


def of_page(section: str) -> set[tuple[str, str]]:
    """(owner, name) of all that a section of the page lists."""
    text = re.split(r"^## ", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    (found,) = [part for part in text if part.startswith(f"{section}\n")]
    listed = set()
    for entry in re.findall(r"^- (`.*?)(?=^\S|\Z|^$)", found, re.MULTILINE | re.DOTALL):
        owners, _, names = entry.replace("\n  ", " ").partition("`: ")
        for of in re.findall("`([^`]+)`", f"{owners}`"):
            listed |= {(of, name) for name in re.findall("`(.+?)`", names)}
            listed |= {(of, "")} if "(" in of else set()
    return listed


@pytest.mark.parametrize("section", SECTIONS)
def test_the_interface_is_what_its_page_lists(section):
    code, page, left_out = of_code(section), of_page(section), of_page("Left out")
    remedy = "put it back, under its name, or this is a new major version"
    assert sorted(page - code) == [], f"the page keeps these, and the code lacks them: {remedy}"
    remedy = "a new minor version: list it in paper/site/reference/interface.md"
    assert sorted(code - page - left_out) == [], f"the code has these, and the page lacks them: {remedy}"


def test_what_the_page_leaves_out_is_there():
    assert sorted(of_page("Left out") - of_code("Python")) == []
