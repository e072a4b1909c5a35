"""A recording played again, into the drives, the bridge or the whole bench; and what then differs."""

from emulators.replay.order import Into, ReplayOrder
from emulators.replay.play import ReplayResult, replay
from emulators.replay.recordings import RecordingFileError

__all__ = ["Into", "RecordingFileError", "ReplayOrder", "ReplayResult", "replay"]
