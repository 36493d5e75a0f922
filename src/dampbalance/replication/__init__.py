"""The paper's numbers: the authors' route, the rebuilt tables, and a verdict on each printed number."""
