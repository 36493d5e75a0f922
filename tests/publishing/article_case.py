"""Article and page of the paper's case, the article built in a folder of its own by the scripts of the workflow.

The routes are computed in memory, the studies are those of `config/studies`, except the step (three of them only)
and the map (fewer oscillators).
"""

from __future__ import annotations

import contextlib
import json
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

from matplotlib.figure import Figure

from dampbalance import steady_orbit
from dampbalance.figures import ALT, style
from dampbalance.figures.cycle import figure3, friction_velocity_loop
from dampbalance.figures.error_levels import estimation_error
from dampbalance.figures.schematic import schematic
from dampbalance.project.files import EVERY_DIGIT, read_csv, write_csv, write_json, write_rows
from dampbalance.publishing.article import compiling
from dampbalance.publishing.page.report import PageContent, report_page
from dampbalance.replication.numbers import by_key, with_claims
from dampbalance.studies.reading_study import read_study
from dampbalance.studies.shown.paragraph import paragraph
from dampbalance.studies.shown.study_figure import alternative_text, study_figure
from dampbalance.studies.study_file import PAPER_CASE
from folders import PUBLISHED
from legible import faults
from replication.routes import CASE, CONFIG, PAPER, ROOT, computed, exact, judged, numbers
from workflow import jobs

RESULTS, STUDIES = "results/paper", "results/studies"
FOLDERS = {"RESULTS": RESULTS, "ARTICLE": f"{RESULTS}/article", "STUDY_RESULTS": STUDIES}
LINES = (ROOT / "workflow/rules/article.smk").read_text(encoding="utf-8").splitlines()
LISTED = (re.fullmatch(r' +f"\{(\w+)\}/(\S+)": "(\w+)",', line) for line in LINES)
SOURCES = {f"{FOLDERS[of[1]]}/{of[2]}": of[3] for of in LISTED if of}
"""The files that the article reads, and the rule that makes each, as the workflow has them."""
FOLDERS = {"results": RESULTS, "studies": STUDIES}  # as the rule names them
INPUTS = {"results": f"/{RESULTS}", "studies": f"/{STUDIES}", "sources": SOURCES}
OF_ARTICLE = [
    *("frequency", "level", "contact_stiffness", "damping"),
    *("read_out", "step_size", "rigid_contact", "map"),
]
COARSER = {
    "step_size": ("[2.0e-6, 5.0e-6, 1.0e-5, 2.0e-5, 4.0e-5, 8.0e-5]", "[5.0e-6, 4.0e-5, 8.0e-5]"),
    "map": ("count: 262144", "count: 1024"),
}
FIRST = next(iter(CASE.frequencies_hz))
PAGE = f"{RESULTS}/report.html"


@dataclass(frozen=True)
class Project:
    """A folder with what the article is made of, and the article."""

    folder: Path

    @property
    def faults(self) -> dict[str, list[list[str]]]:
        """Return the faults in the legibility of each figure, by its file, as found when it was drawn."""
        files = self.folder.glob("faults/*.json")
        return {file.stem: json.loads(file.read_text(encoding="utf-8")) for file in files}

    @property
    def source(self) -> Path:
        return self.folder / "paper/article/article.typ"

    @property
    def pdf(self) -> Path:
        return self.folder / f"{RESULTS}/article.pdf"

    def printed(self) -> dict[str, dict[str, Any]]:
        """Return every value that the article prints, by key, with the place from which typst read it."""
        values = self.query("<value>", "value")
        return {value["key"]: value for value in values}

    def query(self, selector: str, field: str) -> list[Any]:
        """Return a field of every element of the compiled article that a selector matches.

        The article is compiled like by the rule `article`, so that typst does not lay it out again in this process."""
        with compiling.article_next_to_results(
            self.source.parent, self.folder / "results"
        ) as source:
            return compiling.query(source, source.parents[1], INPUTS, selector, field)

    def copy(self, folder: Path) -> Project:
        """Copy the article and its results to another folder."""
        for name in ("paper/article", "results"):
            shutil.copytree(self.folder / name, folder / name)
        return Project(folder)

    def change(self, name: str, *value: object) -> None:
        """Put another value under the id of a derived number, or none at all."""
        path = self.folder / RESULTS / "derived.csv"
        rows = [row for row in read_csv(path, dtype=str).to_dict("records") if row["id"] != name]
        write_rows(path, [*rows, *({"id": name, "value": of, "unit": ""} for of in value)])

    def run(
        self,
        script: str,
        output: Mapping[str, str],
        inputs: Mapping[str, object],
        /,
        **params: object,
    ) -> None:
        """Run a script of the workflow as its rule would."""
        for file in output.values():
            (self.folder / file).parent.mkdir(parents=True, exist_ok=True)
        with contextlib.chdir(self.folder), mock.patch.object(style, "save", self.save):
            jobs.run(f"article/{script}.py", input=inputs, output=output, params=params)

    def save(self, figure: Figure, svg: str | Path, png: object, alt: str) -> None:
        """Save a figure like `style.save`, without a bitmap, which takes longer to write than all else here."""
        file = self.folder / svg
        name = file.stem if file.stem != "figure" else file.parent.name
        write_json(self.folder / f"faults/{name}.json", faults(figure))
        file.parent.mkdir(parents=True, exist_ok=True)
        style.save_svg(figure, file, alt)

    def typeset(self) -> None:
        """Typeset the article like the rule `article`."""
        params = {"folder": "paper/article", "results": "results", "inputs": INPUTS | FOLDERS}
        self.run("article", {"pdf": f"{RESULTS}/article.pdf"}, {}, **params)


