"""The one error of this package: what failed, where, and what to do about it."""


class PlantError(Exception):
    """A plant that cannot be built, loaded or stepped; the message names the file and the cure."""
