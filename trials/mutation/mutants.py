"""Mutants of a module: the same source with one small error in it.

Words are left alone, and so is what does not run: annotations, decorators, `TYPE_CHECKING`.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

# What stands in the place of an operator, a statement or a function, by their names.
_BOTH_WAYS = """
Lt LtE, Gt GtE, Eq NotEq, Is IsNot, In NotIn, And Or, Add Sub, Mult Div, BitAnd BitOr, Break Continue,
min max, any all, argmin argmax, nanmin nanmax, minimum maximum, floor ceil, sin cos, real imag
"""
_PAIRS = [pair.split() for pair in _BOTH_WAYS.split(",")]
_COUNTERPART = dict([*_PAIRS, *map(reversed, _PAIRS)])
_COUNTERPART |= {"FloorDiv": "Div", "Mod": "Mult", "Pow": "Mult", "MatMult": "Mult"}
_TURNED = (ast.Eq, ast.NotEq, ast.Is, ast.IsNot, ast.In, ast.NotIn)
_NOT_RUN = ("annotation", "returns", "decorator_list", "bases")


@dataclass(frozen=True)
class Mutant:
    """One error: `before` becomes `after` in the function `where`, in the line whose text is `line`.

    column : of `before`, in bytes.   place, text : the bytes of the source that are replaced, and what replaces them.
    """

    module: str
    number: int
    column: int
    where: str
    line: str
    before: str
    after: str
    place: slice
    text: str

    def __str__(self) -> str:
        return f"{self.module}:{self.number} `{self.before}` → `{self.after}` in `{self.line}`"

    def source(self, original: bytes) -> bytes:
        """Return the source of the module with the error in it."""
        return original[: self.place.start] + self.text.encode() + original[self.place.stop :]

    def rank(self, seed: int) -> str:
        """Return the key by which a sample is drawn; an edit of another line of the module does not change it."""
        words = seed, self.module, self.where, self.line, self.column, self.before, self.after
        return hashlib.sha256("\0".join(map(str, words)).encode()).hexdigest()


def mutants(module: str, source: bytes) -> Iterator[Mutant]:
    """Yield all mutants of a module."""
    lines = source.splitlines(keepends=True)
    starts = [0, *accumulate(map(len, lines))]
    for where, node, changed in _changes(ast.parse(source), ""):
        line, column, after = node.lineno, node.col_offset, ast.unparse(changed)
        end = starts[node.end_lineno - 1] + node.end_col_offset
        words = where, lines[line - 1].decode().strip(), ast.unparse(node), after
        text = after if isinstance(node, ast.stmt) else f"({after})"
        yield Mutant(module, line, column, *words, slice(starts[line - 1] + column, end), text)


def _changes(node: ast.AST, where: str) -> Iterator[tuple[str, Any, ast.AST]]:
    """Yield the function, the node and its replacement, for every error in a node and in all that it holds."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        where = f"{where}.{node.name}".lstrip(".")
    # A formatted string gives its parts no positions of their own before Python 3.12.
    imports = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    if imports or isinstance(node, (ast.JoinedStr, ast.Import, ast.ImportFrom)):
        return
    for original, changed in _of_node(node):
        yield where, original, changed
    for name, value in ast.iter_fields(node):
        for child in value if isinstance(value, list) else [value]:
            strict = isinstance(child, ast.keyword) and child.arg == "strict"
            # the lengths are equal wherever the callers are right
            if isinstance(child, ast.AST) and not strict and name not in _NOT_RUN:
                yield from _changes(child, where)


def _of_node(node: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    """Yield the errors that can be put into one node, as pairs of a node and its replacement."""
    other = _COUNTERPART.get(type(getattr(node, "op", node)).__name__, "")
    match node:
        case ast.Compare():
            for i, operator in enumerate(node.ops):
                ops = [*node.ops]
                ops[i] = getattr(ast, _COUNTERPART[type(operator).__name__])()
                yield node, ast.Compare(node.left, ops, node.comparators)
        case ast.BoolOp() | ast.BinOp() | ast.AugAssign() if other:
            yield node, type(node)(**{**vars(node), "op": getattr(ast, other)()})
        case ast.UnaryOp(op=ast.USub() | ast.Not() | ast.Invert()):
            yield node, node.operand
        case ast.Constant(value=bool()):
            yield node, ast.Constant(not node.value)
        case ast.Constant(value=int() | complex()):
            yield node, ast.Constant(node.value + 1)
        case ast.Constant(value=float()):
            yield node, ast.Constant(2.0 * node.value if node.value > 1.0 else node.value + 1.0)
        case ast.Name(ctx=ast.Load()) if node.id in _COUNTERPART:
            yield node, ast.Name(_COUNTERPART[node.id])
        case ast.Attribute(ctx=ast.Load()) if node.attr in _COUNTERPART:
            yield node, ast.Attribute(node.value, _COUNTERPART[node.attr])
        case ast.Raise() | ast.Expr(value=ast.Call()):
            yield node, ast.Pass()
        case ast.Break() | ast.Continue():
            yield node, getattr(ast, other)()
        case ast.If() | ast.IfExp() | ast.While():
            # other errors turn the others round anyway: a `not` lost, == for !=
            turned = len(ops := getattr(node.test, "ops", [])) == 1 and isinstance(ops[0], _TURNED)
            if not turned and not isinstance(node.test, (ast.UnaryOp, ast.Constant)):
                yield node.test, ast.UnaryOp(ast.Not(), node.test)
