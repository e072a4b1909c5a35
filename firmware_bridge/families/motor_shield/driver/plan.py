"""Timing of a robot's cycle on a board's serial line: each command with its cost, from the bytes up.

A request costs the time of its bytes both ways, the board's writes to the shield for it, the latency of the
second chip on the board (4.1 ms at most), and that of this machine's port. The fullest cycle is a reversal:
all motors change speed and direction. It may fill 80 % of the cycle; a plan that does not fit is refused
before anything moves.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from firmware_bridge.drivers.link_drivers import PlanError
from firmware_bridge.families.motor_shield.driver.dialects import BUS_WRITE_US, DIALECTS, BoardMessage
from firmware_bridge.families.motor_shield.settings import ShieldAxis, ShieldLink
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds

BITS_PER_BYTE: Final = 10
CHIP_FLUSH_US: Final = 4_096
"""Longest time for which the ATmega16U2 keeps the board's bytes from the host."""
MOST: Final = 0.8
"""Share of the cycle that its fullest may take."""


@dataclass(frozen=True, slots=True)
class BoardCommand:
    """One command of a cycle."""

    what: str
    bytes: int
    time: Nanoseconds


@dataclass(frozen=True, slots=True)
class ShieldPlan:
    """The fullest cycle, in the order in which its commands leave."""

    cycle: Nanoseconds
    samples: tuple[BoardCommand, ...]
    commands: tuple[BoardCommand, ...]

    @property
    def time(self) -> Nanoseconds:
        """Time that the line and the board are busy in the fullest cycle."""
        return sum(entry.time for entry in (*self.samples, *self.commands))

    @property
    def answers_within(self) -> Nanoseconds:
        """Longest time of all samples; one command more may have begun before them."""
        longest = max(entry.time for entry in (*self.samples, *self.commands))
        return sum(entry.time for entry in self.samples) + longest

    @property
    def share(self) -> float:
        """Of the cycle that is filled."""
        return self.time / self.cycle


def shield_plan(robot: AnyRobot, name: str) -> ShieldPlan:
    """Lay out the fullest cycle of a link to a board."""
    link, axes = ShieldLink.of_link(robot, name), robot.axes_on(name)
    dialect = DIALECTS[link.protocol](link, [ShieldAxis.of(axis) for axis in axes])
    motors = [ShieldAxis.of(axis).port for axis in axes]
    # The fullest cycle: the longest digits, backwards, of motors that have just run forwards.
    most = (-99 if dialect.on_board else -ShieldAxis.of(axes[0]).max_pwm for _ in motors)
    reversal = dialect.drive(dict(zip(motors, most, strict=True)), dict.fromkeys(motors, 1))
    return ShieldPlan(
        robot.cycle * link.every,
        _entries(link, dialect.encoders()),
        _entries(link, reversal),
    )


def fitting_plan(robot: AnyRobot, name: str) -> ShieldPlan:
    """Lay out the fullest cycle of a link to a board; PlanError where the cycle is too short."""
    plan = shield_plan(robot, name)
    if plan.time <= MOST * plan.cycle:
        return plan
    link = ShieldLink.of_link(robot, name)
    # Rounded up: a cycle just too short is too short.
    needed = -(-plan.time // round(MOST * robot.cycle))
    raise PlanError(
        f"link '{name}': a reversal over {link.protocol.value} takes {plan.time / MILLISECOND:.1f} ms, which "
        f"is more than {MOST:.0%} of its cycle of {plan.cycle // MILLISECOND} ms; use every = {needed} or a "
        "longer cycle_ms in the robot file"
    )


def _entries(link: ShieldLink, orders: Iterable[BoardMessage]) -> tuple[BoardCommand, ...]:
    return tuple(BoardCommand(say.what, len(say.data) + say.answer, takes(link, say)) for say in orders)


def takes(link: ShieldLink, say: BoardMessage) -> Nanoseconds:
    """Return how long a command takes, with its answer and what the board writes for it."""
    on_line = (len(say.data) + say.answer) * BITS_PER_BYTE * SECOND // link.rate
    # Only an answer waits for the USB chip, which collects bytes before it passes them on.
    turn = 0 if say.reads is None else (CHIP_FLUSH_US + link.port_latency_us) * MICROSECOND
    on_bus = say.writes * BUS_WRITE_US * MICROSECOND
    # A command without an answer is written to the shield while the next one is on the line.
    return on_line + turn + on_bus if say.reads is not None else max(on_line, on_bus)
