"""The command line: what it writes, what it says, and that it never takes away what was there."""

from __future__ import annotations

import hashlib
import json
import re
import sys
from importlib import import_module
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

import numpy as np
import pandas as pd
import pytest
import yaml

from dampbalance import identify, read_records
from dampbalance.commands.identify import ARGUMENTS
from dampbalance.commands.main import COMMANDS, main, parser
from dampbalance.identification.outputs import OUTPUTS, TABLES, outputs_of
from dampbalance.project.options import IN_WORDS, OPTIONS
from dampbalance.project.wording import listed
from dampbalance.records.readers import read
from folders import ROOT
from paper_case import PAPER
from processes import output_of
from records.drafts import filled

EXAMPLE = ROOT / "config/records/example"
RECORDS = sorted(str(path) for path in EXAMPLE.glob("level*.csv"))
SMALL = ["--cycles", "3", "--rate", "1000", "--noise", "0.01", "--seed", "5"]
WHOLE = ["--mass", "2.42", "--frequency", "3.5"]
COMMON = ["--stiffness", "2310"]


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


def simulate(path, *arguments):
    return code_of("simulate", path, "--frequency", "4.92", "--amplitude", "0.004", *arguments)


@pytest.fixture(scope="module")
def output(tmp_path_factory):
    """Where the example was identified, and what was shown."""
    folder = tmp_path_factory.mktemp("identified") / "found"
    command = (sys.executable, "-m", "dampbalance", "identify", *RECORDS, *COMMON, *WHOLE)
    command += ("--details",)
    return folder, output_of(*command, "--output", folder)


def test_everything_is_written(output):
    folder, shown = output
    assert sorted(path.name for path in folder.iterdir()) == sorted(OUTPUTS)
    written = (folder / "summary.txt").read_text(encoding="utf-8")
    assert " ".join(written.split()) in " ".join(shown.split())  # on the screen lines are broken
    assert "\ndirect" in shown
    assert "\nmaximum likelihood" in shown


def truth():
    """Symbol → the ending of its keys, and the number."""
    return {"F_k": ("N", PAPER.F_k), "c": ("N_s_per_m", PAPER.c), "K_z": ("N_per_m", PAPER.K_z)}


def test_the_document_holds_the_truth_of_the_example(output):
    found = json.loads((output[0] / "identification.json").read_text(encoding="utf-8"))
    for numbers in (found["approaches"]["direct"], found["maximum_likelihood"]):
        for symbol, (unit, true) in truth().items():
            if f"{symbol}_{unit}" not in numbers:  # the balance has no K_z
                continue
            low, high = numbers[f"{symbol}_interval_{unit}"]
            assert low < true < high
            assert low < numbers[f"{symbol}_{unit}"] < high
            assert high - low < 0.03 * true
    assert [one for one in found["findings"] if one["effect"]] == []
    assert [record["record"] for record in found["records"]] == RECORDS
    assert found["records"][0]["frequency_Hz"] == pytest.approx(3.5, abs=1e-4)


def test_the_table_of_faults_in_the_documentation_is_that_of_the_example():
    text = (ROOT / "config/records/README.md").read_text(encoding="utf-8")
    table = re.search(r"<!-- sensitivities: .*? -->\n(.*?)<!-- end -->", text, re.DOTALL)[1]
    told = identify(RECORDS, 2310.0).document()
    rows = [[cell.strip() for cell in row.split("|")[1:5]] for row in table.splitlines()[2:]]
    assert [row[0] for row in rows] == [one["fault"] for one in told["sensitivities"].values()]
    for row, one in zip(rows, told["sensitivities"].values(), strict=True):
        shown = [float(cell.removesuffix(" %").replace("−", "-")) for cell in row[1:]]
        found = [one[f"{symbol}_percent"] for symbol in ("F_k", "c", "K_z")]
        assert shown == pytest.approx(found, abs=0.005 + 1e-9)


