"""The values of the article's tables: Tables 1–3 side by side, the least squares, and every claim."""

from __future__ import annotations

from ...balance import TERMS
from ...replication.claim_ids import of_text, part_of, short, statistic
from ...replication.printed import Printed
from .book import Book
from .style import Style

TEXT, VERBATIM = Style("text"), Style("verbatim")

# quantity of a table → (power of ten it is shown in, further digits of the exact value)
FACTORS_OF_TABLE_1 = {**dict.fromkeys(("X", "X_s", "V_s", "t_s"), ("1e3", 2)), "phi": ("1", 1)}
FACTORS_OF_TABLE_2 = {"a": ("1e3", 1), "b": ("1e6", 2), "W": ("1e3", 1)}
FACTORS_OF_TABLE_2_PAIRS = {"F_k": ("1", 1), "c": ("1", 1)}
FACTORS_OF_TABLE_3 = {
    f"{p} by {approach}": ("1", 2) for approach in ("t_s", "X_s", "V_s") for p in TERMS
}
ORDER = ("direct", "X_s", "t_s", "V_s")


def tables(book: Book) -> dict[str, list[str]]:
    """Enter Tables 1–3 and the least squares; return the rows of each, in order."""
    _side_by_side(book, "t1", "tables/table1.csv", FACTORS_OF_TABLE_1)
    _side_by_side(book, "t2", "tables/table2.csv", FACTORS_OF_TABLE_2)
    _side_by_side(book, "t2", "tables/table2.csv", FACTORS_OF_TABLE_2_PAIRS)
    _side_by_side(book, "t3", "tables/table3.csv", FACTORS_OF_TABLE_3)
    _least_squares(book)
    levels = _labels(book, "t1", "tables/table1.csv", "X")
    _labels(book, "t2", "tables/table2.csv", "a")
    _labels(book, "t2", "tables/table2.csv", "F_k")
    pairs = _labels(book, "t3", "tables/table3.csv", "c by X_s")
    return {"levels": levels, "pairs": pairs}


def _labels(book: Book, key: str, file: str, quantity: str) -> list[str]:
    """Enter the names of the rows of a table that have this quantity; return them."""
    labels = [row["row"] for row in book.rows(file) if row["quantity"] == quantity]
    for label in labels:
        place = {"row": label, "quantity": quantity}
        book.cell(f"row.{key}.{label}", file, place, "row", TEXT)
    return labels


def _side_by_side(book: Book, key: str, file: str, quantities: dict[str, tuple[str, int]]) -> None:
    """printed, as published and exact of each quantity of a table: the printed digits, and some more."""
    for row in book.rows(file):
        if row["quantity"] not in quantities:
            continue
        scale, more = quantities[row["quantity"]]
        place = {"row": row["row"], "quantity": row["quantity"]}
        base = f"{key}.{row['row']}.{row['quantity']}"
        digits = Printed(row["printed"]).decimals + {"1": 0, "1e3": -3, "1e6": -6}[scale]
        # Read-outs have the digits of the print, results of a computation more.
        extra = {"printed": 0, "as_published": 0 if key == "t1" else more, "exact": more}
        for route, further in extra.items():
            style = Style("fixed", digits + further, scale)
            book.cell(f"{base}.{route}", file, place, route, style)
        book.cell(f"{base}.verdict", file, place, "verdict", TEXT)


def _least_squares(book: Book) -> None:
    """Least squares of each approach, as the text of the paper gives them."""
    printed = {row["id"]: row["printed"] for row in book.rows("claims.csv")}
    for approach in ORDER:
        for quantity in ("F_k", "c", "residual"):
            claim = {"id": of_text(statistic(quantity, approach, "least_squares"))}
            key = f"ls.{short(approach)}.{quantity}"
            digits = Printed(printed[claim["id"]])
            for route, further in {"printed": 0, "from_print": 1, "exact": 1}.items():
                if quantity == "residual" and approach == "direct" and route == "exact":
                    style = Style("bound")  # nothing but rounding
                elif quantity == "residual":
                    style = Style("power", digits.significant - 1)
                else:
                    style = Style("fixed", digits.decimals + further)
                book.cell(f"{key}.{route}", "claims.csv", claim, route, style)
            book.cell(f"{key}.verdict", "claims.csv", claim, "verdict", TEXT)


def claims(book: Book) -> dict[str, list[str]]:
    """Enter every claim as it stands in claims.csv; return the identifiers by part."""
    parts: dict[str, list[str]] = {}
    for row in book.rows("claims.csv"):
        name = row["id"]
        parts.setdefault(part_of(name), []).append(name)
        for column in ("where", "quantity", "unit", "kind", "verdict", "explanation"):
            book.cell(f"claim.{name}.{column}", "claims.csv", {"id": name}, column, TEXT)
        for column in ("printed", "exact", "as_published", "from_print"):
            style = VERBATIM if Printed(row[column]).is_number else TEXT
            book.cell(f"claim.{name}.{column}", "claims.csv", {"id": name}, column, style)
    return parts
