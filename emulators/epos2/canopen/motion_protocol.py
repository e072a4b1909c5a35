"""Interface of motion control to the drive's node and to the faults of a bench."""

from collections.abc import Callable
from typing import Protocol, TypeAlias

from emulators.canopen.application import Application
from emulators.canopen.object_store import ObjectStore
from emulators.servo.axis import ServoAxis


class MotionProtocol(Application, Protocol):
    """Motion control as the node uses it."""

    hung: bool
    """True if set-points and controlwords are received and not carried out."""


MotionFactory: TypeAlias = Callable[[ObjectStore, ServoAxis, Callable[[int], None]], MotionProtocol]
