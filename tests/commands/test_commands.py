"""The command line: what it writes, what it says, and that it never takes away what was there."""

from __future__ import annotations

import hashlib
import json
import re
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from dampbalance import identify
from dampbalance.commands import kernels
from dampbalance.commands.main import COMMANDS, main, parser
from dampbalance.identification.outputs import OUTPUTS, TABLES, outputs_of
from dampbalance.records.readers import read
from folders import ROOT, contents
from paper_case import PAPER
from processes import output_of
from records.drafts import filled

RECORDS = sorted(str(path) for path in (ROOT / "config/records/example").glob("level*.csv"))
STEPPED = str(ROOT / "config/records/stepped/levels.csv")
COMMON = ["--stiffness", "2310"]
QUICK = ["identify", *RECORDS[:2], *COMMON]


def code_of(*arguments):
    """The exit code of a command, whichever part of it ends the program."""
    try:
        return main([*map(str, arguments)])
    except SystemExit as stopped:
        return stopped.code


@pytest.fixture
def answer(capsys):
    """Return what a command says, as an error where it does not succeed; with 1 it gives no answer."""

    def of(*arguments, code=0):
        assert code_of(*arguments) == code
        shown = capsys.readouterr()
        return shown.err if code > 1 else shown.out

    return of


# --- identify -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    """The folder of a demo, and what was shown; a browser that tells what it is asked to open."""
    folder = tmp_path_factory.mktemp("demo") / "a demo"
    command = (sys.executable, "-m", "dampbalance", "demo", folder, "--open")
    return folder, output_of(*command, BROWSER="echo opens %s")


def test_the_demo_makes_the_example_identifies_it_and_shows_the_report(demo):
    folder, shown = demo
    for kept in map(Path, RECORDS):
        # another machine may round the sixth decimal the other way
        one, other = pd.read_csv(folder / kept.name), pd.read_csv(kept)
        pd.testing.assert_frame_equal(one, other, atol=1.01e-6, rtol=0.0)
    assert f"$ dampbalance identify '{folder}'/level*.csv --stiffness 2310" in shown
    assert "\nF_k = 1.28" in shown
    report = folder / "found/report.html"
    assert f"opens {report.as_uri()}\n" in shown
    assert report.read_text(encoding="utf-8").count("data:image/svg+xml") > 2
    assert {path.name for path in report.parent.iterdir()} == {*OUTPUTS}
    for name in ("cycles", "friction", "balance"):
        assert (folder / f"found/{name}.png").read_bytes().startswith(b"\x89PNG")
        assert "<dc:description>" in (folder / f"found/{name}.svg").read_text(encoding="utf-8")


def test_the_document_holds_the_truth_of_the_example(demo):
    found = json.loads((demo[0] / "found/identification.json").read_text(encoding="utf-8"))
    truth = {"F_k": ("N", PAPER.F_k), "c": ("N_s_per_m", PAPER.c), "K_z": ("N_per_m", PAPER.K_z)}
    for numbers in (found["approaches"]["direct"], found["maximum_likelihood"]):
        for symbol, (unit, true) in truth.items():
            if f"{symbol}_{unit}" in numbers:  # the balance has no K_z
                low, high = numbers[f"{symbol}_interval_{unit}"]
                assert low < true < high
                assert low < numbers[f"{symbol}_{unit}"] < high
                assert high - low < 0.03 * true
    verdicts = found["maximum_likelihood"]["verdicts"]
    assert {s: one["verdict"] for s, one in verdicts.items()} == dict.fromkeys(truth, "usable")
    assert [one for one in found["findings"] if one["effect"]] == []
    assert found["records"][0]["frequency_Hz"] == pytest.approx(3.5, abs=1e-4)


def test_the_same_records_give_the_same_bytes(demo, tmp_path):
    options = [*COMMON, "--mass", "2.42", "--frequency", "3.5", "--output", tmp_path]
    assert code_of("identify", *sorted(demo[0].glob("*.csv")), *options) == 0
    assert contents(tmp_path) == contents(demo[0] / "found")


def test_the_table_of_faults_in_the_documentation_is_that_of_the_example():
    text = (ROOT / "config/records/README.md").read_text(encoding="utf-8")
    table = re.search(r"<!-- sensitivities: .*? -->\n(.*?)<!-- end -->", text, re.DOTALL)[1]
    rows = [[cell.strip() for cell in row.split("|")[1:5]] for row in table.splitlines()[2:]]
    told = identify(RECORDS, 2310.0).document()["sensitivities"].values()
    assert [row[0] for row in rows] == [one["fault"] for one in told]
    for row, one in zip(rows, told, strict=True):
        shown = [float(cell.removesuffix(" %").replace("−", "-")) for cell in row[1:]]
        found = [one[f"{symbol}_percent"] for symbol in ("F_k", "c", "K_z")]
        assert shown == pytest.approx(found, abs=0.005 + 1e-9)  # half a unit of the last decimal


