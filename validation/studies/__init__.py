"""Studies: what a source has printed, what an independent way gives, what ours gives, and why they differ."""
