"""The site of documentation: the project's own texts, docstrings, schemas and commands as pages that need no network.

texts.py       cuts Markdown into sections and resolves its links to files of the project
pages.py       renders the templates of `paper/site` to pages for Sphinx with the texts and files that they show
keys.py        shows a schema as tables of its keys
names.py       selects the names that the reference of the package documents
docstrings.py  converts docstrings in the style of this project to the markup that Sphinx reads
gallery.py     lists the studies, each with its figure and its result
build.py       builds the site from all of these
"""
