"""The blind set: records as a laboratory would have them, from an integrator of another make, and what `identify`
makes of them. README.md says what is in it; `make blind` runs it."""
