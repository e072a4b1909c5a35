"""An IMU's frames made by hand, and the bridge's end of its line."""

import math
from collections.abc import Iterator
from typing import Any

from emulators.imu.truth import Matrix, Vector, about_x, about_y, inverse, product, turned
from firmware_bridge.families.imu.driver.link import ImuLine
from firmware_bridge.families.imu.driver.sensor import ImuQuantity
from firmware_bridge.families.imu.settings import ImuLink, ImuSensor, Quantity
from firmware_bridge.families.imu.wire import ImuFrame, encoded
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Sensor
from firmware_bridge.units import MILLISECOND, Nanoseconds

LINK = "imu"
G = 8192
"""Counts of 1 g."""
STEP: Nanoseconds = 10 * MILLISECOND
SETTLED = 100
"""Frames after which readings begin."""
GRAVITY = 9.81


def table(**more: Any) -> ImuLink:
    return ImuLink.model_validate({"driver": "imu-serial", "silent_ms": 100, **more})


def quantity(name: str, **more: Any) -> ImuQuantity:
    sensor = Sensor.model_validate(
        {
            "name": name,
            "title": name,
            "link": LINK,
            "every_ms": 50,
            "silent_ms": 100,
            "settings": {"quantity": name, **more},
        }
    )
    assert isinstance(sensor.settings, ImuSensor)
    return ImuQuantity(sensor, sensor.settings)


def upwards(pitch: float, roll: float) -> Vector:
    """Return the upward direction in the axes of a body, by pitch (nose up) and roll (left side up), rad."""
    attitude: Matrix = product(about_y(-pitch), about_x(roll))
    return turned(inverse(attitude), (0.0, 0.0, 1.0))


def counts(force_g: Vector) -> tuple[int, int, int]:
    x, y, z = (round(one * G) for one in force_g)
    return x, y, z


class Line:
    """The bridge's end, and a sensor whose last bit trembles, as a real one's does."""

    def __init__(self, **more: Any) -> None:
        self.quantities = {name: quantity(name) for name in Quantity}
        self.link = ImuLine(LINK, table(**more), self.quantities.values())
        self.number = 0
        self.now: Nanoseconds = 0
        self.status = 0
        self.trembles = True

    def frames(
        self, count: int, force: tuple[int, int, int] = (0, 0, G), rate: tuple[int, int, int] = (0, 0, 0)
    ) -> None:
        """Let so many frames come, one every 10 ms."""
        for data in self.written(count, force, rate):
            self.link.receive(Packet(LINK, 0, data), self.now)

    def written(
        self, count: int, force: tuple[int, int, int] = (0, 0, G), rate: tuple[int, int, int] = (0, 0, 0)
    ) -> Iterator[bytes]:
        """Yield so many frames, each at its time."""
        for _ in range(count):
            self.number += 1
            self.now += STEP
            trembling = (force[0] + self.number % 2 if self.trembles else force[0], *force[1:])
            yield encoded(ImuFrame(self.number % 256, self.status, self.now // MILLISECOND, trembling, rate))

    def passes(self, milliseconds: int) -> None:
        """Let time pass without a frame, and the link be woken where it is due."""
        self.now += milliseconds * MILLISECOND
        if self.link.wake_at <= self.now:
            self.link.wake(self.now)

    def value(self, name: str) -> float | None:
        """Return a reading; None without one."""
        reading = self.quantities[Quantity(name)].reading
        return None if reading is None else reading.value

    def degrees(self, name: str) -> float:
        """Return an angle in degrees; AssertionError without a reading."""
        value = self.value(name)
        assert value is not None, self.link.problem
        return math.degrees(value)
