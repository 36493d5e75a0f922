"""Claims: a verdict on every number that the paper prints. Only this package reads `paper/published/`."""
