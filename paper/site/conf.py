"""Settings of Sphinx for the site; `dampbalance.publishing.site` copies these pages and runs it."""

import sys
from pathlib import Path

import dampbalance

sys.path.insert(0, str(Path(__file__).parent))

project = "dampbalance"
author = copyright = "the dampbalance authors"
version = release = dampbalance.__version__

extensions = [
    "sphinx.ext.autodoc",
    "myst_nb",
    "sphinx_design",
    "sphinx_copybutton",
    "sphinxcontrib.programoutput",
    "extension",
]
exclude_patterns = ["extra", "made", "trees"]
templates_path = ["templates"]
html_extra_path = ["extra"]
html_static_path = ["static"]
html_css_files = ["site.css"]
html_js_files = [("scrolls.js", {"defer": "defer"})]

# Markdown as repositories on the web read it, with formulas; links to copied files are taken as they are.
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 4
myst_url_schemes = {"http": None, "https": None, "mailto": None, "copied": "{{path}}"}
highlight_language = "none"
nb_execution_mode = "off"  # the notebook has been run
nb_merge_streams = True
suppress_warnings = [
    "myst.header",  # a section shown on a page of its own may begin with its third level
    "misc.highlighting_failure",  # code with an ellipsis
]

# Docstrings: their style is that of docstrings.py.
autodoc_default_options = {"members": True}
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_class_signature = "mixed"
autodoc_type_aliases = {name: name for name in ("Array", "ArrayLike", "Codes", "Complexes", "Mask")}
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 80
smartquotes = False  # what stands in quotes is mostly typed
toc_object_entries_show_parents = "hide"
nitpick_ignore_regex = [("py:.*", ".*")]

html_theme = "pydata_sphinx_theme"
html_title = "dampbalance"
html_copy_source = html_show_sourcelink = False
html_show_sphinx = False
html_show_search_summary = False  # it would be fetched, which no browser does from a folder
html_math_renderer = "mathml"
html_theme_options = {
    "show_prev_next": True,
    "show_nav_level": 1,
    "navigation_depth": 2,
    "show_toc_level": 2,
    "header_links_before_dropdown": 6,
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": [],  # code needs the width
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
html_context = {"default_mode": "auto"}
html_sidebars = {"index": [], "**": ["sidebar-nav-bs", "contents"]}
