"""EPOS2 drives over maxon's serial protocol: requests, their order, and their cost."""
