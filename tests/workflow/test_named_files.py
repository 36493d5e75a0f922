"""Every file that a configuration names is missed at each start when it is gone, and read again when it changes."""

from __future__ import annotations

import os
import re
import time
from contextlib import ExitStack

import pytest
import yaml

from dampbalance.identification.outputs import OUTPUTS, OVERVIEW
from dampbalance.project.files import ROUTES
from folders import restored
from schemas import values

NAMES_A_FILE = {
    "config: measured[].records[]",
    "config: measured[].mapping",
    "config: published",
    "mapping: channels.*.file",
}
NAMES_NONE = {
    "config: measured[].groups.*[]",
    *(f"study: {key}" for key in ("title", "summary_by[]")),
    *(f"study: figure.{key}" for key in ("x", "y", "panels", "at.*")),
    *(
        f"mapping: channels.*.{key}"
        for key in ("channel", "unit", "time", "delay", "delay_uncertainty")
    ),
    *(f"mapping: table.*.{key}" for key in ("channel", "unit", "standard_error")),
    *(f"mapping: {key}" for key in ("time.channel", "time.unit", "level", "notes")),
}


def test_every_text_is_known_to_name_a_file_or_none():
    """A new key of the schemas that takes any text has to be entered above, and tried below if it names a file."""
    found = set()
    for key, node in values({"string"}):
        closed = {"enum", "const", "registered"} & node.keys()
        if not closed and re.search(node.get("pattern", ""), "results/a_file.csv"):
            found.add(re.sub(r"^mapping: (channels|table)\.\w+", r"mapping: \1.*", key))
    assert found == NAMES_A_FILE | NAMES_NONE


CASE = {
    "case": "named",
    "published": None,
    "measured": [
        {
            "name": "set",
            "records": ["data/one.csv"],
            "mapping": "maps/one.yaml",
            "stiffness_N_per_m": 2310.0,
        }
    ],
}
MAPPING = {
    "channels": {
        "base_displacement": {"file": "base.csv", "channel": 1, "unit": "mm"},
        "displacement": {"channel": 1, "unit": "mm"},
    },
    "sample_rate_hz": 100,
}
NAMED = ("data/one.csv", "data/base.csv", "maps/one.yaml")


@pytest.fixture(scope="module")
def named(checkout):
    """A case whose results are all there, newer than what they are made of: there is nothing to do."""
    copy = checkout()
    texts = {"maps/one.yaml": yaml.safe_dump(MAPPING), "named.yaml": yaml.safe_dump(CASE)}
    results = "results/named/measured"
    all_sets = [f"{results}/{name}" for name in OVERVIEW]
    made = [f"{results}/set/{name}" for name in (*OUTPUTS, ".complete")]
    for name in (*NAMED, *texts, *made, *all_sets):
        file = copy.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(texts.get(name, "1\n"), encoding="utf-8")
    assert dry_run(copy)[0] == 0
    return copy


def dry_run(copy, config=None, *arguments):
    """(exit status, what is said) of a dry run under a configuration, which stands in named.yaml."""
    if config is not None:
        (copy.folder / "named.yaml").write_text(yaml.safe_dump(config), encoding="utf-8")
    done = copy.run("--dry-run", "--configfile=named.yaml", *arguments)
    return done.returncode, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"records": ["data/none.csv"]}, "named.yaml: line 6: measured[1].records[1]: no file data/none.csv"),
        ({"records": ["data"]}, "named.yaml: line 6: measured[1].records[1]: data is a folder"),
        ({"mapping": "maps/none.yaml"}, "named.yaml: line 3: measured[1].mapping: no file or folder maps/none.yaml"),
        ({"mapping": "data"}, "named.yaml: line 3: measured[1].mapping: the folder data has no mapping of one.csv"),
    ],
)  # fmt: skip
def test_a_file_that_is_named_and_missing_is_told_though_all_results_are_there(
    named, change, expected
):
    status, said = dry_run(named, CASE | {"measured": [CASE["measured"][0] | change]})
    assert expected in said
    assert (status, "Traceback" in said, "Nothing to be done" in said) == (1, False, False)


@pytest.mark.slow
def test_a_missing_file_of_channels_is_told_with_its_mapping(named):
    base = named.folder / "data/base.csv"
    with restored(base):
        base.unlink()
        status, said = dry_run(named, CASE)
    assert "one.yaml: line 4: channels.base_displacement.file: no file data/base.csv" in said
    assert (status, "Traceback" in said) == (1, False)


@pytest.mark.slow
def test_files_that_are_named_and_change_are_read_again(named):
    soon = time.time() + 60.0
    with ExitStack() as changed:
        for file in (named.folder / name for name in NAMED):
            changed.enter_context(restored(file))
            os.utime(file, (soon, soon))
        status, said = dry_run(named, CASE)
    assert status == 0
    updated = re.search(r"Updated input files: (.+)\n", said)[1]
    assert set(updated.split(", ")) == set(NAMED)


@pytest.mark.slow
def test_the_printed_numbers_are_all_read_and_none_may_be_missing(named):
    of = ("omega1", "omega2", "omega3")
    kinds = [f"{kind}/{route}" for kind in ("features", "estimates") for route in ROUTES]
    tables = [f"{kind}/{hz}.csv" for kind in kinds for hz in of]
    read = [*tables, *(f"features/as_published/unrounded/{hz}.csv" for hz in of)]
    for name in (*read, "numbers.csv", "claims.csv", "claims.md", "summary.txt"):
        (named.folder / "results/paper" / name).parent.mkdir(parents=True, exist_ok=True)
        (named.folder / "results/paper" / name).touch()
    now = time.time()
    for name in ("verdicts", "printed"):
        file = named.folder / f"paper/published/{name}.csv"
        os.utime(file, (now + 60.0, now + 60.0))
        status, said = dry_run(named, {"case": "paper"}, "results/paper/summary.txt")
        assert status == 0
        assert set(re.findall(r"paper/published/\S+\.csv", said)) == {f"paper/published/{name}.csv"}
        os.utime(file, (now - 60.0, now - 60.0))
    (named.folder / "paper/published/printed.csv").unlink()
    for folder, expected in (
        ("paper/printed", "published: paper/printed is not a folder with printed numbers"),
        ("paper/published", "paper/published/printed.csv: the file is missing"),
    ):
        status, said = dry_run(
            named, {"case": "paper", "published": folder}, "results/paper/summary.txt"
        )
        assert expected in said
        assert (status, "Traceback" in said) == (1, False)
