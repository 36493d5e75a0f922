"""The replication article: the numbers that only it needs, and how the PDF is made.

derived_numbers.py   numbers that no other result holds, computed from the tables of results
software.py          what CITATION.cff states of the software
compiling.py         typst, with warnings as errors

The article reads every number from its result file where it prints it: `paper/article/values.typ` says where each
stands, `paper/article/numbers.typ` rounds it.
"""
