"""The one table of findings, `sentences.toml`: code → words, remedy, section of the site. One more is a line there."""

from __future__ import annotations

import tomllib
from collections.abc import MutableMapping
from importlib.resources import files
from typing import NamedTuple


class Sentence(NamedTuple):
    """What a finding says.

    words : what it is and how large, a template.   remedy : what helps, a template; empty where nothing does or the
    words say it.   page : the section of the site's page of symptoms that explains it.   spares : names of the answers
    that it does not concern.
    """

    words: str
    remedy: str = ""
    page: str = ""
    spares: tuple[str, ...] = ()


_TABLE = tomllib.loads(files(__package__).joinpath("sentences.toml").read_text(encoding="utf-8"))

MODELS: dict[str, str] = _TABLE.pop("models")
"""Name of a model that is weighed → what it has beyond the plain one."""

SENTENCES: MutableMapping[str, Sentence] = {code: Sentence(**of) for code, of in _TABLE.items()}
"""Code → what the finding says."""
