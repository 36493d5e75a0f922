"""The command line: what it writes, what it says, and that it never takes away what was there."""

from __future__ import annotations

import hashlib
import json
import os
import re
import signal
import subprocess
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
from dampbalance.records.channel import EXCITATIONS
from dampbalance.records.readers import read
from folders import ROOT, contents
from paper_case import PAPER
from processes import output_of, run
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
    found = json.loads((report.parent / "identification.json").read_text(encoding="utf-8"))
    low, high = found["maximum_likelihood"]["c_interval_N_s_per_m"]
    assert low < PAPER.c < high < 1.03 * low
    assert [one for one in found["findings"] if one["effect"]] == []


def test_the_same_records_give_the_same_bytes(demo, tmp_path):
    options = [*COMMON, "--mass", "2.42", "--frequency", "3.5", "--output", tmp_path]
    assert code_of("identify", *sorted(demo[0].glob("*.csv")), *options) == 0
    assert contents(tmp_path) == contents(demo[0] / "found")


def test_the_table_of_faults_in_the_documentation_is_that_of_the_example():
    text = (ROOT / "paper/site/explain/uncertainty.md").read_text(encoding="utf-8")
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
    record, mapping, file = (tmp_path / name for name in ("a.csv", "a.yaml", "found.json"))
    record.write_bytes(Path(RECORDS[1]).read_bytes())
    mapping.write_text("frequency_hz: 6.0\nlevel: 2 of 2\n", encoding="utf-8")
    command = ["identify", RECORDS[0], str(record), *COMMON]
    assert "a.csv: the excitation oscillates" in answer(*command, code=2)
    assert main([*command, "--frequency", "3.5", "--json", "-"]) == 0
    told = json.loads(document := capsys.readouterr().out)
    options = {"stiffness_N_per_m": 2310.0, "frequency_hz": 3.5, "kind": "forced"}
    assert options.items() <= told["options"].items()
    first, second = told["records"]
    assert (first["record"], second["record"]) == (RECORDS[0], str(record))
    assert second["sha256"] == hashlib.sha256(record.read_bytes()).hexdigest()
    digest = hashlib.sha256(mapping.read_bytes()).hexdigest()
    assert second["mapping"] == {"file": str(mapping), "sha256": digest}
    assert "usable within" in answer(*command, "--frequency", "3.5", "--json", file, "--no-laws")
    assert file.read_text(encoding="utf-8") == document


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ([*QUICK, "--output", ".", "--no-figures"], "identification.json"),
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
        (tmp_path / name).touch()
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
        (QUICK[:3], "stiffness (--stiffness) is missing: forced records need it"),
        (["identify", *COMMON], "arguments are required: RECORD"),
        (["identify", "a\n" * 3000, *COMMON], "name too long"),
        ([*QUICK, "--write-mapping", "a.csv"], "the name of a mapping must end in .yaml"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_line(arguments, message, answer):
    (*_, said) = answer(*arguments, code=2).splitlines()
    assert said.startswith("dampbalance identify: error: ")
    assert message in said
    assert len(said) < 1100


def test_a_mapping_to_start_from_is_saved_and_used(tmp_path, answer):
    files = [tmp_path / f"level{i}.csv" for i in (1, 2)]
    for path, file in zip(RECORDS[::2], files, strict=False):
        columns = pd.read_csv(path)
        columns.columns = ["Time", *(f"Channel {c}" for c in "ABC"[: columns.shape[1] - 1])]
        columns.to_csv(file, index=False)
    mapping, other = tmp_path / "channels.yaml", tmp_path / "other.csv"
    other.write_text("Zeit/s,x/mm\n" + "".join(f"{i},{i * i}\n" for i in range(9)), "utf-8")
    command = ["identify", *files, *COMMON]
    assert f"in {files[0]}.yaml (--write-mapping writes it), for" in answer(*command, code=2)
    draft = [*command[:3], "--write-mapping", mapping]  # which needs no stiffness
    # written only if all records can be read with it
    assert "level1.csv has no channel" in answer(draft[0], other, *draft[1:], code=2)
    assert not mapping.exists()
    shown, written = answer(*draft), mapping.read_text(encoding="utf-8")
    assert shown.startswith(f"{written}\nWritten to {mapping}. ")
    assert "blanks" in answer(*command, code=2)  # its blanks are still there
    columns = {"base_displacement": "Channel A", "displacement": "Channel B"}
    said = filled(yaml.safe_load(written), columns, units={"displacement": "m"})
    mapping.write_text(yaml.safe_dump(said), encoding="utf-8")
    assert "usable within" in answer(*command)
    mapping.write_text("notes: mine\n", encoding="utf-8")  # what a user has said stays
    assert 'notes: "mine"' in answer(*command, "--write-mapping", mapping, "--overwrite")


# --- simulate -------------------------------------------------------------------------------------

OMEGA = 2.0 * np.pi * 4.92  # of the records below, 1/s
SMALL = ["--cycles", "3", "--rate", "1000", "--noise", "0.01", "--seed", "5"]
SLIDER = 1.28 / 208000.0
SAME = [
    ("--sliders", f"{SLIDER!r}:108000,{SLIDER!r}:100000", ""),
    ("--sliders", "1e-4:5000 --friction 1.28", f"--sliders {SLIDER!r}:208000,1e-4:5000"),
    # a loss factor ωc/k is a damper c
    ("--law", f"eta={OMEGA * 90.0 / 2310.0!r}", ""),
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


@pytest.mark.parametrize(
    ("channels", "amplitude", "most"),
    [
        ("force acceleration", "2.5", 2.5),
        ("torque angle", "30 N mm", 0.03),
        ("base_acceleration velocity", "0.003", 0.003 * OMEGA**2),
    ],
)
def test_the_amplitude_is_that_of_what_drives(channels, amplitude, most, tmp_path):
    named = [word for one in channels.split() for word in ("--channel", one)]
    motion = ["--frequency", "4.92", "--amplitude", amplitude, "--cycles", "3"]
    assert code_of("simulate", tmp_path / "a.csv", *motion, *named) == 0
    record = read(tmp_path / "a.csv")
    (drive,) = (record[of].values for of in record if of in EXCITATIONS)
    assert np.abs(drive).max() == pytest.approx(most, rel=1e-12)  # the first sample is a peak


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("--amplitude 2N", "'N' is no unit for m; for that of a force"),
        ("--channel force --channel velocity --law c_r=3", "rests under a force: give c"),
        ("--channel force --channel base_angle", "only one of force and base_angle can drive"),
        ("--law c=1 --damping 2", "c is in --law and given by --damping as well"),
        ("--law c_2[a]=1", "name the term alone"),
        ("--law c_2=1 --frequency 1e-4", "no more than 3,000 can be followed under such a law"),
        ("--law c_2=40,", "error: --law must be symbols with their coefficients, as in c_2=40"),
        ("--law c_2=-1", "c_2 must be a number of N s²/m², 0 to 1e+30, got -1"),
        ("--cycles 1e-4", "at least 2 are needed"),
        ("--rate 1e12", "memory ran out: ask for less"),
        ("--frequency 1e-8", "no more than 300,000 can be followed; ask for a higher --frequency"),
        ("--frequency 0", "--frequency must be a positive number of Hz, 1e-30 to 1e+30, got 0"),
        ("--decimals 1", "constant when rounded to 1 decimals"),
        ("--sliders 1e-4", "must be pairs r:kappa"),
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
    (commands,) = (action for action in parser([command])._actions if action.dest == "command")
    options = {o for one in commands.choices[command]._actions for o in one.option_strings}
    assert {*re.findall(r"--[a-z][\w-]*", answer(command, "--help"))} <= options


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        ("identfy", "identify"),
        ("identify a.csv --stifness=400", "--stiffness"),
        ("identify a.csv --no-lws", "--no-laws"),
        ("identify a.csv -mass 3", "--mass"),
        ("simulate a.csv --frequency 3 --ampltude 1", "--amplitude"),  # which is missing, too
        ("release a.csv --quite", "--quiet"),
    ],
)
def test_what_is_misspelt_is_recognised(arguments, meant, answer):
    (said,) = answer(*arguments.split(), code=2).splitlines()
    assert f"did you mean {meant}?" in said


