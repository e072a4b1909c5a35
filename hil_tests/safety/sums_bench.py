"""Robots with sums of speeds, and motors that do at once what they are sent."""

import math
import struct
from collections.abc import Iterable, Sequence
from typing import Final

from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds
from hil_tests.safety.guard_bench import Bench
from hil_tests.safety.guard_robots import AnAxis, robot_with

CYCLE: Final = 50 * MILLISECOND
LINK: Final = "base"
RPM: Final = math.tau / 60.0
"""With this ratio an axis's speed in its unit a second is its motor's in rpm."""
TOP: Final = 1000
ENABLE: Final = 0x000F


def speed(node: int, rpm: int, word: int = ENABLE) -> Packet:
    return Packet(LINK, 0x500 + node, struct.pack("<Hi", word, rpm))


def wheels(*names: str) -> tuple[AnAxis, ...]:
    return tuple(
        AnAxis(name, node, LINK, top_speed=TOP, ratio=RPM) for node, name in enumerate(names, start=1)
    )


PAIR: Final = robot_with(
    wheels("left", "right"),
    sums={"speed": ({"left": 0.5, "right": 0.5}, 600.0), "turn": ({"left": -1.0, "right": 1.0}, 900.0)},
)
"""Differential: as fast as 600, turning as fast as 900."""
_SINES: Final = {
    f"along {degrees}": ({name: 2.0 / 3.0 * math.cos(math.radians(at - degrees)) for name, at in OMNI}, 500.0)
    for OMNI in [(("front", 0), ("left", 120), ("right", 240))]
    for degrees in (0, 60, 120)
}
OMNI: Final = robot_with(
    wheels("front", "left", "right"),
    sums={**_SINES, "turn": (dict.fromkeys(("front", "left", "right"), 1.0 / 3.0), 400.0)},
)
"""Three omni wheels: a hexagon of speeds, and a bound for the turn."""
ROBOTS: Final = (PAIR, OMNI)


def values(robot: AnyRobot, vector: Sequence[float]) -> list[tuple[float, float]]:
    """Each sum and its bound, to both sides."""
    by_name = dict(zip((axis.name for axis in robot.axes), vector, strict=True))
    sums = [(sum(f * by_name[name] for name, f in row.of.items()), row.bound) for row in robot.guard.sums]
    return [*sums, *((-value, bound) for value, bound in sums)]


def within(robot: AnyRobot, vector: Sequence[float]) -> bool:
    return all(value <= bound for value, bound in values(robot, vector))


def as_far_as_allowed(robot: AnyRobot, vector: list[int]) -> list[int]:
    """Shrink a vector onto the nearest bound that it passes."""
    most = max((value / bound for value, bound in values(robot, vector)), default=0.0)
    shrunk = [math.trunc(rpm / most) for rpm in vector] if most > 1.0 else vector
    return shrunk if within(robot, shrunk) else [0] * len(vector)


class Motors:
    """Wheels that do at once what they are sent, and what each sum of their speeds comes to."""

    def __init__(self, robot: AnyRobot) -> None:
        self.robot = robot
        self.speeds = dict.fromkeys((Epos2Axis.of(axis).node for axis in robot.axes), 0.0)
        self.now: Nanoseconds = 0
        self.beyond_since: list[Nanoseconds] = [NEVER] * (2 * len(robot.guard.sums))
        self.excess = [0.0] * (2 * len(robot.guard.sums))
        self.way = 0.0
        """The integral of the first sum."""

    def lives(self, bench: Bench, until: Nanoseconds, stated: Sequence[Packet]) -> None:
        """Wake the guard whenever it wants, and then let the bridge speak."""
        while (reaction := bench.guard.wake(self.now)).wake_at <= until:
            self.receive(reaction.sent, ())
            assert reaction.wake_at > self.now
            self.moves_on(reaction.wake_at)
        self.receive(reaction.sent, ())
        self.moves_on(until)
        self.receive(bench.states(*stated, now=until), stated)

    def moves_on(self, now: Nanoseconds) -> None:
        """Let time pass: nothing is beyond its bound for longer than a cycle, and not again and again."""
        for number, (value, bound) in enumerate(values(self.robot, tuple(self.speeds.values()))):
            excess = self.excess[number] + (value - bound) * (now - self.now)
            self.excess[number] = max(0.0, excess)
            row = self.robot.guard.sums[number % len(self.robot.guard.sums)]
            most = 2 * CYCLE * sum(abs(factor) * TOP for factor in row.of.values())
            assert self.excess[number] <= most * (1 + 1e-9) + 1e-3
            if value > bound:
                self.beyond_since[number] = min(self.beyond_since[number], self.now)
                assert now - self.beyond_since[number] <= CYCLE
            else:
                self.beyond_since[number] = NEVER
        self.way += values(self.robot, tuple(self.speeds.values()))[0][0] * (now - self.now)
        self.now = now

    def receive(self, sent: Iterable[Packet], stated: Sequence[Packet]) -> None:
        for packet in sent:
            word, target = struct.unpack("<Hi", packet.payload)
            node = packet.address & 0x7F
            self.speeds[node] = float(target) if word == ENABLE else 0.0
            if packet not in stated:
                assert self.speeds[node] == 0.0
