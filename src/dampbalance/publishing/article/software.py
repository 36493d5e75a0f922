"""What CITATION.cff states of the software: its authors, version and licence, and where it can be had.

The commit is printed only where CITATION.cff states it, as that of a release does. The commit of a build is in the
manifest, which nothing else depends on: printed in the article it would change the PDF with every commit, though no
number had changed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

ADDRESSES = {
    "repository-code": "repository",
    "repository": "repository",
    "url": "page",
    "repository-artifact": "archive",
    "doi": "doi",
    "commit": "commit",
}
"""Key of CITATION.cff → what it is called here."""


def software(citation: Mapping[str, Any]) -> dict[str, Any]:
    """{version, licence, authors, addresses} as a citation file (CFF 1.2) states them.

    authors : names in the order of the file.   addresses : repository, page, archive, doi and commit, those stated.
    Raises KeyError for a file without version, license or authors.
    """
    stated = {ADDRESSES[key]: str(citation[key]) for key in ADDRESSES if citation.get(key)}
    return {
        "version": str(citation["version"]),
        "licence": str(citation["license"]),
        "authors": [name(author) for author in citation["authors"]],
        "addresses": stated,
    }


def name(author: Mapping[str, Any]) -> str:
    """An author of a citation file, a person or a group, as it is printed."""
    parts = ("given-names", "name-particle", "family-names", "name-suffix")
    return str(author.get("name") or " ".join(str(author[key]) for key in parts if author.get(key)))
