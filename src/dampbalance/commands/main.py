"""Entry point: arguments, the commands they name, and errors as one line."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Collection, Sequence
from importlib import import_module
from typing import NoReturn

from .. import __version__
from ..project.wording import cut, visible

COMMANDS = {
    "demo": "example records, identified, with a report of the result, in seconds",
    "identify": "identify F_k, c and K_z from records",
    "simulate": "write a record with known truth",
    "release": "write a record of a free decay with known truth",
}
"""Modules of this room, each loaded only when it is called: its imports take longer than showing help. Its docstring is
the help, its first paragraph before the arguments."""

_LONGEST = 1000  # characters of a line
_NO_MEMORY = "memory ran out: ask for less, or give shorter records"


class _Parser(argparse.ArgumentParser):
    """A parser that shows any error as one line that fits a screen."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong, and leave with status 2."""
        message = re.sub(r"^argument (-\S+):(?= must| =| takes)", r"\1", message)
        message = message.removeprefix("argument ")
        self.exit(2, f"{self.prog}: error: {cut(visible(message), _LONGEST)}\n")


def parser(named: Collection[str] = tuple(COMMANDS)) -> argparse.ArgumentParser:
    """Return the parser of the command line; of its commands, only those that are named know their arguments."""
    top = _Parser(
        prog="dampbalance",
        description="Friction and viscous damping of a vibrating system from the balance of energy over one period.",
        epilog="See dampbalance COMMAND --help.",
    )
    top.add_argument("--version", action="version", version=f"dampbalance {__version__}")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, summary in COMMANDS.items():
        command_parser = commands.add_parser(
            name, help=summary, formatter_class=argparse.RawDescriptionHelpFormatter
        )
        if name in named:
            command = import_module(f".{name}", __package__)
            words = command.__doc__ or ""
            command_parser.description, _, command_parser.epilog = words.partition("\n\n")
            groups: dict[str, argparse._ActionsContainer] = {"": command_parser}
            for argument, options_of in command.ARGUMENTS.items():
                own = dict(options_of)
                if (title := own.pop("group", "")) not in groups:
                    groups[title] = command_parser.add_argument_group(title)
                groups[title].add_argument(argument, **own)
            command_parser.set_defaults(run=command.run)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    It is 0 for success, 1 for records that give no answer, and 2, after one line that says why, for an error.
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    options = parser(arguments).parse_args(arguments)
    try:
        answered = options.run(options)
    except (ValueError, ArithmeticError, OSError, MemoryError) as error:
        notes = getattr(error, "__notes__", [])
        text = _NO_MEMORY if isinstance(error, MemoryError) else "\n\n".join([str(error), *notes])
        shown = "\n".join(cut(visible(line), _LONGEST) for line in text.split("\n"))
        print(f"dampbalance {options.command}: error: {shown}", file=sys.stderr)
        return 2
    return 1 if answered is False else 0
