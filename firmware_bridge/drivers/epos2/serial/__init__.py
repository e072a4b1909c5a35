"""EPOS2 drives over maxon's serial protocol: what is asked in which order, at what cost."""
