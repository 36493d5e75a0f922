"""The provenance of results: the manifest of a run."""
