"""Kinds of faults of an IMU, one row each."""

from typing import Final

from emulators.bench.faults.kind import FaultKind
from emulators.imu import faults

IMU_ROWS: Final = (
    FaultKind(
        faults.ImuFrozen,
        "The sensor's registers are not updated any more: its bus hangs, and its processor repeats the last"
        " values.",
        "An IMU: sequence and time go on, the six values stay. The bridge has no readings after 10 frames.",
        "the IMU's values",
    ),
    FaultKind(
        faults.ImuAxesSwapped,
        "The sensor is mounted a quarter turn off, or its axes are exchanged in its firmware.",
        "An IMU: x and y are exchanged. Not noticed by the bridge: pitch has the roll's value, and roll the"
        " pitch's.",
        "the IMU's axes",
    ),
    FaultKind(
        faults.ImuSilent,
        "The IMU's cable or its supply is out.",
        "An IMU: sends nothing. The bridge has no readings after the link's `silent_ms`.",
        "the IMU's line",
    ),
)
