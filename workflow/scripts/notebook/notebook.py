"""Run the notebook, and show it as a page that needs no network."""

from pathlib import Path

from dampbalance.project.files import write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing import notebook

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    executed = notebook.run(snakemake.input.source)
    style = Path(snakemake.input.style).read_text(encoding="utf-8")
    write_text(snakemake.output.html, notebook.page(executed, style, snakemake.input.template))
    write_text(snakemake.output.ipynb, notebook.write(executed))
