"""The estimates of all sets in one table, and a line on each as text, with the error of a set that failed."""

from pathlib import Path

import pandas as pd

from dampbalance.identification.outputs import ESTIMATES, SUMMARY
from dampbalance.project.files import read_csv, write_csv, write_text

LEFT_OUT = "standard_error|percent$|^(?:note|error|no_answer|residual|misfit)$"
"""Columns of the table that the text does not show."""


def summarise(folder, errors):
    """Write the estimates of all sets as one table, and as text the answer to use of each; return the text.

    folder : with one of its name for each set that is identified.   errors : set → why it could not be identified,
    empty where it was.
    """
    parts = []
    for name, error in errors.items():
        one = pd.DataFrame({"error": [error]}) if error else read_csv(folder / name / ESTIMATES)
        one.insert(0, "set", name)
        parts.append(one)
    every = pd.concat(parts, ignore_index=True)
    every["error"] = every.pop("error") if any(errors.values()) else ""
    first = every.groupby("set", sort=False).head(1)
    said = first.reindex(columns=["set", "error", "no_answer"]).astype(object).fillna("")
    causes = {
        name: error or f"no answer: {no_answer}"
        for name, error, no_answer in said.itertuples(index=False)
        if error or no_answer
    }
    shown = first.loc[:, ~first.columns.str.contains(LEFT_OUT)].dropna(axis=1, how="all")
    table = shown.to_string(index=False, na_rep="–", float_format="{:.5g}".format)
    head = f"{len(first) - len(causes)} of {len(first)} sets of records identified in {folder}"
    lines = [f"{head}; the answer to use of each:", "", table]
    lines += [""] * bool(causes) + [f"{name}: {cause}" for name, cause in causes.items()]
    text = "\n".join([*lines, ""])
    write_csv(folder / ESTIMATES, every)
    write_text(folder / SUMMARY, text)
    return text


if __name__ == "__main__":
    folder = Path(snakemake.output.csv).parent
    print(summarise(folder, dict.fromkeys(snakemake.params.sets, "")))