def test_a_quiet_command_says_nothing_but_errors_and_the_document_asked_for(tmp_path, capsys):
    record, found, speeds = tmp_path / "a.csv", tmp_path / "found", tmp_path / "speeds.csv"
    release = ("release", record, "--displacement", "0.02", "--damp", "3", "--quiet")  # abbreviated
    assert code_of(*release) == 0
    v = [*np.linspace(-2.0, -0.2, 10), *np.linspace(0.2, 2.0, 10)]
    rows = (f"{at:.3f},{1.5 * np.sign(at) + 0.5 * at + 0.01 * at**2:.6f}" for at in v)
    speeds.write_text("\n".join(["velocity (m/s),force (N)", *rows]), encoding="utf-8")
    identified = ["identify", speeds, "--quiet"]
    assert code_of(*identified, "--output", found, "--no-figures") == 0
    assert capsys.readouterr() == ("", "")
    assert code_of(*identified, "--json", "-") == 0
    document = (found / "identification.json").read_text(encoding="utf-8")
    assert capsys.readouterr() == (document, "")
    assert code_of(*release) == 2
    assert capsys.readouterr().err.count("\n") == 1


INTERRUPTED = """
import sys
class Stop:
    def find_spec(self, name, *_):
        if name == {module!r}:
            raise KeyboardInterrupt
sys.meta_path.insert(0, Stop())
sys.argv[1:] = {arguments}
from dampbalance.__main__ import main
sys.exit(main())
"""


