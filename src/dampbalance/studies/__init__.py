"""Studies of an estimator's error over many oscillators, each described by one YAML file and no code.

study_file.py     the YAML file as an object: `Study`, with its axes, its route and its fits
reading_study.py  what can be wrong with the file; `read_study`; the figure of a study whose file asks for none
parameters.py     what can be varied, in which unit, and how it becomes m, c, k, K_z, F_k, Y, ω
cases.py          the values of any stretch of cases, the columns of their table, and its size before anything runs
responses.py      responses computed one after the other: any law, fixed steps, sampled and noisy records
evaluate.py       one chunk: cases → responses → rows → errors, as a table
case_files.py     the chunks as one Parquet file, read a column at a time, and a manifest
study.py          studies from Python, without a file
shown/            figures, tables and paragraphs from the table of cases
"""
