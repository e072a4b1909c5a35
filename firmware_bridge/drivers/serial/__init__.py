"""Drives over maxon's serial protocol: what is asked in which order, what it costs, what it told."""
