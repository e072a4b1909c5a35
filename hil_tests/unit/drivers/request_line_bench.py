"""A made-up device alone on a line: its driver on one side, its answers by hand on the other."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated, ClassVar, Final

from pydantic import Field

from firmware_bridge.drivers.driver import Feedback, Position, Power, Reports, SetPoint, Stop
from firmware_bridge.drivers.life_cycle import AT_REST, DriverState, Task, Transition
from firmware_bridge.drivers.line_device import LineDevice, Report
from firmware_bridge.drivers.request_line import LineAxis, RequestLine, line_drivers
from firmware_bridge.packet import Packet
from firmware_bridge.robot.table import LineTable
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND

MS: Final = MILLISECOND
ANSWERS: Final = 60 * MS
AXIS: Final = find("diff_drive").axes[0]


class Word(StrEnum):
    MADE_UP = "made-up"


class Table(LineTable):
    driver: Annotated[Word, Field(strict=False)]

    @property
    def rate(self) -> int:
        return 9_600


class Device(LineDevice):
    """Each answer is the request and a state; `a` to the request for identity has none."""

    reports: ClassVar[frozenset[Reports]] = frozenset({Reports.POWER})
    question: ClassVar[bytes] = b"q"
    tasks: ClassVar[Mapping[Task, tuple[bytes, ...]]] = {
        Task.IDENTIFY: (b"i",),
        Task.CONFIGURE: (b"off", b"c"),
        Task.START: (b"go",),
        Task.ENABLE: (b"on",),
        Task.LEAVE: (b"off",),
        Task.DISABLE: (b"off",),
    }

    def request(self, set_point: SetPoint) -> bytes:
        if isinstance(set_point, Stop):
            return set_point.name.encode()
        return b"to %d" % set_point.value if isinstance(set_point, Position) else b"?"

    def read(self, request: bytes, line: bytes) -> Report | bool:
        assert request, "a line that answers nothing"
        own, _, state = line.partition(b"=")
        if own != request:
            return False
        # `on`, or `on,0.25,hot`: power, current in amperes, fault.
        power, *more = state.decode().split(",")
        current, fault = (float(more[0]), more[1]) if more else (None, "")
        return Report(Power(power), 1.0, 0.5, current, fault, f"shows {power}") if state else True


class Line:
    """The drivers of such a link, and its wire."""

    def __init__(self, found_within_ms: int = 500, silent_ms: int = 250) -> None:
        table = Table(driver=Word.MADE_UP, silent_ms=silent_ms, found_within_ms=found_within_ms)
        self.drivers = line_drivers("line", table, Device(AXIS))
        (driver,), link = self.drivers.drivers, self.drivers.link
        assert isinstance(driver, LineAxis)
        assert isinstance(link, RequestLine)
        self.driver, self.link = driver, link
        self.now = 0
        self.state = "off"
        self.sent: list[bytes] = []

    def takes(self, packets: tuple[Packet, ...]) -> None:
        assert len(packets) <= 1, "one request at a time"
        self.sent += [packet.payload for packet in packets]

    def receives(self, line: bytes) -> None:
        self.takes(self.link.receive(Packet("line", 0, line + b"\n"), self.now))

    def wakes(self) -> None:
        self.now = max(self.now, self.link.wake_at)
        self.takes(self.link.wake(self.now))

    def answers(self) -> None:
        """Answer the newest request with the state."""
        request = self.sent[-1].rstrip(b"\n")
        self.state = {b"on": "on", b"off": "off"}.get(request, self.state)
        self.receives(request + b"=" + self.state.encode())

    def is_up(self) -> "Line":
        self.takes(self.driver.begin(Transition.RECOVER, self.now))
        while self.busy:
            self.answers()
        return self

    @property
    def busy(self) -> bool:
        return self.driver.state not in AT_REST

    @property
    def feedback(self) -> Feedback:
        return self.driver.feedback

    def shows(
        self,
        state: DriverState | None = None,
        power: Power | None = None,
        *,
        busy: bool | None = None,
        unpowered: bool | None = None,
    ) -> None:
        """Check those that are given."""
        assert state in (None, self.driver.state)
        assert power in (None, self.feedback.power)
        assert busy in (None, self.busy)
        assert unpowered in (None, self.driver.unpowered)
