"""Entry point: arguments, the commands they name, and errors as one line."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module

from .. import __version__

COMMANDS = {
    "identify": "identify F_k, c and K_z from records",
    "simulate": "write a record with known truth",
}
"""Each is a module of this room, loaded when it is called: what it needs takes longer to load than help to show."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code: 0, or 2 for what could not be done, with one line that says why."""
    arguments = sys.argv[1:] if arguments is None else arguments
    parser = argparse.ArgumentParser(
        prog="dampbalance",
        description="Friction and viscous damping of a vibrating system from the balance of energy over one period.",
        epilog="dampbalance COMMAND --help tells more.",
    )
    parser.add_argument("--version", action="version", version=f"dampbalance {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, summary in COMMANDS.items():
        command_parser = commands.add_parser(
            name, help=summary, formatter_class=argparse.RawDescriptionHelpFormatter
        )
        if name in arguments:
            command = import_module(f".{name}", __package__)
            command_parser.description, command_parser.epilog = command.__doc__, command.EPILOG
            for argument, options_of in command.ARGUMENTS.items():
                command_parser.add_argument(argument, **options_of)
            command_parser.set_defaults(run=command.run)
    options = parser.parse_args(arguments)
    try:
        options.run(options)
    except (ValueError, OSError) as error:  # RecordError is a ValueError
        print(f"dampbalance {options.command}: error: {error}", file=sys.stderr)
        return 2
    return 0
