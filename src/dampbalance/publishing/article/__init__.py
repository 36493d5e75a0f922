"""The replication article: which numbers it prints, where each comes from, and how the PDF is made.

evidence.py   numbers that the other results do not hold, computed from them
style.py      a number as it is printed
places.py     reading one number out of a result file
recipe.py     the numbers of the recipe for the paper's Table 3
software.py   what CITATION.cff states of the software
values.py     the list of values that the article prints, its tables in tabulated.py
compiling.py  typst, with warnings as errors
"""
