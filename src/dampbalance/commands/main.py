"""Entry point: arguments, the commands they name, and errors as one line."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import NoReturn

from .. import __version__
from ..project.wording import cut, visible
from . import identify, simulate

_LONGEST = 1000  # characters of a line


class _Parser(argparse.ArgumentParser):
    """A parser whose errors fit a screen, whatever was typed."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and leave."""
        super().error(cut(visible(message), _LONGEST))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code: 0, or 2 for what could not be done, with one line that says why."""
    parser = _Parser(
        prog="dampbalance",
        description="Friction and viscous damping of a vibrating system from the balance of energy over one period.",
        epilog="dampbalance COMMAND --help tells more.",
    )
    parser.add_argument("--version", action="version", version=f"dampbalance {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, command in {"identify": identify, "simulate": simulate}.items():
        command_parser = commands.add_parser(
            name,
            help=command.SUMMARY,
            description=command.__doc__,
            epilog=command.EPILOG,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        for argument, options_of in command.ARGUMENTS.items():
            command_parser.add_argument(argument, **options_of)
        command_parser.set_defaults(run=command.run)
    options = parser.parse_args(arguments)
    try:
        options.run(options)
    except (ValueError, ArithmeticError, OSError) as error:  # RecordError is a ValueError
        shown = "\n".join(cut(visible(line), _LONGEST) for line in str(error).split("\n"))
        print(f"dampbalance {options.command}: error: {shown}", file=sys.stderr)
        return 2
    return 0
