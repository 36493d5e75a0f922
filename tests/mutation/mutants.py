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

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Div,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.MatMult: ast.Mult,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
_PAIRS = (
    ("min", "max"),
    ("any", "all"),
    ("argmin", "argmax"),
    ("nanmin", "nanmax"),
    ("minimum", "maximum"),
    ("floor", "ceil"),
    ("sin", "cos"),
    ("real", "imag"),
)
NAMES = dict(_PAIRS) | {other: name for name, other in _PAIRS}

_TURNED = (ast.Eq, ast.NotEq, ast.Is, ast.IsNot, ast.In, ast.NotIn)


@dataclass(frozen=True)
class Mutant:
    """One error: `before` becomes `after` in the function `where`, in the line whose text is `line`.

    number : of the line.   occurrence : of `before` in the line, from 1.
    start, end : place of the replaced text in the source, in bytes.   text : what stands there instead.
    """

    module: str
    number: int
    where: str
    line: str
    before: str
    after: str
    occurrence: int
    start: int
    end: int
    text: str

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
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        after = ast.unparse(changed)
        mutant = Mutant(
            module,
            node.lineno,
            where,
            lines[node.lineno - 1].strip(),
            ast.unparse(node),
            after,
            1,
            starts[node.lineno - 1] + node.col_offset,
            starts[node.end_lineno - 1] + node.end_col_offset,
            after if isinstance(node, ast.stmt) else f"({after})",
        )
        found.append(mutant)
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
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        return
    # A formatted string gives its parts no positions of their own before Python 3.12.
    if isinstance(node, (ast.JoinedStr, ast.Import, ast.ImportFrom)):
        return
    for original, changed in _of_node(node):
        yield where, original, changed
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "bases"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.keyword) and child.arg == "strict":
                continue  # the lengths are equal wherever the callers are right
            if isinstance(child, ast.AST):
                yield from _changes(child, where)


def _of_node(node: ast.AST) -> Iterator[tuple[ast.expr | ast.stmt, ast.AST]]:
    """The errors that can be put into one node."""
    match node:
        case ast.Compare():
            for i, operator in enumerate(node.ops):
                changed = copy.deepcopy(node)
                changed.ops[i] = COMPARISONS[type(operator)]()
                yield node, changed
        case ast.BoolOp():
            yield (
                node,
                ast.BoolOp(ast.Or() if isinstance(node.op, ast.And) else ast.And(), node.values),
            )
        case ast.BinOp() if type(node.op) in OPERATORS:
            yield node, ast.BinOp(node.left, OPERATORS[type(node.op)](), node.right)
        case ast.AugAssign() if type(node.op) in OPERATORS:
            yield node, ast.AugAssign(node.target, OPERATORS[type(node.op)](), node.value)
        case ast.UnaryOp(op=ast.USub() | ast.Not() | ast.Invert()):
            yield node, node.operand
        case ast.Constant(value=bool()):
            yield node, ast.Constant(not node.value)
        case ast.Constant(value=int() | complex()):
            yield node, ast.Constant(node.value + 1)
        case ast.Constant(value=float()):
            yield node, ast.Constant(2.0 * node.value if node.value > 1.0 else node.value + 1.0)
        case ast.Name(ctx=ast.Load()) if node.id in NAMES:
            yield node, ast.Name(NAMES[node.id])
        case ast.Attribute(ctx=ast.Load()) if node.attr in NAMES:
            yield node, ast.Attribute(node.value, NAMES[node.attr])
        case ast.Raise():
            yield node, ast.Pass()
        case ast.Expr(value=ast.Call()):
            yield node, ast.Pass()
        case ast.Break():
            yield node, ast.Continue()
        case ast.Continue():
            yield node, ast.Break()
        case ast.If() | ast.IfExp() | ast.While() if not _turned_anyway(node.test):
            yield node.test, ast.UnaryOp(ast.Not(), node.test)


def _turned_anyway(condition: ast.expr) -> bool:
    """Whether another error turns the condition round: a `not` lost, == for !=."""
    match condition:
        case ast.Compare(ops=[operator]):
            return isinstance(operator, _TURNED)
        case ast.UnaryOp() | ast.Constant():
            return True
    return False