def test_the_document_says_from_what_it_was_made_and_may_take_the_place_of_the_table(
    tmp_path, capsys, answer
):
    records = [str(tmp_path / f"run{i}.csv") for i in (0, 1)]
    for made, record in zip(records, RECORDS, strict=False):
        Path(made).write_bytes(Path(record).read_bytes())
    mapping, folder, file = (tmp_path / name for name in ("run1.yaml", "found", "found.json"))
    mapping.write_text("frequency_hz: 6.0\nlevel: 2 of 2\n", encoding="utf-8")
    command = ["identify", *records, *COMMON]
    assert "run1.csv: the excitation oscillates" in answer(*command, code=2)
    written = ["--json", "-", "--output", str(folder), "--no-figures"]
    assert main([*command, "--frequency", "3.5", *written]) == 0
    said = capsys.readouterr()
    assert "Written to" in said.err
    assert (folder / TABLES[0]).read_text(encoding="utf-8") == said.out
    told = json.loads(said.out)
    assert (told["options"]["stiffness_N_per_m"], told["options"]["frequency_hz"]) == (2310.0, 3.5)
    assert (told["options"]["kind"], told["options"]["terms"]) == ("forced", ["F_k", "c"])
    for one, name in zip(told["records"], records, strict=True):
        assert one["record"] == name
        assert one["sha256"] == hashlib.sha256(Path(name).read_bytes()).hexdigest()
    digest = hashlib.sha256(mapping.read_bytes()).hexdigest()
    assert told["records"][1]["mapping"] == {"file": str(mapping), "sha256": digest}
    shown = answer(*command, "--frequency", "3.5", "--json", file, "--no-laws")
    assert "usable within" in shown
    assert f"Written to {file}." in shown
    assert file.read_text(encoding="utf-8") == said.out


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ([*QUICK, "--output", ".", "--no-figures"], "identification.json"),
        ([*QUICK, "--output", ".", "--no-figures"], "cycles.png"),
        ([*QUICK, "--json", "a.json"], "a.json"),
        ([*QUICK, "--report", "report.html"], "report.html"),
        ([*QUICK, "--write-mapping", "a.yaml"], "a.yaml"),
        (["demo", "."], "level1.csv"),
        (["simulate", "a.csv", "--frequency", "5", "--amplitude", "4e-3"], "a.csv"),
    ],
)
def test_nothing_is_replaced_unasked(command, name, tmp_path, monkeypatch, answer):
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_text("mine", encoding="utf-8")
    assert re.search(f"{name} exists already|already contains {name}", answer(*command, code=2))
    assert contents(tmp_path) == {name: b"mine"}


def test_what_is_asked_for_is_replaced_and_old_pictures_go(tmp_path, answer):
    for name in ("cycles.png", "identification.json"):
        (tmp_path / name).write_text("of other records", encoding="utf-8")
    said = answer(*QUICK, "--output", tmp_path, "--no-figures", "--overwrite")
    assert {path.name for path in tmp_path.iterdir()} == {*TABLES}
    assert "cycles" not in said.splitlines()[-1]
    document = json.loads((tmp_path / "identification.json").read_text(encoding="utf-8"))
    assert list(document["approaches"]) == ["direct"]


