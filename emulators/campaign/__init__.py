"""Campaigns: many runs of missions on all cores, or on a cluster, with the same results on each."""
