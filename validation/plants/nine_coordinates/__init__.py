"""RARS by nine coordinates, its steered wheels with mass, [R] 3.4.2, 3.4.3."""
