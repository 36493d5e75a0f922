"""What the page of a case is made from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from ...project.case import Case
from ...studies.settings import Study


@dataclass(frozen=True)
class PageContent:
    """What the page shows.

    case : as configured.   config : the merged configuration, to be listed.
    claims : `claims.csv` as text, or None for a case with nothing printed.
    tables : frequency → name → frame of `tables.COLUMNS`.   approaches : tables/approaches.csv.
    figures : name → SVG by `figures.style.save`: figure3, estimation_error, and where something is printed glance and
    numerics.
    evidence : `derived_numbers`, which the article argues with.   facts : study → its facts in words, as there.
    studies : (study, its figure as SVG).   digits : `changed_digits.packed`, if it is on record.
    """

    case: Case
    config: Mapping[str, Any]
    claims: pd.DataFrame | None
    tables: Mapping[str, Mapping[str, pd.DataFrame]]
    approaches: pd.DataFrame
    figures: Mapping[str, str]
    evidence: Mapping[str, Any] | None = None
    facts: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    studies: Sequence[tuple[Study, str]] = ()
    digits: Mapping[str, Any] | None = None
