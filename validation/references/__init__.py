"""Kept reference runs of each plant: inputs over time, and its outputs."""
