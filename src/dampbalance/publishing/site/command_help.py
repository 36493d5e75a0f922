"""Shows a command as a Markdown table of its arguments and options, taken from its parser."""

from __future__ import annotations

import argparse
import re

from ...project.wording import in_markdown, listed, markdown_table

_EXAMPLE = re.compile(r"((?:^ {2,}\S.*\n?)+)", re.MULTILINE)


def command(parser: argparse.ArgumentParser) -> str:
    """The description of a command, its usage, a table of its arguments and options, and the end of its help."""
    actions = [one for one in parser._actions if not isinstance(one, argparse._HelpAction)]
    given = [f"{_written(one)}{' …' * (one.nargs == '+')}" for one in actions if _place(one) == 0]
    given += [_written(one) for one in actions if _place(one) == 1]
    given += ["[options]"] * any(_place(one) == 2 for one in actions)
    parts = [
        _prose(parser.description or ""),
        f"```\n{' '.join([parser.prog, *given])}\n```\n",
        markdown_table(["argument", "meaning"], (_row(one, parser) for one in actions)) + "\n",
        _prose(parser.epilog or ""),
    ]
    return "\n".join(part for part in parts if part)


def _place(action: argparse.Action) -> int:
    """The position of an argument in the usage: 0 for a positional argument, 1 for a required option, 2 for others."""
    return 0 if not action.option_strings else 1 if action.required else 2


def _written(action: argparse.Action) -> str:
    """An argument as it is typed on the command line."""
    value = str(action.metavar or action.dest.upper())
    name = ", ".join(action.option_strings)
    return f"{name} {value}" if name and action.nargs != 0 else name or value


def _row(action: argparse.Action, parser: argparse.ArgumentParser) -> list[str]:
    needed = " *needed*" if action.required else ""
    words = in_markdown((action.help or "") % {**vars(action), "prog": parser.prog})
    if action.choices:
        words += f": {listed([f'`{choice}`' for choice in action.choices], 'or')}"
    return [f"`{_written(action)}`{needed}", words]


def _prose(text: str) -> str:
    """Help text as Markdown; indented lines are examples."""
    blocks = []
    for number, part in enumerate(_EXAMPLE.split(text)):
        if number % 2:
            lines = (line.removeprefix("  ") for line in part.rstrip().splitlines())
            blocks.append("```\n" + "\n".join(lines) + "\n```")
        else:
            blocks.append(in_markdown(part).strip())
    return "\n\n".join(filter(None, blocks)) + "\n"
