"""The site of documentation: the project's own texts, docstrings, schemas and commands as pages that need no network.

texts.py        Markdown cut into its sections, with links that say which file of the project they mean
pages.py        templates of `paper/site` → pages for Sphinx, with what each of them shows of the texts
mirror.py       files that pages link to, as they lie in the project
keys.py         a schema as tables of its keys
command_help.py  a command as a table of its options
names.py        which names the reference of the package holds
docstrings.py   docstrings in the style of this project as the markup that Sphinx reads (paper/site/extension.py)
gallery.py      the studies, each with its figure and what it shows
build.py        from all of these to the site
"""
