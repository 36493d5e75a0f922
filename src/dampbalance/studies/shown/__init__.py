"""What a study shows: figures, maps, summary and facts, from its table of cases.

study_figure.py  the figures along an axis                  maps.py  the error over two axes
statistics.py    errors over many runs: bias, scatter, coverage, and the least error that records allow
facts.py         numbers of the paragraph that says what it shows
summary.py       the table of errors, and the page that shows it
"""
