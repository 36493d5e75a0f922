"""The command line: `dampbalance identify` and `dampbalance simulate`."""
