"""What is started often loads only what it needs: a package that takes long to import is one that is used."""

from __future__ import annotations

import re
import sys
import tomllib
from importlib.metadata import packages_distributions

from folders import ROOT
from processes import run

HEAVY = {"numpy", "scipy", "pandas", "numba", "matplotlib", "pyarrow", "jsonschema"}


def loaded(program: str) -> set[str]:
    """The heavy packages that a process has loaded when it has run this program."""
    listing = f"\nimport sys\nprint(*(set({sorted(HEAVY)}) & sys.modules.keys()), file=sys.stderr)"
    done = run(sys.executable, "-c", program + listing)
    assert done.returncode == 0, done.stderr
    return set(done.stderr.split())


def test_the_command_line_says_what_it_can_do_with_the_standard_library():
    program = (
        "import contextlib, io\n"
        "from dampbalance.commands.main import main\n"
        "for arguments in ([], ['--help'], ['--version']):\n"
        "    with contextlib.suppress(SystemExit), contextlib.redirect_stderr(io.StringIO()):\n"
        "        main(arguments)"
    )
    assert loaded(program) == set()


RECORDS = [f"config/records/example/level{i}.csv" for i in (1, 5)]
IDENTIFY = ["identify", *RECORDS, "--stiffness", "2310"]


def test_an_identification_loads_what_it_uses():
    program = f"from dampbalance.commands.main import main\nmain({IDENTIFY})"
    # pandas reads text, with pyarrow where that is installed
    assert loaded(program) == {"numba", "numpy", "pandas", "pyarrow", "scipy"}


def test_mappings_studies_and_reports_need_no_extra(tmp_path):
    """Each module that only an extra installs is missing: importing it fails."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [one for extra in project["optional-dependencies"].values() for one in extra]
    names = {re.match(r"[\w.-]+", extra)[0].lower().replace("_", "-") for extra in extras}
    missing = [
        module
        for module, distributions in packages_distributions().items()
        if names & {name.lower().replace("_", "-") for name in distributions}
    ]
    assert {"h5py", "nptdms", "pyarrow", "snakemake"} <= set(missing)
    mapping, folder = str(tmp_path / "channels.yaml"), str(tmp_path / "found")
    program = (
        f"import sys\nsys.modules.update(dict.fromkeys({missing}))\n"
        "from dampbalance import study\nfrom dampbalance.commands.main import main\n"
        "assert len(study({'frequency_hz': [3.5, 11.1]}).to_frame()) == 2\n"
        f"assert not main({[*IDENTIFY, '--write-mapping', mapping]})\n"
        f"assert not main({[*IDENTIFY, '--mapping', mapping, '--output', folder]})\n"
    )
    done = run(sys.executable, "-c", program)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "found/report.html").is_file()
