"""What is wrong with a test, not with what it tests: said in one line."""


class RigError(Exception):
    """A story asks for what this robot, this bench or this machine has not."""
