"""RARS with tires by the magic formula, [R] (3.45)."""
