"""The blind set: records with known parameters from an independent integrator, and how well `identify` recovers
them. README.md says what is in it; `make blind` runs it."""
