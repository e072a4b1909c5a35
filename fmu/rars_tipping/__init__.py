"""RARS that can tip over: its centre of mass, its wheels' loads, and its rotation about an edge."""
