"""Words by which headings, headers and fields of files are recognised: the table `vocabulary.toml`."""

from __future__ import annotations

import tomllib
from importlib.resources import files

_TABLE = tomllib.loads(files(__package__).joinpath("vocabulary.toml").read_text(encoding="utf-8"))
WORDS: dict[str, dict[str, list[str]]] = {
    group: {meaning: words.split() for meaning, words in meanings.items()}
    for group, meanings in _TABLE.items()
}
"""Group → meaning → words."""
