"""The command line: `dampbalance identify`, `demo`, `simulate` and `release`."""
