"""The pins of a drive, and what works with them: brake, marker, compare; and the data recorder."""
