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
from ..project.wording import in_markdown, markdown_table
from ..replication.verdicts import HOLDING, ROUTE_NAMES, VERDICTS, counts

REPORT = """\
# Report on the rebuild, for a CODECHECK

**{standing}** The workflow wrote this report from its own results.

## The paper

{authors}: *{title}*, <{reference}>.

{source}

## What was run

dampbalance {version}, with `config/config.yaml`. In the folder of the project, with Python 3.11 or newer, make and git,

```
make clean    # removes all results
make          # the environment, then every result, this report among them: minutes
make check    # fails when a printed number is worse off than on record
```

A second `make` does nothing. Python, packages, machine and commit stand in [`manifest.json`]({folder}/manifest.json),
with the job that made each file.

## The outputs

{manifest}

Their digests, as `sha256sum` prints them in the folder of the project:

```
{digests}
```

With the packages of `requirements.lock` the same inputs give the same bytes; another kind of processor may change the
last bits of a number, and a digest with them.

## The verdicts

Each of the {computed} numbers that the paper computes is compared with what is obtained for it.

{counted}

{meanings}

Of {given} inputs that the paper states, the configuration holds {given_held}. Of its {statements} statements
(bounds and words), {statements_held} hold. Every row stands in [`claims.md`]({folder}/claims.md).

## What is neither reproduced nor reconstructed

{rest}

## Figures

{figures}

## Tables

{tables}
"""


def read(file: str | Path, schema: str | Path) -> dict[str, Any]:
    """The configuration of a CODECHECK.

    Raises ConfigurationError, a line for whatever the schema does not allow.
    """
    document: dict[str, Any] = read_yaml(file)
    problems = against_schema(document, read_schema(schema), [])
    if problems:
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
    paper, above = configuration["paper"], Path(path).parent
    manifest = [(item, Path(top, item["file"])) for item in configuration["manifest"]]
    counted = counts(claims)
    total = counted[-1]
    rest = claims[~claims["verdict"].isin(HOLDING)]
    tables = [file.with_suffix(".md") for _, file in manifest if file.parent.name == "tables"]
    figures = [(item["comment"], file) for item, file in manifest if file.suffix == ".svg"]
    return REPORT.format(
        standing=_standing(configuration),
        authors=" and ".join(author["name"] for author in paper["authors"]),
        title=paper["title"],
        reference=paper["reference"],
        source=configuration["source"],
        version=version,
        folder=_link(above.parent, above),
        manifest=markdown_table(
            ["file", "what it reproduces", "bytes"],
            [
                [
                    f"[`{item['file']}`]({_link(file, above)})",
                    in_markdown(item["comment"]),
                    str(file.stat().st_size),
                ]
                for item, file in manifest
            ],
        ),
        digests="\n".join(f"{sha256(file)}  {item['file']}" for item, file in manifest),
        computed=total.computed,
        counted=markdown_table(
            ["part", "computed", *VERDICTS],
            [[c.part, str(c.computed), *map(str, c.of_verdict.values())] for c in counted],
        ),
        meanings="\n".join(
            f"- *{verdict.name}*: {verdict.meaning}" for verdict in VERDICTS.values()
        ),
        given=total.given,
        given_held=total.given_held,
        statements=total.statements,
        statements_held=total.statements_held,
        rest=markdown_table(
            ["where", "quantity", "printed", *ROUTE_NAMES.values(), "verdict", "why"],
            [_row(row) for row in rest.to_dict("records")],
        )
        if len(rest)
        else "Nothing.",
        figures="\n\n".join(
            f"![{title}]({_link(file, above)})\n\n*{title}*" for title, file in figures
        ),
        tables="\n\n".join(_lowered(table.read_text(encoding="utf-8")) for table in tables),
    )


def _standing(configuration: Mapping[str, Any]) -> str:
    if "certificate" in configuration:
        checkers = ", ".join(person["name"] for person in configuration["codechecker"])
        return (
            f"Certificate {configuration['certificate']} by {checkers}: {configuration['report']}."
        )
    return "No codechecker has run this workflow, and there is no certificate."


def _row(row: Mapping[Any, str]) -> list[str]:
    unit = "" if row["unit"] in ("", "1") else f" ({row['unit']})"
    return [
        in_markdown(row["where"]),
        in_markdown(f"{row['quantity']}{unit}"),
        in_markdown(row["printed"]),
        *(row[route] for route in ROUTE_NAMES),
        row["verdict"],
        row["explanation"],
    ]


def _lowered(page: str) -> str:
    """A page of Markdown as a section of another: its heading two levels down."""
    return page.strip().replace("# ", "### ", 1)


def _link(file: Path, above: Path) -> str:
    return Path(os.path.relpath(file, above)).as_posix()
