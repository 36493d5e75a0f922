"""The licences that installed packages state in their metadata, as SPDX expressions."""

from __future__ import annotations

from importlib import metadata
from importlib.metadata import PackageMetadata

from packaging.licenses import InvalidLicenseExpression, canonicalize_license_expression

# Names that packages use for exactly one licence. "BSD License" is not among them, as there are several.
WORDS = {
    "Apache 2.0": "Apache-2.0",
    "Apache License, Version 2.0": "Apache-2.0",
    "BSD 3-Clause License": "BSD-3-Clause",
    "ISC license": "ISC",
    "ISC License (ISCL)": "ISC",
    "MIT License": "MIT",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
}
UNKNOWN = "unknown"


def licence(package: str) -> str:
    """The licence of an installed package as an SPDX expression, or "unknown" with the words that the package uses.

    Raises PackageNotFoundError for a package that is not installed.
    """
    return stated_licence(metadata.metadata(package))


def stated_licence(stated: PackageMetadata) -> str:
    """The licence that the metadata of a package state: by their expression, their field, or their one classifier."""
    classified = [
        words.rpartition(" :: ")[2]
        for words in stated.get_all("Classifier") or []
        if words.startswith("License ::")
    ]
    field, expression = (
        next(iter(stated.get_all(key) or []), "") for key in ("License", "License-Expression")
    )
    given = [expression, field, *(classified if len(classified) == 1 else [])]
    for words in given:
        try:
            return str(canonicalize_license_expression(WORDS.get(words, words)))
        except InvalidLicenseExpression:
            continue
    said = classified or [line for line in field.splitlines()[:1] if line]
    return f"{UNKNOWN} ({'; '.join(said)})" if said else UNKNOWN
