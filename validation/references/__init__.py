"""Runs of each plant that are kept: inputs over time, and what it answered."""
