"""An emulated capture system and the bridge's link to it, on one wire of the virtual world."""

from typing import Any

import numpy as np

from emulators.motion_capture.bodies import Circling, Standing, TrackedBody
from emulators.motion_capture.exposure import Cameras
from emulators.motion_capture.system import COMMAND, MotionCapture
from emulators.wires import DatagramWire
from emulators.world import World
from firmware_bridge.families.motion_capture.driver.body import SeenBody
from firmware_bridge.families.motion_capture.driver.mavlink import MavlinkPoses
from firmware_bridge.families.motion_capture.driver.natnet import NatNetLink
from firmware_bridge.families.motion_capture.settings import CaptureBody, CaptureLink
from firmware_bridge.families.motion_capture.wire.layout import Version
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import Sensor
from firmware_bridge.units import MILLISECOND, Nanoseconds

LINK = "capture"
SERVER = "127.0.0.1:1510"
ROUND = Circling(1.0, 0.5, 0.2)
V3_1 = Version(3, 1)


def table(driver: str = "natnet", **more: Any) -> CaptureLink:
    listen = "127.0.0.1:14560"
    return CaptureLink.model_validate(
        {"driver": driver, "server": SERVER, "listen": listen, "silent_ms": 500, **more}
    )


def body(**more: Any) -> SeenBody:
    settings = {"body": "robot", "fastest_mps": 1.0, "fastest_rad_s": 1.0, **more}
    sensor = Sensor.model_validate(
        {
            "name": "place",
            "title": "where the cameras see it",
            "link": LINK,
            "every_ms": 50,
            "silent_ms": 200,
            "settings": settings,
        }
    )
    assert isinstance(sensor.settings, CaptureBody)
    return SeenBody(sensor, sensor.settings)


class Listening:
    """A link as a node, beside what a bridge does of it; it keeps each new reading."""

    def __init__(self, link: NatNetLink | MavlinkPoses, seen: SeenBody) -> None:
        self.link = link
        self.seen = seen
        self.readings: list[Any] = []
        self.beat_at: Nanoseconds = 0

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        before = self.seen.reading
        sent = self.link.receive(packet, now)
        if self.seen.reading is not None and self.seen.reading is not before:
            self.readings.append(self.seen.reading)
        return Reaction(sent, self._wake_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        sent: tuple[Packet, ...] = ()
        if now >= self.link.wake_at:
            sent += self.link.wake(now)
        if now >= self.beat_at:
            self.beat_at = now + self.link.beat_every
            sent += self.link.beat(now)
        return Reaction(sent, self._wake_at)

    @property
    def _wake_at(self) -> Nanoseconds:
        return min(self.link.wake_at, self.beat_at)


def joined(
    seen: SeenBody, cameras: Cameras, version: Version = V3_1, seed: int = 1
) -> tuple[World, MotionCapture, Listening]:
    """Put both on a network with 0.2 to 0.5 ms from one to the other."""
    world = World()
    wire = DatagramWire(
        MILLISECOND // 5, MILLISECOND * 3 // 10, generator=np.random.default_rng([seed, 1]), name=LINK
    )
    bodies = [TrackedBody(4, "box", Standing()), TrackedBody(7, "robot", ROUND)]
    system = MotionCapture(
        bodies, np.random.default_rng([seed, 2]), version=version, cameras=cameras, data_link=COMMAND
    )
    listening = Listening(NatNetLink(LINK, table(), [seen]), seen)
    world.attach("system", system, {COMMAND: wire})
    world.attach("bridge", listening, {LINK: wire})
    return world, system, listening
