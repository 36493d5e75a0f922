"""The site of documentation: the project's own texts, docstrings, schemas and commands as pages without a network."""
