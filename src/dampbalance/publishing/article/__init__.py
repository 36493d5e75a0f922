"""The replication article: the numbers that only it needs, and how the PDF is made.

The article reads every number from its result file where it prints it: `paper/article/values.typ` says where each
stands, `paper/article/numbers.typ` rounds it.
"""