def build(folder: Path) -> None:
    """Build the article, and all that it needs, in an empty folder."""
    project = Project(folder)
    shutil.copytree(ROOT / "paper/article", folder / "paper/article")
    for name in ("config", "src", "workflow", "CITATION.cff"):
        (folder / name).symlink_to(ROOT / name)
    (folder / RESULTS).mkdir(parents=True)
    write_csv(folder / f"{RESULTS}/claims.csv", judged(), EVERY_DIGIT)
    routes = numbers().drop(columns=["printed", "verdict"])
    write_csv(folder / f"{RESULTS}/numbers.csv", routes, EVERY_DIGIT)
    for name in OF_ARTICLE:
        study, table = computed(name, folder / STUDIES, COARSER.get(name, ("", "")))
        figure = study_figure(study, table)
        project.save(figure, table.with_name("figure.svg"), None, alternative_text(study))
    _numbers(project)
    _figures(project)
    project.typeset()


def _numbers(project: Project) -> None:
    """Write derived.csv, and the article's own figures."""
    inputs = {
        "claims": f"{RESULTS}/claims.csv",
        "numbers": f"{RESULTS}/numbers.csv",
        "steps": f"{STUDIES}/step_size/cases.parquet",
        "study_cases": [f"{STUDIES}/{name}/cases.parquet" for name in OF_ARTICLE],
        "study_files": [f"{STUDIES}/{name}.yaml" for name in OF_ARTICLE],
        "rivals": [f"{PUBLISHED}/schemes.csv"],
        "citation": "CITATION.cff",
    }
    output = {
        f"{name}_{kind}": f"{RESULTS}/figures/{name}.{kind}"
        for name in ("numerics", "glance")
        for kind in ("svg", "png")
    }
    output["derived"] = f"{RESULTS}/derived.csv"
    params = {"case": CONFIG, "frequency": FIRST, "papers": [PAPER_CASE] * len(OF_ARTICLE)}
    packages = ["dampbalance", "numpy", "typst"]
    project.run("article_numbers", output, inputs, packages=packages, **params)


def _figures(project: Project) -> None:
    """Draw the paper's figures like their script."""
    orbits = [steady_orbit(PAPER, motion) for motion in CASE.motions(FIRST)]
    errors = exact(PAPER).estimates, PAPER, CASE.frequencies_hz, CASE.levels_m
    others = {
        "figure1": schematic(),
        "figure2": friction_velocity_loop(orbits[0]),
        "figure3": figure3(orbits),
        "estimation_error": estimation_error(*errors),
    }
    for name, figure in others.items():
        project.save(figure, f"{RESULTS}/figures/{name}.svg", None, ALT[name])


def page_content(folder: Path, article: Path) -> PageContent:
    """Everything the page shows, through the files of the pipeline where digits are lost in them.

    folder : for what is made here, a smaller study.   article : that of the article, with all else.
    """

    def text(file: Path) -> str:
        return file.read_text(encoding="utf-8")

    made, steps = article / RESULTS, article / f"{STUDIES}/step_size"
    claims = read_csv(made / "claims.csv", dtype=str)
    frequency, cases = computed("frequency", folder, ("count: 441", "count: 45"))
    drawn = folder / "figure.svg"
    style.save_svg(study_figure(frequency, cases), drawn, alternative_text(frequency))
    derived = dict(read_csv(made / "derived.csv", dtype=str)[["id", "value"]].to_numpy())
    names = ("figure3", "estimation_error", "numerics", "glance")
    return PageContent(
        case=CASE,
        config=CONFIG,
        claims=claims,
        numbers=by_key(with_claims(read_csv(made / "numbers.csv"), claims)),
        figures={name: text(made / f"figures/{name}.svg") for name in names},
        derived={**derived, "study.frequency.paragraph": paragraph(frequency, cases)[0]},
        studies=[
            (frequency, text(drawn)),
            (read_study(steps.with_suffix(".yaml")), text(steps / "figure.svg")),
        ],
    )


def page_of(made: PageContent) -> str:
    """The page, as it would stand among the results."""
    return report_page(made, PAGE)