def test_a_table_of_a_stepped_sine_needs_no_stiffness(tmp_path, answer):
    options = ["--contact", "one slider", "--no-hardening", "--output", tmp_path]
    # many sliders made the table: of one alone all numbers are doubtful
    assert answer("identify", STEPPED, *options, code=1).startswith("No answer: ")
    document = json.loads((tmp_path / "identification.json").read_text(encoding="utf-8"))
    assert list(document["approaches"]) == ["one slider"]
    assert "k_3_N_per_m3" not in document["approaches"]["one slider"]
    assert {path.name for path in tmp_path.iterdir()} == {*outputs_of("stepped-sine")}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([*QUICK, "--stiffness", "0"], "error: --stiffness must be a positive number"),
        ([*QUICK, "--contact-to", "wall"], "invalid choice"),
        ([*QUICK, "--skip-cycles", "some"], "must be a whole number, 0 to"),
        ([*QUICK, "--groups", "F_k"], "must be TERM=LABELS with a label for each record"),
        ([*QUICK, "--terms", "F_k,d"], "unknown term 'd'; known are F_k, c, "),
        ([*QUICK, "--given", "c=1", "--given", "c=1"], "--given: c is named twice: leave out one"),
        ([*QUICK, "--residual"], "residual = True is for "),
        (QUICK[:3], "stiffness (--stiffness) is missing: forced records need it"),
        (["identify", *COMMON], "arguments are required: RECORD"),
        (["identify", "a\n" * 3000, *COMMON], "name too long: 'a\\na\\na"),
        ([*QUICK, "--write-mapping", "a.csv"], "the name of a mapping must end in .yaml"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_line(arguments, message, answer):
    (*_, said) = answer(*arguments, code=2).splitlines()
    assert said.startswith("dampbalance identify: error: ")
    assert message in said
    assert len(said) < 1100


def test_a_record_that_cannot_be_used_is_one_clear_error(tmp_path, answer):
    table, file, output = pd.read_csv(RECORDS[0]), tmp_path / "first.csv", tmp_path / "out"
    table.loc[500, "displacement_m"] = np.inf
    table.to_csv(file, index=False)
    said = answer("identify", file, *RECORDS[1:], *COMMON, "--output", output, code=2)
    assert said.startswith(f"dampbalance identify: error: {file}: line 502: ")
    assert not output.exists()


def test_a_mapping_to_start_from_is_saved_and_used(tmp_path, answer):
    files = [tmp_path / f"level{i}.csv" for i in (1, 2)]
    for path, file in zip(RECORDS[::2], files, strict=False):
        columns = pd.read_csv(path)
        columns.columns = ["Time", *(f"Channel {c}" for c in "ABC"[: columns.shape[1] - 1])]
        columns.to_csv(file, index=False)
    mapping, other = tmp_path / "channels.yaml", tmp_path / "other.csv"
    command = ["identify", *files, *COMMON]
    assert f"in {files[0]}.yaml (--write-mapping writes it), for" in answer(*command, code=2)
    # written only if all records can be read with it
    other.write_text("Zeit/s,x/mm\n" + "".join(f"{i},{i * i}\n" for i in range(9)), "utf-8")
    draft = ["identify", other, *files, "--write-mapping", mapping]
    assert "level1.csv has no channel" in answer(*draft, code=2)
    assert not mapping.exists()
    shown = answer(*command[:3], "--write-mapping", mapping)  # which needs no stiffness
    written = mapping.read_text(encoding="utf-8")
    assert shown.startswith(f"{written}\nWritten to {mapping}. ")
    assert "is not allowed" in answer(*command, code=2)  # its blanks are still there
    columns = {"base_displacement": "Channel A", "displacement": "Channel B"}
    said = filled(yaml.safe_load(written), columns, units={"displacement": "m"})
    mapping.write_text(yaml.safe_dump(said), encoding="utf-8")
    assert "usable within" in answer(*command)
    mapping.write_text("notes: mine\n", encoding="utf-8")  # what a user has said stays
    assert 'notes: "mine"' in answer(*command, "--write-mapping", mapping, "--overwrite")
    elsewhere = tmp_path / "b/of_table.yaml"
    assert f"with --mapping {elsewhere} instead" in answer(
        "identify", STEPPED, "--write-mapping", elsewhere
    )


@pytest.mark.parametrize("friction", ["100", "1e-6"], ids=["sticks", "no friction"])
def test_responses_that_do_not_slip_are_said_to_be_so(friction, tmp_path, capsys, answer):
    records = []
    for i, amplitude in enumerate(("0.002", "0.004", "0.006"), start=1):
        records.append(str(tmp_path / f"run{i}.csv"))
        command = f"simulate {records[-1]} --frequency 4 --amplitude {amplitude} --friction {friction} --seed {i}"
        assert main([*command.split(), "--rate", "1000", "--cycles", "20", "--noise", "0.01"]) == 0
    capsys.readouterr()
    said = answer("identify", *records, *COMMON, "--mass", "2.42", "--details")
    assert "the records are those of a linear oscillator within their noise" in said
    assert "maximum likelihood" not in said  # nor a mass that such records hardly know
    # nothing is known of a friction force that is too large; one that hardly acts has a limit, but no contact
    F_k = "–" if friction == "100" else r"\S+ \[\S+, 0\.00\d+\]"
    found = re.search(rf"^direct \* +{F_k} +\S+ \[(\S+), (\S+)\] +– ", said, re.MULTILINE)
    low, high = map(float, found.groups())
    assert abs(0.5 * (low + high) - 90.0) < high - low  # four standard errors
    assert high - low < 0.05 * 90.0


# --- simulate -------------------------------------------------------------------------------------

OMEGA = 2.0 * np.pi * 4.92  # of the records below, 1/s
SMALL = ["--cycles", "3", "--rate", "1000", "--noise", "0.01", "--seed", "5"]
SLIDER = 1.28 / 208000.0
SAME = [
    ("--sliders", f"{SLIDER!r}:108000,{SLIDER!r}:100000", ""),
    ("--sliders", "1e-4:5000 --friction 1.28", f"--sliders {SLIDER!r}:208000,1e-4:5000"),
    ("--law", "c=90", ""),
    # a loss factor ωc/k is a damper c
    ("--law", f"eta={OMEGA * 90.0 / 2310.0!r}", ""),
    ("--law", f"eta={OMEGA * 40.0 / 2310.0!r} --damping 50", ""),
    ("--law", f"eta={OMEGA * 90.0 / 2310.0!r},F_k=2.5", "--friction 2.5"),
]


def simulated(path, *arguments):
    """The displacement of a record with these arguments."""
    motion = ["--frequency", "4.92", "--amplitude", "0.004"]
    assert code_of("simulate", path, *motion, "--overwrite", *arguments) == 0
    return read(path)["displacement"].values


@pytest.mark.parametrize(("option", "value", "other"), SAME)
def test_sliders_and_laws_are_what_damps_a_simulated_record(tmp_path, option, value, other):
    plain = simulated(tmp_path / "a.csv", *SMALL)
    one = simulated(tmp_path / "a.csv", *SMALL, option, *value.split())
    same = simulated(tmp_path / "a.csv", *SMALL, *other.split())
    np.testing.assert_allclose(one, same, rtol=0, atol=1e-12)
    assert (np.abs(same - plain).max() > 1e-5) == bool(other)


def test_quadratic_damping_takes_what_harmonic_balance_gives_it(tmp_path):
    path = tmp_path / "quadratic.csv"
    X = 0.5 * np.ptp(simulated(path, *SMALL[:4], "--law", "c_2=300", "--friction", "0"))
    stiff = 2310.0 - 2.42 * OMEGA**2
    # the third harmonic is 1/5 of the damper's force against 8k, 1 % of X; sampled 200 times a cycle
    force = np.hypot(stiff * X, 8.0 / (3.0 * np.pi) * 300.0 * (OMEGA * X) ** 2)
    assert force == pytest.approx(2310.0 * 0.004, rel=0.03)


TERMS = "symbols with their coefficients, as in c_2=40,eta=0.02"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("--law c=1 --damping 2", "c is in --law and given by --damping as well"),
        ("--law F_k=1,c_2=3 --friction 2", "F_k is in --law and given by --friction"),
        ("--law c_2[a]=1", "name the term alone"),
        ("--law c_2=1 --frequency 1e-4", "no more than 3,000 can be followed under such a law"),
        ("--law c_2=40,", f"error: --law must be {TERMS}"),
        ("--law c_2=-1", "c_2 must be a number of N s²/m², 0 to 1e+30, got -1"),
        ("--law c_2=1,c_2=3", "c_2 appears twice"),
        ("--cycles 1e-4", "at least 2 are needed"),
        ("--rate 1e12", "memory ran out: ask for less"),
        ("--frequency 1e-8", "no more than 300,000 can be followed; ask for a higher --frequency"),
        (
            "--frequency 0",
            "error: --frequency must be a positive number of Hz, 1e-30 to 1e+30, got 0",
        ),
        ("--seed -1", "must be a whole number, 0 to"),
        ("--decimals 1", "constant when rounded to 1 decimals"),
        ("--sliders 1e-4", "must be pairs r:kappa"),
        ("--sliders 1e-4:-5", "positive"),
        ("--sliders 1e-4:5 --law c_2=1", "leave out one"),
    ],
)
def test_a_simulation_that_makes_no_sense_is_refused(arguments, message, tmp_path, answer):
    command = ["simulate", tmp_path / "a.csv", "--frequency", "4.92", "--amplitude", "0.004"]
    (said,) = answer(*command, *arguments.split(), code=2).splitlines()
    assert message in said
    assert len(said) < 250
    assert [*tmp_path.iterdir()] == []


# --- all ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", COMMANDS)
def test_help_names_no_option_that_the_command_lacks(command, answer):
    assert answer("--version").startswith("dampbalance ")
    (commands,) = (action for action in parser([command])._actions if action.choices)
    options = {o for one in commands.choices[command]._actions for o in one.option_strings}
    assert {*re.findall(r"--[a-z][\w-]*", answer(command, "--help"))} <= options


@pytest.mark.parametrize("part", kernels.PARTS)
def test_each_part_of_the_set_up_runs(part):
    kernels.main([part])
