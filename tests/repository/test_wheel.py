"""The package as others install it: a wheel, built from the source distribution, works in an empty environment."""

from __future__ import annotations

import re
import sys
import sysconfig
import venv
import zipfile
from functools import partial
from pathlib import Path

import pytest

import dampbalance
from dampbalance.publishing.provenance.manifest import files_of
from folders import ROOT
from processes import output_of

pytestmark = pytest.mark.slow

NAME = f"dampbalance-{dampbalance.__version__}"
PIP = (sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet")


run = partial(output_of, PYTHONPATH=None)  # of this process


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """The source distribution, made by the locked build backend."""
    pytest.importorskip("hatchling", reason="the build backend is not installed: make setup")
    folder = tmp_path_factory.mktemp("sdist")
    run(sys.executable, "-m", "hatchling", "build", "-t", "sdist", "-d", folder, folder=ROOT)
    return folder / f"{NAME}.tar.gz"


@pytest.fixture(scope="module")
def wheel(sources, tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    offline = ("--no-index", "--no-deps", "--no-build-isolation", "--wheel-dir", str(folder))
    run(*PIP, "wheel", *offline, sources, folder=folder)
    (made,) = folder.iterdir()
    return made


SITE = "import sysconfig; print(sysconfig.get_path('purelib'))"


def test_the_wheel_holds_every_file_of_the_package_and_no_other(wheel):
    assert wheel.name == f"{NAME}-py3-none-any.whl"
    with zipfile.ZipFile(wheel) as opened:
        held = set(opened.namelist())
    package = {name.removeprefix("src/") for name in files_of(ROOT, ["src"])}
    assert {name for name in held if ".dist-info/" not in name} == package
    assert "dampbalance/project/schemas/mapping.schema.yaml" in package
    assert f"{NAME}.dist-info/licenses/LICENSE" in held


def test_it_works_in_an_environment_with_the_wheel_alone(wheel, tmp_path):
    """Its dependencies are those installed for this Python; `installed.sh` runs what a user does first."""
    environment, folder = tmp_path / "environment", tmp_path / "empty"
    folder.mkdir()
    venv.create(environment, with_pip=False, symlinks=True)
    python = environment / "bin/python"
    run(*PIP, "--python", python, "install", "--no-index", "--no-deps", wheel, folder=folder)
    site = Path(run(python, "-c", SITE, folder=folder).strip())
    locked = sysconfig.get_path("purelib")
    (site / "locked.pth").write_text(f"import site; site.addsitedir({locked!r})\n")
    said = run("bash", ROOT / "tests/repository/installed.sh", python.parent, folder=folder)
    assert re.search(rf" names of {environment}/\S+/dampbalance/__init__.py$", said, re.MULTILINE)
    assert f"\ndampbalance {dampbalance.__version__}\n" in said