def test_figures_are_pictures_with_a_description(output):
    for name in ("cycles", "friction", "balance"):
        assert (output[0] / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        text = (output[0] / f"{name}.svg").read_text(encoding="utf-8")
        assert "<dc:description>" in text


@pytest.mark.slow
def test_the_same_records_give_the_same_bytes(output, tmp_path):
    assert main(["identify", *RECORDS, *COMMON, *WHOLE, "--output", str(tmp_path)]) == 0
    for name in OUTPUTS:
        assert (tmp_path / name).read_bytes() == (output[0] / name).read_bytes(), name


QUICK = ["identify", *RECORDS[:2], "--stiffness", "2310"]


def test_the_document_says_from_what_it_was_made(tmp_path):
    for i in (0, 1):
        (tmp_path / f"run{i}.csv").write_bytes(Path(RECORDS[i]).read_bytes())
    (tmp_path / "run1.yaml").write_text("frequency_hz: 3.5\n", encoding="utf-8")
    records = [str(tmp_path / f"run{i}.csv") for i in (0, 1)]
    found = identify(records, 2310.0)
    told = json.loads(json.dumps(found.document()))
    assert told["options"] == {
        "kind": "forced",
        "stiffness_N_per_m": 2310.0,
        "stiffness_standard_error_N_per_m": 0.0,
        "frequency_hz": None,
        "mass_kg": None,
        "mass_standard_error_kg": None,
        "fixture_mass_kg": None,
        "contact_to": "ground",
        "terms": ["F_k", "c"],
        "given": {},
        "groups": {},
        "laws": False,
        "mapping": None,
        "skip_cycles": 0,
    }

    def digest(name):
        return hashlib.sha256((tmp_path / name).read_bytes()).hexdigest()

    digests = [record["sha256"] for record in told["records"]]
    assert digests == [digest("run0.csv"), digest("run1.csv")]
    assert [record["mapping"] for record in told["records"]] == [
        None,
        {"file": str(tmp_path / "run1.yaml"), "sha256": digest("run1.yaml")},
    ]
    verdicts = told["maximum_likelihood"]["verdicts"]
    assert {s: one["verdict"] for s, one in verdicts.items()} == dict.fromkeys(truth(), "usable")


def test_the_document_can_take_the_place_of_the_table(tmp_path, capsys, answer):
    folder, file = tmp_path / "found", tmp_path / "found.json"
    assert main([*QUICK, "--json", "-", "--output", str(folder), "--no-figures"]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out)["k_N_per_m"] == 2310.0
    assert (folder / "identification.json").read_text(encoding="utf-8") == said.out
    assert "Written to" in said.err
    shown = answer(*QUICK, "--json", str(file))
    assert "usable within" in shown
    assert f"Written to {file}." in shown
    assert file.read_text(encoding="utf-8") == said.out
    assert "already contains found.json" in answer(*QUICK, "--json", str(file), code=2)


def test_pictures_can_be_left_out_and_old_ones_go(tmp_path, capsys, answer):
    (tmp_path / "cycles.png").write_bytes(b"of other records")
    arguments = [*QUICK, "--output", str(tmp_path), "--no-figures"]
    assert "already contains cycles.png" in answer(*arguments, code=2)
    assert main([*arguments, "--overwrite"]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(TABLES)
    assert "cycles" not in capsys.readouterr().out.splitlines()[-1]


def test_a_report_is_written_alone_and_not_over_another(tmp_path, answer):
    file = tmp_path / "report.html"
    assert f"Written to {file}." in answer(*QUICK, "--report", str(file))
    assert [*tmp_path.iterdir()] == [file]
    assert "already contains report.html" in answer(*QUICK, "--report", str(file), code=2)


TABLE = str(ROOT / "config/records/stepped/levels.csv")


def test_a_table_of_a_stepped_sine_needs_no_stiffness(tmp_path, answer):
    command = ["identify", TABLE]  # its columns say what it is
    said = answer(
        *command,
        "--contact",
        "one slider",
        "--no-hardening",
        "--details",
        "--output",
        str(tmp_path),
        code=1,  # many sliders made the table: of one alone all numbers are doubtful
    )
    assert "75 lines at 5 levels" in said
    document = json.loads((tmp_path / "identification.json").read_text(encoding="utf-8"))
    assert list(document["approaches"]) == ["one slider"]
    assert "k_3_N_per_m3" not in document["approaches"]["one slider"]
    assert {path.name for path in tmp_path.iterdir()} == {*outputs_of("stepped-sine")}


def test_results_are_not_overwritten_unasked(tmp_path, answer):
    document = tmp_path / "identification.json"
    document.write_text("mine", encoding="utf-8")
    arguments = [*QUICK, "--output", str(tmp_path)]
    assert "already contains identification.json" in answer(*arguments, code=2)
    assert document.read_text(encoding="utf-8") == "mine"
    assert list(tmp_path.iterdir()) == [document]
    assert main([*arguments, "--overwrite"]) == 0
    assert list(json.loads(document.read_text(encoding="utf-8"))["approaches"]) == ["direct"]


def test_the_demo_makes_the_example_identifies_it_and_shows_the_report(
    tmp_path, capsys, monkeypatch, answer
):
    shown = []
    monkeypatch.setattr("webbrowser.open", shown.append)
    folder = tmp_path / "a demo"
    assert main(["demo", str(folder), "--open"]) == 0
    for kept in map(Path, RECORDS):
        made = pd.read_csv(folder / kept.name)
        # another machine may round the sixth decimal the other way
        pd.testing.assert_frame_equal(made, pd.read_csv(kept), atol=1.01e-6, rtol=0.0)
    said = capsys.readouterr().out
    assert f"$ dampbalance identify '{folder}'/level*.csv --stiffness 2310" in said
    assert "\nF_k = 1.28" in said
    (address,) = shown
    report = Path(url2pathname(urlsplit(address).path))
    assert report == folder / "found/report.html"
    assert report.read_text(encoding="utf-8").count("data:image/svg+xml") > 2
    before = report.stat().st_mtime_ns
    assert "already contains level1.csv: choose another folder" in answer(
        "demo", str(folder), code=2
    )
    assert report.stat().st_mtime_ns == before
    assert len(shown) == 1


def test_a_simulated_record_is_not_overwritten_unasked(tmp_path, capsys):
    path = tmp_path / "a.csv"
    path.write_text("mine", encoding="utf-8")
    assert simulate(path) == 2
    assert "exists already" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "mine"


def test_sliders_are_the_contact_of_a_simulated_record(tmp_path):
    Z_m = 1.28 / 208000.0
    made = {}
    for name, arguments in {
        "one": [],
        "two": ["--sliders", f"{Z_m!r}:108000,{Z_m!r}:100000"],
        "more": ["--sliders", f"{Z_m!r}:208000,1e-4:5000"],
        "own": ["--sliders", "1e-4:5000", "--friction", "1.28"],
    }.items():
        path = tmp_path / f"{name}.csv"
        assert simulate(path, *SMALL, *arguments) == 0
        made[name] = read(path)["displacement"].values
    for one, other in (("one", "two"), ("more", "own")):
        np.testing.assert_allclose(made[one], made[other], rtol=0, atol=1e-12)
    assert np.abs(made["more"] - made["one"]).max() > 1e-5


def test_a_law_is_what_damps_a_simulated_record(tmp_path):
    # ω = 2π 4.92/s: a loss factor ωc/k is a damper c; and quadratic damping takes what harmonic balance gives it
    omega = 2.0 * np.pi * 4.92
    made = {}
    for name, arguments in {
        "c": [],
        "law": ["--law", "c=90"],
        "eta": ["--law", f"eta={omega * 90.0 / 2310.0!r}"],
        "both": ["--law", f"eta={omega * 40.0 / 2310.0!r}", "--damping", "50"],
        "F_k": ["--law", f"eta={omega * 90.0 / 2310.0!r},F_k=2.5"],
        "friction": ["--friction", "2.5"],
    }.items():
        path = tmp_path / f"{name}.csv"
        assert simulate(path, *SMALL, *arguments) == 0
        made[name] = read(path)["displacement"].values
    np.testing.assert_array_equal(made["law"], made["c"])
    for one, other in (("eta", "c"), ("both", "c"), ("F_k", "friction")):
        np.testing.assert_allclose(made[one], made[other], rtol=0, atol=1e-10 * 0.004)
    assert np.abs(made["F_k"] - made["c"]).max() > 1e-5
    path = tmp_path / "quadratic.csv"
    assert simulate(path, *SMALL[:4], "--law", "c_2=300", "--friction", "0") == 0
    x = read(path)["displacement"].values
    X = 0.5 * np.ptp(x)
    stiff = 2310.0 - 2.42 * omega**2
    # the third harmonic is 1/5 of the damper's force against 8k, 1 % of X; sampled 200 times a cycle
    assert np.hypot(stiff * X, 8.0 / (3.0 * np.pi) * 300.0 * (omega * X) ** 2) == pytest.approx(
        2310.0 * 0.004, rel=0.03
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--law", "c=1", "--damping", "2"], "c is in --law and given by --damping as well"),
        (["--law", "F_k=1,c_2=3", "--friction", "2"], "F_k is in --law and given by --friction"),
        (["--law", "c_2[a]=1"], "name the term alone"),
        (["--law", "c_2=1", "--frequency", "1e-4"], "no more than 3,000 can be followed"),
        (["--cycles", "1e-4"], "at least 2 are needed"),
        (["--rate", "1e12"], "memory ran out: ask for less"),
        (["--frequency", "1e-8"], "ask for a higher --frequency"),
        (["--decimals", "1"], "constant when rounded to 1 decimals"),
        (["--sliders", "1e-4"], "must be pairs r:kappa"),
        (["--sliders", "1e-4:-5"], "positive"),
        (["--sliders", "1e-4:5", "--law", "c_2=1"], "leave out one"),
    ],
)
def test_a_simulation_that_makes_no_sense_is_refused(arguments, message, tmp_path, capsys):
    assert simulate(tmp_path / "a.csv", *arguments) == 2
    assert message in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


TERMS = "symbols with their coefficients, as in c_2=40,eta=0.02"


@pytest.mark.parametrize(
    ("option", "value", "wanted"),
    [
        ("--frequency", "0", "must be a positive number of Hz, 1e-30 to 1e+30, got 0"),
        ("--amplitude", "-1", "must be a positive number of m"),
        ("--damping", "nan", "must be a number of N s/m, or one with its unit"),
        ("--noise", "-0.1", "must be a number, 0 to 1e+06"),
        ("--seed", "-1", "must be a whole number, 0 to"),
        ("--decimals", "400", "must be a whole number, -15 to 30"),
        ("--law", "c_2", f"must be {TERMS}, got 'c_2'"),
        ("--law", "c_2=40,", f"must be {TERMS}"),
        ("--law", "c_7=1", "unknown term 'c_7'; known are F_k, c, c_r, c_2, c_3, eta"),
        ("--law", "c_2=-1", "c_2 must be a number of N s²/m², 0 to 1e+30, got -1"),
        ("--law", "c_2=1,c_2=3", "c_2 appears twice"),
    ],
)
def test_options_of_a_simulation_have_bounds(option, value, wanted, tmp_path, capsys):
    assert simulate(tmp_path / "a.csv", f"{option}={value}") == 2
    (said,) = capsys.readouterr().err.splitlines()
    assert f"error: {option}" in said
    assert wanted in said
    assert len(said) < 200
    assert list(tmp_path.iterdir()) == []


def spoiled(folder, change):
    """The first record of the example, changed, and the second as it is."""
    folder.mkdir(exist_ok=True)
    first = change(pd.read_csv(RECORDS[0]))
    first.to_csv(folder / "first.csv", index=False)
    return [str(folder / "first.csv"), RECORDS[1]]


def with_value(column, row, value):
    def change(table):
        table.loc[row, column] = value
        return table

    return change


WRONG = {
    "infinite": (with_value("displacement_m", 500, np.inf), "first.csv: line 502: "),
    "no base": (lambda t: t.drop(columns="base_displacement_m"), "base_displacement"),
    "unit": (lambda t: t.assign(displacement_m=1e3 * t["displacement_m"]), "first.csv"),
    "two runs": (lambda t: pd.concat([t, t]), "a second run begins at line"),
    "unequal lengths": (
        lambda t: t.assign(acceleration_m_per_s2=t["acceleration_m_per_s2"].where(t.index < 5000)),
        "first.csv",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_record_that_cannot_be_used_is_one_clear_error(name, tmp_path, capsys):
    change, message = WRONG[name]
    output = tmp_path / "out"
    assert code_of("identify", *spoiled(tmp_path / "in", change), *COMMON, "--output", output) == 2
    said = capsys.readouterr()
    assert said.err.startswith("dampbalance identify: error: ")
    assert said.out == ""
    assert message in said.err
    assert not output.exists()


def test_what_looks_odd_is_reported(tmp_path, answer):
    clipped = spoiled(
        tmp_path, lambda t: t.assign(displacement_m=t.displacement_m.clip(-3e-3, 3e-3))
    )
    said = answer("identify", *clipped, *COMMON, code=1)
    assert said.startswith("No answer: ")
    assert "displacement is clipped" in said.partition("\n")[0]


ONE, TWO = RECORDS[0], [*RECORDS[:2], *COMMON]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([*TWO, "--stiffness", "0"], "must be a positive number"),
        ([*TWO, "--contact-to", "wall"], "invalid choice"),
        ([*TWO, "--skip-cycles", "some"], "must be a whole number, 0 to"),
        ([*TWO, "--groups", "F_k"], "must be TERM=LABELS with a label for each record"),
        (RECORDS[:2], "stiffness (--stiffness) is missing: forced records need it"),
        (COMMON, "arguments are required: RECORD"),
        ([ONE, *TWO], "is named twice"),
        ([ONE, "none.csv", *COMMON], "none.csv: no such file"),
        ([ONE, __file__, *COMMON], "test_commands.py"),
        ([*TWO, "--frequency", "7"], "not at the 7 Hz given"),
        ([*TWO, "--terms", "F_k,d"], "unknown term 'd'; known are F_k, c, "),
        ([*TWO, "--groups", "F_k=A,"], "must be TERM=LABELS with a label for each record"),
        ([*TWO, *["--given", "c=1"] * 2], "--given: c is named twice: leave out one"),
    ],
)
def test_wrong_options_records_and_contradictions_are_refused(arguments, message, answer):
    assert message in answer("identify", *arguments, code=2)


def test_a_mapping_to_start_from_is_saved_and_used(tmp_path, capsys, answer):
    files = [tmp_path / f"level{i}.csv" for i in (1, 2, 3)]
    for path, file in zip(RECORDS[::2], files, strict=True):
        columns = pd.read_csv(path)
        columns.columns = ["Time", *(f"Channel {c}" for c in "ABC"[: columns.shape[1] - 1])]
        columns.to_csv(file, index=False)
    mapping, command = tmp_path / "channels.yaml", ["identify", *files, *COMMON]
    assert f"in {files[0]}.yaml (--write-mapping writes it), for" in answer(*command, code=2)
    # written only if all records can be read with it, and under a name that it will be looked for by
    other = tmp_path / "other.csv"
    other.write_text(
        "Zeit/s,x/mm\n" + "".join(f"{i},{i * i}\n" for i in range(9)), encoding="utf-8"
    )
    for wrong, message in (
        (
            ["identify", other, *command[1:], "--write-mapping", mapping],
            "level1.csv has no channel",
        ),
        ([*command, "--write-mapping", files[0]], "must end in .yaml"),
    ):
        assert message in answer(*wrong, code=2)
    assert sorted(tmp_path.iterdir()) == sorted([*files, other])
    assert code_of(*command, "--write-mapping", mapping) == 0
    shown, written = capsys.readouterr().out, mapping.read_text(encoding="utf-8")
    assert shown.startswith(f"{written}\nWritten to {mapping}. ")
    assert shown.endswith("give the same command without --write-mapping.\n")
    assert "is not allowed" in answer(*command, code=2)
    columns = {"base_displacement": "Channel A", "displacement": "Channel B"}
    said = filled(yaml.safe_load(written), columns, units={"displacement": "m"})
    mapping.write_text(yaml.safe_dump(said), encoding="utf-8")
    assert code_of(*command) == 0
    capsys.readouterr()
    # never what a user has, unless asked to
    mapping.write_text("notes: mine\n", encoding="utf-8")
    assert "add --overwrite" in answer(*command, "--write-mapping", mapping, code=2)
    assert mapping.read_text(encoding="utf-8") == "notes: mine\n"
    assert code_of(*command, "--write-mapping", mapping, "--overwrite") == 0
    assert mapping.read_text(encoding="utf-8") == written.replace("time:", 'notes: "mine"\ntime:')


@pytest.mark.parametrize("command", COMMANDS)
def test_help_names_no_option_that_the_command_lacks(command, capsys):
    with pytest.raises(SystemExit):
        parser([command]).parse_args([command, "--help"])
    arguments = capsys.readouterr().out.partition("\noptions:\n")[2]
    epilog = import_module(f"dampbalance.commands.{command}").__doc__.partition("\n\n")[2]
    arguments = arguments.split("\n\n" + epilog)[0]
    names = re.findall(r"^  ((?:--?[\w-]+, )*--[\w-]+)", arguments, re.MULTILINE)
    options = {one for line in names for one in line.split(", ")} - {"-h"}
    assert "--help" in options
    assert set(re.findall(r"--[a-z][\w-]*", arguments)) == options


def test_help_groups_the_options_by_the_kinds_that_take_them(capsys):
    arguments = parser(["identify"])._subparsers._group_actions[0].choices["identify"]._actions
    assert {action.dest for action in arguments} > OPTIONS.keys()
    group_of = {option: own.get("group", "") for option, own in ARGUMENTS.items()}
    for name, option in OPTIONS.items():
        kinds = [IN_WORDS[kind] for kind in option.kinds]
        wanted = "all records" if len(kinds) == len(IN_WORDS) else listed(kinds, "or")
        assert group_of[f"--{name.replace('_', '-')}"] == wanted, name
    assert code_of("identify", "--help") == 0
    shown = capsys.readouterr().out
    for group in {*group_of.values()} - {""}:
        assert f"\n\n{group}:\n  --" in shown


@pytest.mark.parametrize(
    ("records", "option"),
    [(RECORDS[:2], "--residual"), ([str(ROOT / "config/records/stepped/levels.csv")], "--laws")],
)
def test_an_option_of_another_kind_of_records_is_refused(records, option, answer):
    said = answer("identify", *records, *COMMON, option, code=2)
    assert f"{option[2:]} = True is for " in said
    assert said.endswith(": leave it out\n")


def test_a_mapping_to_start_from_needs_no_stiffness(tmp_path, answer):
    mapping = tmp_path / "channels.yaml"
    assert "base_displacement: {channel" in answer(
        "identify", RECORDS[0], "--write-mapping", mapping
    )
    said = answer("identify", "--write-mapping", mapping, code=2)
    assert "arguments are required: RECORD" in said
    assert "stiffness" not in said.splitlines()[-1]
    (tmp_path / "stepped").mkdir()
    table = tmp_path / "stepped" / "levels.csv"
    table.write_text("frequency [Hz],force [N],x [mm],phase [rad]\n49,1,2,3\n", encoding="utf-8")
    other = tmp_path / "other.yaml"
    assert "  frequency: {channel: frequency" in answer("identify", table, "--write-mapping", other)
    assert other.exists()


def test_the_version_is_told(capsys):
    assert code_of("--version") == 0
    assert capsys.readouterr().out.startswith("dampbalance ")


def test_a_mapping_says_frequency_and_level(tmp_path, answer):
    for i in (0, 1):
        name = f"run{i}.csv"
        (tmp_path / name).write_bytes(Path(RECORDS[i]).read_bytes())
        (tmp_path / f"run{i}.yaml").write_text(
            f"frequency_hz: {3.5 if i else 6.0}\nlevel: {i + 1} of 2\n", encoding="utf-8"
        )
    records = [str(tmp_path / f"run{i}.csv") for i in (0, 1)]
    assert "run0.csv: the excitation oscillates" in answer("identify", *records, *COMMON, code=2)
    assert main(["identify", *records, *COMMON, "--frequency", "3.5"]) == 0
    assert read_records(records[1])[0].label == "2 of 2"


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


def test_a_wrong_mass_is_the_cause_that_comes_first_where_no_number_is_usable_with_it(answer):
    given = ["identify", *RECORDS, *COMMON, "--details"]
    without = answer(*given)
    lead, limits, said = answer(*given, "--mass", "24", code=1).split("\n\n", 2)
    numbers = re.compile(r"\d[\d.]* \[.*?\]")
    # the balance is the answer then, and no longer the fit
    assert {*numbers.findall(said)} == {*numbers.findall(without)} != set()
    assert (said.count("doubtful"), said.count("usable")) == (2, 0)
    title, *broken = limits.splitlines()
    warning = " ".join(broken)
    assert title == "Causes and remedies:"
    assert " ".join(lead.split()) == f"No answer: {warning.removeprefix('warning: ')}."
    assert "the records imply 2" in warning
    assert "you gave 24.00 kg (9.92 times as much)" in warning
