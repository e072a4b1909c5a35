"""One robot, one file."""
