"""The provenance of results: the manifest of a run, an RO-Crate that describes it, an archive for long-term storage."""
