"""What a study shows: figures, maps, summary and facts, from its table of cases.

error_curves.py  the numbers of its curves, for print and page  study_figure.py, maps.py, scatter.py  the figures
facts.py         numbers of the paragraph that says what it shows  logarithmic.py  logarithmic axes
statistics.py    errors over many runs: bias, scatter, coverage, and the least error that records allow
confusion.py     which law is chosen for the records of each law
summary.py       the table of errors, and the page that shows it
"""
