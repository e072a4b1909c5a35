"""A recording played again, into the drives, the bridge or the whole bench; and what then differs."""

from emulators.replay.order import Into, Order
from emulators.replay.play import Outcome, replay
from emulators.replay.recordings import RecordingFileError

__all__ = ["Into", "Order", "Outcome", "RecordingFileError", "replay"]
