"""The page that shows a case to people who read: one HTML file, and a picture of the match for the README.

report.py     the page, from `Results`           match.py    the picture of the match
verdicts.py   what the verdicts mean, counted    cells.py    the paper's tables as cells with verdicts
charts.py     charts in Vega-Lite, and stills    loops.py, error_levels.py, curves.py    the charts
colours.py    light and dark                     words.py    symbols, units, numbers
origins.py    which rule and code made what      templates/, static/    HTML, style sheet, scripts
"""
