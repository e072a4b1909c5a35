"""What this package complains of: what is wrong, where, and what to do about it."""


class PlantError(Exception):
    """A plant that cannot be built, loaded or stepped; the message names the file and the remedy."""


class UnknownNameError(PlantError):
    """A plant, or a part of one, that does not go by this name; the message says which ones there are."""


class PlantWarning(UserWarning):
    """A plant that runs, but not as it was meant to; the message names the file and the remedy."""
