"""Prose of the code: a docstring of a function begins with a verb, and no docstring with a word that has no agent."""

from __future__ import annotations

import ast

import pytest

from folders import ROOT

FOLDERS = "src/dampbalance", "workflow", "trials", "examples"

VERBS = {
    *("Add", "Allow", "Begin", "Build", "Change", "Check", "Choose", "Collect", "Compare"),
    *("Compile", "Compute", "Count", "Describe", "Draw", "Evaluate", "Explain", "Fit", "Follow"),
    *("Group", "Identify", "Import", "Judge", "Keep", "Leave", "Let", "List", "Load", "Look"),
    *("Make", "Mark", "Maximise", "Measure", "Move", "Name", "Parse", "Raise", "Read", "Refuse"),
    *("Remove", "Replace", "Return", "Run", "Say", "Set", "Simulate", "Solve", "Stack", "State"),
    *("Step", "Tabulate", "Take", "Test", "Try", "Turn", "Write", "Yield"),
}
"""A verb that is missing here may be added; "Return" says most."""

WITHOUT_AGENT = {"Of", "What", "As", "By", "Its"}
"""First words of no docstring at all, that of a module, a class or a property neither; "The same" is none, either."""


def first_words(node):
    text = ast.get_docstring(node)
    return text.split()[:2] if text else []


def is_property(node):
    names = {getattr(of, "id", getattr(of, "attr", "")) for of in node.decorator_list}
    return bool(names & {"property", "cached_property", "setter"})


@pytest.mark.parametrize("folder", FOLDERS)
def test_docstrings_begin_with_what_is_returned_or_done(folder):
    odd = []
    for path in sorted((ROOT / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                continue
            words = first_words(node)
            verb = isinstance(node, ast.FunctionDef) and not (
                is_property(node) or node.name.startswith("__")
            )
            if words and (
                words[0] in WITHOUT_AGENT
                or words == ["The", "same"]
                or (verb and words[0].rstrip(",.:;") not in VERBS)
            ):
                odd.append(f"{path.relative_to(ROOT)}: {' '.join(words)} …")
    assert odd == []
