"""Features of records: read off clean ones, estimated from noisy ones."""
