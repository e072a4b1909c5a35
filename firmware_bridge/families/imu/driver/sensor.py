"""One quantity of an IMU; a `firmware_bridge.drivers.driver.SensorDriver`."""

from typing import Final

from firmware_bridge.drivers.driver import Reading
from firmware_bridge.families.imu.settings import ImuSensor, Quantity
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Sensor
from firmware_bridge.units import Nanoseconds

ORDER: Final = tuple(Quantity)
"""Order of the values that a sensor takes."""


class ImuQuantity:
    """A quantity in the newest frame."""

    def __init__(self, sensor: Sensor, settings: ImuSensor) -> None:
        self.sensor: Final = sensor
        self.settings: Final = settings
        self._place: Final = ORDER.index(settings.quantity)
        self.reading: Reading | None = None
        """Its value in the newest frame; None where the frame does not count, or is too old."""

    def measure(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Do nothing: it is received without a request."""
        del now
        return ()

    def take(self, values: tuple[float, ...], sampled_at: Nanoseconds, received_at: Nanoseconds) -> None:
        """Take the values of a frame, in the order of `ORDER`."""
        self.reading = Reading(values[self._place] - self.settings.bias, sampled_at, received_at)

    def missed(self) -> None:
        """Note that there is no value."""
        self.reading = None
