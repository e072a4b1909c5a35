"""Kinds of faults of a capture system, one row each."""

from typing import Final

from emulators.bench.faults.kind import FaultKind
from emulators.motion_capture import faults

CAPTURE_ROWS: Final = (
    FaultKind(
        faults.BodyHidden,
        "A person stands in front of the cameras, or the robot is outside their view.",
        "The capture system sends the last pose again and reports the body as not tracked.",
        "what the cameras see",
    ),
    FaultKind(
        faults.BodyShakes,
        "The rigid body vibrates: steps between rollers, an uneven floor, loose markers. 1 mm is assumed,"
        " to be verified: the thesis names vibration without a number.",
        "A capture system: each frame's pose has that error besides the system's own. The bridge's pose"
        " follows a share of it.",
    ),
    FaultKind(
        faults.MarkersSwapped,
        "A reflection, or another body with similar markers: markers are confused.",
        "The capture system sends a wrong pose, reported as tracked.",
        "what the cameras see",
    ),
    FaultKind(
        faults.CaptureLate,
        "The network between the capture system and the bridge is busy: frames queue up, and come late.",
        "Frames arrive late, with the times of their exposure.",
    ),
    FaultKind(
        faults.CaptureLoss,
        "The network between the capture system and the bridge loses frames.",
        "Frames do not arrive.",
    ),
)
