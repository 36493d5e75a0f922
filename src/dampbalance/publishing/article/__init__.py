"""Make the replication article: compute the numbers that only it needs, and compile the PDF.

The article reads every number from its result file where it prints it: `paper/article/values.typ` says where each
stands, `paper/article/numbers.typ` rounds it.
"""
