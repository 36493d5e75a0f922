"""Studies of an estimator's error over many oscillators, each described by one YAML file and no code.

settings.py       the YAML file as an object: `Study`
checking.py       what can be wrong with the file; `read_study`
usual_figure.py   the figure of a study whose file asks for none
routes.py         what each way to the responses needs, one object per route
parameters.py     what can be varied, in which unit, and how it becomes m, c, k, K_z, F_k, Y, ω
axes.py           from blocks of axes (lists, ranges, samples) to the values of any stretch of cases
sizes.py          columns, number of cases, chunks and bytes, before anything runs
responses.py      features of the exact orbits of many cases at several levels, as arrays
one_by_one.py     features of responses under any law, fixed-step simulations and sampled records, one after the other
experiments.py    features of noisy records, with bootstrap replicates
law_selection.py  records of oscillators with a known law, and the law that is chosen for them
evaluate.py       one chunk: cases → responses → rows → errors, as a table
outputs.py        the chunks as one Parquet file, read a stretch at a time, and a manifest
shown/            figures, tables and paragraphs from the table of cases
"""
