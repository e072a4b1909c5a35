"""A package for a robot of one's own, written from templates, with gains worked out from its motors' data."""
