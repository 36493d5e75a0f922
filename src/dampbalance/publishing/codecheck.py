"""What a codechecker compares: the manifest of codecheck.yml, and a report of what came out, written from the verdicts.

CODECHECK has a person run a workflow who did not write it, and certifies what that person found. The report holds what
such a certificate holds, as far as the results themselves tell: the paper, what to run, the outputs with their digests,
how many printed numbers are reproduced and which are not. It certifies nothing.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from ..project.documents import ConfigurationError, against_schema, in_lines, read_schema, read_yaml
from ..project.files import sha256
from ..replication.claim_verdicts import HOLDING, ROUTE_NAMES, VERDICTS, counts
from .words import rendered


def read(file: str | Path, schema: str | Path) -> dict[str, Any]:
    """The configuration of a CODECHECK.

    Raises ConfigurationError, a line for whatever the schema does not allow.
    """
    document = read_yaml(file)
    if problems := against_schema(document, read_schema(schema)):
        raise ConfigurationError(in_lines(problems, {str(file): document}))
    return document


def report(
    configuration: Mapping[str, Any],
    claims: pd.DataFrame,
    version: str,
    path: str | Path,
    top: str | Path = ".",
) -> str:
    """The report as Markdown.

    configuration : from `read`.   claims : the table of claims.   version : of the package.   path : where the report
    is to lie; it links from there.   top : the folder in which the manifest's files lie where it says.
    """
    above = Path(path).parent
    files = {item["file"]: Path(top, item["file"]) for item in configuration["manifest"]}
    manifest = [
        {**item, "link": _link(file, above), "bytes": file.stat().st_size, "digest": sha256(file)}
        for item, file in zip(configuration["manifest"], files.values(), strict=True)
    ]
    tables = [file.with_suffix(".md") for file in files.values() if file.parent.name == "tables"]
    counted = counts(claims)
    return rendered(
        "codecheck.md.j2",
        configuration=configuration,
        version=version,
        folder=_link(above.parent, above),
        manifest=manifest,
        counted=counted,
        total=counted[-1],
        verdicts=list(VERDICTS.values()),
        routes=ROUTE_NAMES,
        rest=claims[~claims["verdict"].isin(HOLDING)].to_dict("records"),
        # each a section of the report: its heading two levels down
        tables=[table.read_text("utf-8").strip().replace("# ", "### ", 1) for table in tables],
    )


def _link(file: Path, above: Path) -> str:
    return Path(os.path.relpath(file, above)).as_posix()
