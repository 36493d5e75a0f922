"""Where results come from: a manifest of a run, an RO-Crate that describes it, an archive that outlives both."""
