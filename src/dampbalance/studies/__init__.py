"""Studies of an estimator's error over many oscillators, each described by one YAML file and no code.

settings.py     the YAML file, checked: `Study`
parameters.py   what can be varied, in which unit, and how it becomes m, c, k, K_z, F_k, Y, ω
axes.py         from blocks of axes (lists, ranges, samples) to the values of any stretch of cases
plan.py         number of cases, chunks, columns and bytes, before anything runs
responses.py    features of the exact orbits of many cases at several levels, as arrays
routes.py       what each way to the responses needs
stepwise.py     the same from fixed-step simulations or sampled records, response by response
noisy.py        and from noisy records, with bootstrap replicates
evaluate.py     one chunk: cases → responses → rows → errors, as a table
outputs.py      the chunks as one Parquet file, and a manifest
stretches.py    the table of cases read a stretch at a time, and sizes of errors counted along the way
summary.py      a table of errors, and the page that shows it
groups.py       the same by the values of some axes: bias, scatter, coverage
bounds.py       and how much of the information in noisy records that uses
facts.py        numbers of the paragraph that says what a study shows
drawing.py      its figure; maps.py, scatter.py and logarithmic.py belong to it
"""
