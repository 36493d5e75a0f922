"""A command as a table of its arguments and options, from its parser, for Markdown."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator

from ...project.wording import in_markdown, listed, markdown_table

_EXAMPLE = re.compile(r"(?:^ {2,}\S.*\n?)+", re.MULTILINE)


def command(parser: argparse.ArgumentParser) -> str:
    """What a command does, how it is called, its arguments and options, and what its help ends with."""
    usage = f"{parser.prog} {' '.join(_called(parser))}".rstrip()
    parts = [
        _prose(parser.description or ""),
        f"```\n{usage}\n```\n",
        markdown_table(["argument", "meaning"], _rows(parser)) + "\n",
        _prose(parser.epilog or ""),
    ]
    return "\n".join(part for part in parts if part)


def _actions(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    return [action for action in parser._actions if not isinstance(action, argparse._HelpAction)]


def _called(parser: argparse.ArgumentParser) -> Iterator[str]:
    """What must be given, and a word for the rest."""
    actions = _actions(parser)
    for action in actions:
        if not action.option_strings:
            yield f"{action.metavar or action.dest}{' …' * (action.nargs == '+')}"
    yield from (_written(action) for action in actions if action.option_strings and action.required)
    if any(action.option_strings and not action.required for action in actions):
        yield "[options]"


def _written(action: argparse.Action) -> str:
    """An argument as it is typed."""
    value = str(action.metavar or action.dest.upper())
    name = ", ".join(action.option_strings)
    return f"{name} {value}" if name and action.nargs != 0 else name or value


def _rows(parser: argparse.ArgumentParser) -> Iterator[list[str]]:
    for action in _actions(parser):
        needed = " *needed*" if action.required else ""
        words = in_markdown((action.help or "") % {**vars(action), "prog": parser.prog})
        if action.choices:
            words += f": {listed([f'`{choice}`' for choice in action.choices], 'or')}"
        yield [f"`{_written(action)}`{needed}", words]


def _prose(text: str) -> str:
    """Text of a help as Markdown: what is indented is an example."""
    blocks, at = [], 0
    for example in _EXAMPLE.finditer(text):
        blocks.append(in_markdown(text[at : example.start()]).strip())
        lines = (line.removeprefix("  ") for line in example[0].rstrip().splitlines())
        blocks.append("```\n" + "\n".join(lines) + "\n```")
        at = example.end()
    blocks.append(in_markdown(text[at:]).strip())
    return "\n\n".join(block for block in blocks if block) + "\n"
