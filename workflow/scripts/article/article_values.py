"""Every number that the article prints, made into text once, with the file, the place and the rule it comes from."""

from dampbalance.project.files import write_json
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.article.places import ResultFiles
from dampbalance.publishing.article.values import article_values

if __name__ == "__main__":
    brief_troubles()
    p = snakemake.params
    write_json(
        snakemake.output.json,
        article_values(ResultFiles(p.top), p.rules, p.folder, p.frequencies),
    )
