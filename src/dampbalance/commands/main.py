"""Entry point: arguments, the commands they name, and errors as one line."""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Collection, Mapping, Sequence
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from importlib import import_module
from itertools import takewhile
from pathlib import Path
from typing import Any, NoReturn

from .. import __version__
from ..project.wording import cut, did_you_mean, shortened, visible

COMMANDS = {
    "demo": "example records, identified, with a report of the result, in seconds",
    "identify": "identify F_k, c and K_z from records",
    "simulate": "write a record with known truth",
    "release": "write a record of a free decay with known truth",
}
"""Modules of this room, each loaded only when it is called: its imports take longer than showing help. Its docstring is
the help, its first paragraph before the arguments."""

_QUIET: dict[str, Any] = {"action": "store_true", "help": "show nothing but errors"}
_ALL = {"--quiet": {**_QUIET, "default": argparse.SUPPRESS}}
"""Arguments of every command, which may stand before its name, too."""

_LONGEST = 1000  # characters of a line
_NO_MEMORY = "memory ran out: ask for less, or give shorter records"


class _Parser(argparse.ArgumentParser):
    """A parser that shows any error as one line that fits a screen."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong, and leave with status 2."""
        message = re.sub(r"^argument (-\S+):(?= must| =| takes)", r"\1", message)
        message = message.removeprefix("argument ")
        self.exit(2, f"{self.prog}: error: {cut(visible(message), _LONGEST)}\n")


class _Completion(argparse.Action):
    """An option that shows the completion of all commands for a shell, and ends the program."""

    def __call__(self, *called: Any) -> NoReturn:
        """Show it for the shell that is named."""
        import shtab  # slow to import

        print(shtab.complete(parser(paths=shtab.FILE), shell=called[2]))
        sys.exit()


def parser(
    named: Collection[str] = tuple(COMMANDS), paths: Mapping[str, Any] | None = None
) -> argparse.ArgumentParser:
    """Return the parser of the command line; of its commands, only those that are named know their arguments.

    paths : how shells complete a path, for `shtab`.
    """
    top = _Parser(
        prog="dampbalance",
        description="Friction and viscous damping of a vibrating system from the balance of energy over one period.",
        epilog="See dampbalance COMMAND --help.",
    )
    top.add_argument("--version", action="version", version=f"dampbalance {__version__}")
    top.add_argument("--quiet", **_QUIET)
    top.add_argument(
        "--print-completion",
        action=_Completion,
        choices=("bash", "zsh", "tcsh"),
        help='completion for a shell: eval "$(dampbalance --print-completion bash)" in ~/.bashrc',
    )
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
            for argument, options_of in (_ALL | command.ARGUMENTS).items():
                own = dict(options_of)
                if (title := own.pop("group", "")) not in groups:
                    groups[title] = command_parser.add_argument_group(title)
                added = groups[title].add_argument(argument, **own)
                if added.type is Path:
                    added.complete = paths  # type: ignore[attr-defined]
            command_parser.set_defaults(run=command.run, written=[], screen=None)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    It is 0 for success, 1 for records that give no answer, and 2, after one line that says why, for an error.

    Raises KeyboardInterrupt where it is interrupted, with a note of the files that were written before.
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    if wrong := _misspelt(*(one for one in arguments if one not in _ALL)):
        print(f"dampbalance{cut(visible(wrong), _LONGEST)}", file=sys.stderr)
        return 2
    options = parser(arguments).parse_args(arguments)
    options.screen = sys.stdout
    try:
        with ExitStack() as quiet:
            if options.quiet:
                nowhere = quiet.enter_context(open(os.devnull, "w", encoding="utf-8"))
                quiet.enter_context(redirect_stdout(nowhere))
                quiet.enter_context(redirect_stderr(nowhere))
            answered = options.run(options)
    except KeyboardInterrupt as stop:
        if options.written:
            stop.add_note(f"written: {', '.join(map(str, options.written))}")
        raise
    except BrokenPipeError:
        raise  # no error: whoever read the output has stopped
    except (ValueError, ArithmeticError, OSError, MemoryError) as error:
        notes = getattr(error, "__notes__", [])
        text = _NO_MEMORY if isinstance(error, MemoryError) else "\n\n".join([str(error), *notes])
        shown = "\n".join(cut(visible(line), _LONGEST) for line in text.split("\n"))
        print(f"dampbalance {options.command}: error: {shown}", file=sys.stderr)
        return 2
    return 1 if answered is False else 0


def _misspelt(command: str = "", *arguments: str) -> str:
    """Return which command or option does not exist, and which may be meant; "" where all do.

    `argparse` suggests none, and asks for arguments that are missing first.
    """
    if command not in COMMANDS:
        wrong = f": error: no command {shortened(command)}" * (command[:1] not in ("", "-"))
        return wrong and f"{wrong}{did_you_mean(command, COMMANDS)}; known: {', '.join(COMMANDS)}"
    known = ["-h", "--help"]
    for of, form in (_ALL | import_module(f".{command}", __package__).ARGUMENTS).items():
        known += [of] * of.startswith("--")
        known += [f"--no-{of[2:]}"] * (form.get("action") is argparse.BooleanOptionalAction)
    for argument in takewhile(lambda one: one != "--", arguments):
        name = argument.partition("=")[0]
        # with a blank it is a value to `argparse`; the beginning of an option stands for it
        option = re.match("--?[a-z]", name) and " " not in argument
        if option and not any(one.startswith(name) for one in known):
            wrong = f" {command}: error: no option {shortened(name)}"
            return f"{wrong}{did_you_mean(name, known)}; see dampbalance {command} --help"
    return ""
