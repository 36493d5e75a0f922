"""The script of each rule, run by itself on what those before it made of the small case: the bytes on record."""

from __future__ import annotations

import platform

import pytest
from snakemake.common.configfile import load_configfile
from snakemake.utils import update_config

from folders import ROOT
from same_results import digests
from workflow.jobs import case_jobs

RECORD = (ROOT / "tests/workflow/small.sha256").read_text(encoding="utf-8").splitlines()


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The folder of the small case, its page and figures included."""
    folder = tmp_path_factory.mktemp("small")
    config = load_configfile(str(ROOT / "config/config.yaml"))
    update_config(config, load_configfile(str(ROOT / "tests/workflow/small.yaml")))
    case_jobs(config, folder, shown=True)
    return folder


@pytest.mark.skipif(
    (platform.system(), platform.machine()) != ("Linux", "x86_64"),
    reason="digests of tables are on record for Linux on x86_64, as another compiler may round otherwise",
)
@pytest.mark.parametrize("line", RECORD, ids=lambda line: line.split()[1])
def test_a_script_writes_the_bytes_on_record(made, line):
    assert line in digests(made).splitlines()


@pytest.mark.parametrize(
    ("file", "begins"),
    [
        ("figures/figure1.svg", b"<?xml"),
        ("figures/figure3.png", b"\x89PNG"),
        ("figures/estimation_error.svg", b"<?xml"),
        ("report.html", b"<!doctype html>"),
    ],
)
def test_a_script_draws_what_its_rule_promises(made, file, begins):
    assert (made / file).read_bytes()[: len(begins)].lower() == begins.lower()
