"""From records to features: read off clean ones, estimated from noisy ones."""
