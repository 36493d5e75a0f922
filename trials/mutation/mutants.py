"""Mutants of a module: the same source with one small error in it.

Errors put in: a comparison moved to or off its border or turned round, a condition negated, `and` for `or`, another
arithmetic operator, a sign or a `not` lost, a number one larger, True for False, the smaller for the larger
(and the like), a `raise` or a call for its effect left out, `break` for `continue`. Words are left alone, and so is
what does not run: annotations, decorators, `TYPE_CHECKING`.
"""

from __future__ import annotations

import ast
import copy
import hashlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

_BOTH_WAYS = """
Lt LtE, Gt GtE, Eq NotEq, Is IsNot, In NotIn, And Or, Add Sub, Mult Div, BitAnd BitOr, Break Continue,
min max, any all, argmin argmax, nanmin nanmax, minimum maximum, floor ceil, sin cos, real imag
"""
_ONE_WAY = "FloorDiv Div, Mod Mult, Pow Mult, MatMult Mult"
_BOTH, _ONE = ([pair.split() for pair in pairs.split(",")] for pairs in (_BOTH_WAYS, _ONE_WAY))
_OTHER = dict([*_BOTH, *((other, one) for one, other in _BOTH), *_ONE])
"""What stands in the place of an operator, a statement or a function, by their names."""
_NOT_RUN = ("annotation", "returns", "decorator_list", "bases")


@dataclass(frozen=True)
class Mutant:
    """One error: `before` becomes `after` in the function `where`, in the line whose text is `line`.

    number : of the line.   start, end : place of the replaced text in the source, in bytes.   text : what stands there
    instead.   occurrence : of `before` in the line, from 1.
    """

    module: str
    number: int
    where: str
    line: str
    before: str
    after: str
    start: int
    end: int
    text: str
    occurrence: int = 1

    def source(self, original: str) -> str:
        """The source of the module with the error in it; SyntaxError if that is no Python."""
        data = original.encode()
        changed = (data[: self.start] + self.text.encode() + data[self.end :]).decode()
        compile(changed, self.module, "exec")
        return changed

    def rank(self, seed: int) -> str:
        """By which a sample is drawn: an edit elsewhere in the module leaves the others' ranks alone."""
        words = (str(seed), self.module, self.where, self.line, self.before, self.after)
        again = f" {self.occurrence}" if self.occurrence > 1 else ""
        return hashlib.sha256(("\0".join(words) + again).encode()).hexdigest()


def mutants(module: str, source: str) -> list[Mutant]:
    """All mutants of a module, in the order of its lines."""
    lines = source.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line.encode()))
    found = []
    for where, node, changed in _changes(ast.parse(source), ""):
        first, last = node.lineno, node.end_lineno or 0
        after = ast.unparse(changed)
        text = after if isinstance(node, ast.stmt) else f"({after})"
        place = starts[first - 1] + node.col_offset, starts[last - 1] + (node.end_col_offset or 0)
        words = lines[first - 1].strip(), ast.unparse(node), after
        found.append(Mutant(module, first, where, *words, *place, text))
    found.sort(key=lambda mutant: (mutant.start, mutant.end, mutant.after))
    seen: Counter[tuple[int, str, str]] = Counter()
    for i, mutant in enumerate(found):
        alike = mutant.number, mutant.before, mutant.after
        seen[alike] += 1
        found[i] = replace(mutant, occurrence=seen[alike])
    return found


def _changes(node: ast.AST, where: str) -> Iterator[tuple[str, ast.expr | ast.stmt, ast.AST]]:
    """(function, node, what replaces it) for a node and all that it holds."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        where = f"{where}.{node.name}".lstrip(".")
    # A formatted string gives its parts no positions of their own before Python 3.12.
    if isinstance(node, (ast.JoinedStr, ast.Import, ast.ImportFrom)) or (
        isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    ):
        return
    for original, changed in _of_node(node):
        yield where, original, changed
    for name, value in ast.iter_fields(node):
        for child in value if isinstance(value, list) else [value]:
            strict = isinstance(child, ast.keyword) and child.arg == "strict"
            # the lengths are equal wherever the callers are right
            if isinstance(child, ast.AST) and not strict and name not in _NOT_RUN:
                yield from _changes(child, where)


def _of_node(node: ast.AST) -> Iterator[tuple[ast.expr | ast.stmt, ast.AST]]:
    """The errors that can be put into one node."""
    other = _OTHER.get(type(getattr(node, "op", node)).__name__, "")
    match node:
        case ast.Compare():
            for i, operator in enumerate(node.ops):
                changed = copy.deepcopy(node)
                changed.ops[i] = getattr(ast, _OTHER[type(operator).__name__])()
                yield node, changed
        case ast.BoolOp() | ast.BinOp() | ast.AugAssign() if other:
            changed = copy.deepcopy(node)
            changed.op = getattr(ast, other)()
            yield node, changed
        case ast.UnaryOp(op=ast.USub() | ast.Not() | ast.Invert()):
            yield node, node.operand
        case ast.Constant(value=bool()):
            yield node, ast.Constant(not node.value)
        case ast.Constant(value=int() | complex()):
            yield node, ast.Constant(node.value + 1)
        case ast.Constant(value=float()):
            yield node, ast.Constant(2.0 * node.value if node.value > 1.0 else node.value + 1.0)
        case ast.Name(ctx=ast.Load()) if node.id in _OTHER:
            yield node, ast.Name(_OTHER[node.id])
        case ast.Attribute(ctx=ast.Load()) if node.attr in _OTHER:
            yield node, ast.Attribute(node.value, _OTHER[node.attr])
        case ast.Raise() | ast.Expr(value=ast.Call()):
            yield node, ast.Pass()
        case ast.Break() | ast.Continue():
            yield node, getattr(ast, other)()
        case ast.If() | ast.IfExp() | ast.While() if not _turned_anyway(node.test):
            yield node.test, ast.UnaryOp(ast.Not(), node.test)


def _turned_anyway(condition: ast.expr) -> bool:
    """Whether another error turns the condition round: a `not` lost, == for !=."""
    turned = (ast.Eq, ast.NotEq, ast.Is, ast.IsNot, ast.In, ast.NotIn)
    match condition:
        case ast.Compare(ops=[operator]):
            return isinstance(operator, turned)
        case ast.UnaryOp() | ast.Constant():
            return True
    return False
