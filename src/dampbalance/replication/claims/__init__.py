"""Claims: a verdict on every number that the paper prints.

`claims_table` judges; `check` compares with the verdicts on record. Only this package reads `paper/published/`.
"""

from .cells import check as check_cells
from .inputs import FREQUENCIES as PRINTED_FREQUENCIES
from .inputs import LEVELS as PRINTED_LEVELS
from .inputs import RouteTables
from .published import Published, read_published
from .table import WORSE, check, claims_markdown, claims_table, read_claims, read_record, summary

__all__ = [
    "PRINTED_FREQUENCIES",
    "PRINTED_LEVELS",
    "WORSE",
    "Published",
    "RouteTables",
    "check",
    "check_cells",
    "claims_markdown",
    "claims_table",
    "read_claims",
    "read_published",
    "read_record",
    "summary",
]
