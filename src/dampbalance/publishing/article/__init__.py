"""Make the replication article: compute the numbers that only it needs, and compile the PDF.

The article looks every number up by its id where it prints it: `paper/article/values.typ` says in which form,
`paper/article/numbers.typ` rounds it.
"""
