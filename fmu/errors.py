"""Errors of this package: each names the fault, its place, and a remedy."""


class PlantError(Exception):
    """A plant that cannot be built, loaded or stepped; the message names the file and the remedy."""


class UnknownNameError(PlantError):
    """A plant, or a part of one, that does not go by this name; the message lists the known ones."""


class PlantWarning(UserWarning):
    """A plant that runs, but not as it was meant to; the message names the file and the remedy."""
