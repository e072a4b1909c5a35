"""A sensor whose value is an object of a drive, read beside the drive's tasks.

The link is not known here: a drive takes an `ObjectRequest` and ends it.
"""

from typing import Final, NamedTuple, Protocol

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.sdo_client import SdoTimeoutError, Transfer
from firmware_bridge.canopen_drive.driver.object_request import ObjectRequest
from firmware_bridge.drivers.driver import Reading
from firmware_bridge.drivers.life_cycle import DriverState
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis, Sensor
from firmware_bridge.units import Nanoseconds


class IoDrive(Protocol):
    """The view of a drive for its inputs and outputs."""

    @property
    def axis(self) -> Axis:
        """The axis that it moves."""

    @property
    def state(self) -> DriverState:
        """Its place in the life cycle."""

    @property
    def set_ups(self) -> int:
        """Number of times that its set-up was written; before each one the drive may have restarted."""

    def request(self, request: ObjectRequest, now: Nanoseconds) -> tuple[Packet, ...]:
        """Do this when nothing more urgent is to be done, or drop it."""


class MeasuredObject(NamedTuple):
    """The object, and how its value becomes the sensor's: `times`, and divided by `over`."""

    address: Address
    type: DataType
    times: float
    over: float


class ObjectSensor:
    """A `firmware_bridge.drivers.driver.SensorDriver`."""

    def __init__(self, sensor: Sensor, drive: IoDrive, measured: MeasuredObject) -> None:
        self.sensor: Final = sensor
        self._drive: Final = drive
        self._measured: Final = measured
        self._requested_at: Nanoseconds = NEVER_RECEIVED
        self._request: ObjectRequest | None = None
        self._reading: Reading | None = None

    @property
    def reading(self) -> Reading | None:
        """Its last report; None where the drive has no such value."""
        self._take()
        return self._reading

    def measure(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask for the value, unless the last question is still open."""
        self._take()
        if self._request is not None:
            return ()
        self._requested_at, self._request = now, ObjectRequest(Transfer(self._measured.address, attempts=1))
        return self._drive.request(self._request, now)

    def _take(self) -> None:
        request = self._request
        if request is None or not request.over:
            return
        self._request = None
        outcome, kind = request.outcome, self._measured.type
        if isinstance(outcome, bytes) and len(outcome) == kind.size:
            value = kind.decode(outcome) * self._measured.times / self._measured.over
            self._reading = Reading(value, self._requested_at, request.ended_at)
        # A time-out leaves the last value, which expires by itself; a refusal means that there is none.
        elif outcome is not None and not isinstance(outcome, SdoTimeoutError):
            self._reading = None
