"""Claims: a verdict on every number that the paper prints.

`claims_table` judges; `check` compares with the verdicts on record. Only this package reads `paper/published/`.
"""

from ..route_tables import RouteTables
from .published import FREQUENCIES as PRINTED_FREQUENCIES
from .published import LEVELS as PRINTED_LEVELS
from .published import Published, read_published
from .rules import check_printed
from .table import WORSE, check, claims_markdown, claims_table, read_claims, read_record, summary

__all__ = [
    "PRINTED_FREQUENCIES",
    "PRINTED_LEVELS",
    "WORSE",
    "Published",
    "RouteTables",
    "check",
    "check_printed",
    "claims_markdown",
    "claims_table",
    "read_claims",
    "read_published",
    "read_record",
    "summary",
]
