"""Everything that a study shows: figures, maps, summary and paragraph, from its table of cases.

study_figure.py  the figures along an axis                  maps.py  the error over two axes
statistics.py    errors over many runs: bias, scatter, coverage, and the least error that records allow
paragraph.py     the text that says what it shows, from a template that asks for its numbers
summary.py       the table of errors, and the page that shows it
"""
