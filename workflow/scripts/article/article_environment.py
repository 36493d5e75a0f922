"""The packages that made the results, the Python that they need, and what CITATION.cff states of the software.

Not the Python that ran, on which no result depends: the manifest names it.
"""

from importlib.metadata import metadata, version
from pathlib import Path

import yaml

from dampbalance.project.files import write_json
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.article import compiling
from dampbalance.publishing.article.software import software

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    packages = {name: version(name) for name in snakemake.params.packages}
    citation = yaml.safe_load(Path(snakemake.input.citation).read_text(encoding="utf-8"))
    environment = {
        "python": metadata("dampbalance")["Requires-Python"].replace(">=", "≥ "),
        "packages": packages,
        "typesetter": compiling.version(),
        "software": software(citation),
    }
    write_json(snakemake.output.json, environment)
