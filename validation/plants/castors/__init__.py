"""A platform on two driven wheels and two castors with mass, [R] 3.2, 3.3."""
