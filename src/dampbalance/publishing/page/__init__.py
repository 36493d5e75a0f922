"""The page that shows a case to people who read: one HTML file, and a picture of the match for the README.

report.py     the page, from `PageContent`       match.py    the picture of the match
words.py      symbols and units as HTML          cells.py    the paper's tables as cells with verdicts
charts.py     charts in Vega-Lite, and stills    loops.py, error_levels.py, curves.py    the charts
colours.py    light and dark                     templates/, static/    HTML, style sheet, scripts
origins.py    which rule and code made what
"""
