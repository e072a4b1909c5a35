"""The requests and answers of one device alone on a serial line, as its family writes them."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Final, NamedTuple

from firmware_bridge.drivers.driver import Power, Reports, SetPoint
from firmware_bridge.drivers.life_cycle import Task
from firmware_bridge.extensible import extensible
from firmware_bridge.robot import Axis


class Report(NamedTuple):
    """State of the device in one of its answers; in the axis's units, positive as its `direction` has it."""

    power: Power
    position: float
    """Counted on across the wrap of the device's own counter."""
    velocity: float
    current_a: float | None = None
    fault: str = ""
    text: str = ""


@extensible(allow_interpreted_subclasses=True)
class LineDevice(ABC):
    """The requests and the answers of one device, as lines without their ends."""

    reports: ClassVar[frozenset[Reports]]
    question: ClassVar[bytes]
    """The request whose answer has its state: it finds the device, and samples it in each cycle."""
    tasks: ClassVar[Mapping[Task, tuple[bytes, ...]]]
    """Requests of a task, each answered before the next; a task without any is done at once.

    CONFIGURE brings the device to standstill without power, LEAVE and DISABLE take the power off.
    """
    end: ClassVar[bytes] = b"\n"
    """The end of each line, which no request here has."""

    def __init__(self, axis: Axis) -> None:
        self.axis: Final = axis

    @abstractmethod
    def request(self, set_point: SetPoint) -> bytes:
        """Return the request for a set-point."""

    @abstractmethod
    def read(self, request: bytes, line: bytes) -> Report | bool:
        """Return the state in a line that answers a request; True where it has none, False for another line.

        A line that may be the late answer to an earlier request is another one.
        """
