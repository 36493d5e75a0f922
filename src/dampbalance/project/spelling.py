"""Options as the reader of a message types them: on the command line, or in Python."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from .options import OPTIONS

_IN_A_SHELL = ContextVar("in_a_shell", default=False)


@contextmanager
def in_a_shell() -> Iterator[None]:
    """Spell options as the command line takes them until the block ends; use it around a command."""
    token = _IN_A_SHELL.set(True)
    try:
        yield
    finally:
        _IN_A_SHELL.reset(token)


def spelled(name: str, value: str = "") -> str:
    """Return an option, and the value to give it, for a message that asks for it: `--stiffness "2310 ± 1 %"` in a
    shell, `stiffness="2310 ± 1 %"` in Python, where `mass=…` stands for a value that the reader knows."""
    if _IN_A_SHELL.get():
        quoted = f'"{value}"' if " " in value else value
        return f"--{name.replace('_', '-')} {quoted}".rstrip()
    form = OPTIONS[name].form if name in OPTIONS else ""
    if form == "flag":
        return f"{name}=True"
    return f"{name}={value or '…'}" if form == "whole" or not value else f'{name}="{value}"'


def everything() -> str:
    """Return what shows everything of a result."""
    return "--details" if _IN_A_SHELL.get() else "the text method"
