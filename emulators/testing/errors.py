"""Errors of a test, not of the tested program: one line each."""


class RigError(Exception):
    """A test requires something that this robot, this bench or this machine does not have."""
