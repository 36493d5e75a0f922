"""Run the notebook."""

from dampbalance.project.files import write_text
from dampbalance.publishing import notebook

if __name__ == "__main__":
    executed = notebook.run_notebook(snakemake.input.source)
    write_text(snakemake.output.ipynb, notebook.write_notebook(executed))
