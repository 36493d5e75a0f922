#!/usr/bin/env bash
# Use an installed dampbalance as somebody does who has the package alone: in an empty folder, which is the current one.
#     installed.sh FOLDER      the folder of its programs, python and dampbalance
set -euo pipefail
programs="$1"
dampbalance() { "$programs/python" -W error -m dampbalance "$@"; } # a warning is an error

"$programs/python" -W error -c 'import dampbalance
for name in dampbalance.__all__:
    getattr(dampbalance, name)
print(f"imported: {len(dampbalance.__all__)} names of {dampbalance.__file__}")'
"$programs/dampbalance" --version
dampbalance demo
for level in 4 8 12; do
    dampbalance simulate "level$level.csv" --frequency 3.5 --amplitude "$level mm" --noise 0.01
done
dampbalance identify level*.csv --stiffness 2310 --frequency 3.5 --output found
dampbalance release decay.mat --displacement 0.01 --damping 1 --friction 0.5 --noise 0.01
dampbalance identify decay.mat --stiffness 2310 --json decay.json
"$programs/python" -W error -c 'from dampbalance import study
cases = study({"frequency_hz": [3.5, 11.1]}).to_frame()
assert len(cases) == 2, cases'
test -s found/report.html && test -s decay.json
