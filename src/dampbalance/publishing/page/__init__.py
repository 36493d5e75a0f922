"""The page that shows a case to people who read: one HTML file.

content.py       `PageContent`, what it is made from
report.py        the page as HTML                  cells.py     the paper's tables as cells with verdicts
drawings.py      figures, with their values         origins.py   which rule and code made what
instruments.py   what the instruments need to know of the case
templates/, static/   HTML, style sheets, scripts, and the method's kernels as WebAssembly
"""