@pytest.mark.parametrize("module", ["argparse", "numpy", "dampbalance.measured"])
def test_an_interruption_of_imports_ends_in_a_line(module, tmp_path):
    program = INTERRUPTED.format(module=module, arguments=[*QUICK, "--output", str(tmp_path / "a")])
    done = run(sys.executable, "-c", program)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (130, "", 1)
    assert [*tmp_path.iterdir()] == []


def test_an_interrupted_command_names_what_it_has_written(tmp_path):
    command = [sys.executable, "-u", "-m", "dampbalance", "demo", tmp_path]
    pipes = dict.fromkeys(("stdout", "stderr"), subprocess.PIPE)
    # a program in the background of a shell ignores Ctrl-C, and so do those that it starts
    with subprocess.Popen(
        command, text=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), **pipes
    ) as demo:
        first = demo.stdout.readline()
        demo.send_signal(signal.SIGINT)
        _, said = demo.communicate()
    # by the signal itself where it fell into a text that Python executes, as of a named tuple
    assert demo.returncode in (130, -signal.SIGINT)
    assert said.count("\n") == 1
    assert first.removeprefix("Written: ").strip() in said
    left = {one.name for one in tmp_path.iterdir()} ^ {*re.findall(r"level\d\.csv", said)}
    assert len(left) <= 1  # one may have been finished at that moment


COMPLETED = """
eval "$("$0" -m dampbalance --print-completion bash)"
COMP_WORDS=(dampbalance "$@"); COMP_CWORD=$#; _shtab_dampbalance; echo "${COMPREPLY[@]}"
"""


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        (["ide"], "identify"),
        (["identify", "--st"], "--stiffness"),
        (["identify", "run"], "run1.csv run2.csv"),
        (["simulate", "run1.csv", "--channel", "base_d"], "base_displacement"),
    ],
)
def test_a_shell_completes_commands_options_values_and_files(typed, completed, tmp_path):
    for name in ("run1.csv", "run2.csv"):
        (tmp_path / name).touch()
    command = ("bash", "-c", COMPLETED, sys.executable, *typed)
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert sorted(done.stdout.split()) == completed.split()


@pytest.mark.parametrize("part", kernels.PARTS)
def test_each_part_of_the_set_up_runs(part):
    kernels.main([part])


def test_a_reader_of_the_output_that_stops_ends_a_command_without_a_word():
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "dampbalance", "--print-completion", "bash"]
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True)
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, "")
