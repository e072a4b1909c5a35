"""RARS on four springs, which drives over a step, [R] 2.3."""
