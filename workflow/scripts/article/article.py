"""The article: typst to PDF."""

import sys

from dampbalance.project.files import replacing
from dampbalance.publishing.article.compiling import ArticleError, article

if __name__ == "__main__":
    p = snakemake.params
    try:
        folders = {name: f"/{p.inputs[name]}" for name in ("results", "studies")}
        document = article(p.folder, p.results, p.inputs | folders)
    except ArticleError as error:
        sys.exit(str(error))
    with replacing(snakemake.output.pdf) as temporary:
        temporary.write_bytes(document)
