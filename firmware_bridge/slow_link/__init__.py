"""An operator's link as bad as one likes: delay, jitter, loss, bursts, duplicates, bandwidth, by a seed."""
