"""Faults of an Arduino: its cable, supply and reset; behind a shield the wires of motors and encoders."""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Annotated, ClassVar, Final

from numpy.random import Generator
from pydantic import Field

from emulators.arduino_omni.ar2.board import Ar2Board
from emulators.arduino_omni.board import Board
from emulators.arduino_omni.motors import Motors
from emulators.bench.faults.fault import Fault, Lasting, Node, Problem, Stations
from emulators.bench.faults.site import Site
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.problems import near
from firmware_bridge.units import MILLISECOND, NEVER

One = Annotated[Node, Field(description="affected motor")]
BURST: Final = 8
"""Length of a disturbance, in bytes."""
PRINTED: Final = b"t=21\r\n"
"""Example of a debug print."""


def _shield(site: Site, link: str) -> Board:
    """Return the board with a motor shield on a link; KeyError where it has none."""
    return site.devices.nodes(Board)[link]


def _board(site: Site, link: str) -> Board | Ar2Board:
    """Return the board on a link; KeyError where it has none."""
    return (site.devices.nodes(Board) | site.devices.nodes(Ar2Board))[link]


class _OfBoards(Fault, ABC):
    """A fault of one board, or of every board that the robot has."""

    among: ClassVar = Stations.NONE
    link: Annotated[str | None, Field(description="link of the board; without it every board")] = None

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Yield the equipment that this robot lacks for it."""
        known = self.possible(robot)
        if not known:
            yield "kind", f"{robot.name} has no {self.needed}"
        elif self.link is not None and self.link not in known:
            yield "link", f"no {self.needed} is on '{self.link}'; {near(self.link, known)}"

    needed: ClassVar = "Arduino"
    """The device without which the fault is not possible on a robot."""

    @staticmethod
    def possible(robot: AnyRobot) -> list[str]:
        """Return the links that have such a board."""
        return [*ShieldLink.all_of(robot), *Ar2Link.all_of(robot)]

    def on(self, robot: AnyRobot) -> list[str]:
        """Return the links whose boards have it."""
        return [name for name in self.possible(robot) if self.link in {None, name}]

    def boards(self, site: Site) -> list[Board | Ar2Board]:
        """Return the boards that have it."""
        return [_board(site, name) for name in self.on(site.robot)]


class _OfShields(_OfBoards, ABC):
    needed: ClassVar = "board with a motor shield"

    @staticmethod
    def possible(robot: AnyRobot) -> list[str]:
        """Return the links that have such a board."""
        return list(ShieldLink.all_of(robot))


class _Switched(_OfBoards, Lasting, ABC):
    """A state that lasts from the fault's beginning to its end."""

    def put_on(self, site: Site, chance: Generator) -> None:
        """Let it begin."""
        del chance
        self._have(site, on=True)

    def take_off(self, site: Site) -> None:
        """Let it end."""
        self._have(site, on=False)

    @abstractmethod
    def _have(self, site: Site, *, on: bool) -> None:
        """Set the state, or reset it."""


class BoardSilent(_OfBoards, Lasting):
    """The board neither sends nor receives."""

    kind: ClassVar = "board_silent"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Cut it off."""
        del chance
        for name in self.on(site.robot):
            site.world.silence(name, site.world.now)

    def take_off(self, site: Site) -> None:
        """Let it send and receive again."""
        for name in self.on(site.robot):
            site.world.silence(name, NEVER)


class BoardReset(_OfBoards):
    """The board's reset button is pressed, or its supply dips: it restarts."""

    kind: ClassVar = "board_reset"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Pull RESET."""
        del chance
        for board in self.boards(site):
            board.reset(site.world.now)


class BoardHangs(_OfBoards):
    """The board's firmware hangs until a reset, as when I2C is stuck; the shield continues."""

    kind: ClassVar = "board_hangs"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Let it hang."""
        del chance
        for board in self.boards(site):
            board.hang(site.world.now)


class BoardBrownOut(_Switched):
    """The supply of the board's processor is too low: it is held in reset, and its shield continues."""

    kind: ClassVar = "board_brown_out"

    def _have(self, site: Site, *, on: bool) -> None:
        for board in self.boards(site):
            board.mega.brown_out(site.world.now, low=on)


class BoardUnpowered(_OfShields, _Switched):
    """Processor and shield lose their 5 V: both restart with it."""

    kind: ClassVar = "board_unpowered"

    def _have(self, site: Site, *, on: bool) -> None:
        for name in self.on(site.robot):
            _shield(site, name).unpower(site.world.now, off=on)


class BoardChatters(_OfBoards, Lasting):
    """The sketch prints something by itself, again and again: a debug print that was left in."""

    kind: ClassVar = "board_chatters"
    every_ms: Annotated[int, Field(ge=1, le=10_000, description="interval between two prints, in ms")] = 50

    def put_on(self, site: Site, chance: Generator) -> None:
        """Begin to print."""
        del chance
        self._print(site)

    def _print(self, site: Site) -> None:
        now = site.world.now
        if site.lasts(self, self.end):
            for name in self.on(site.robot):
                _board(site, name).mega.print(PRINTED, now)
                # The board has bytes to send now, and no packet would wake it.
                site.world.rouse(name)
            site.world.call_at(now + self.every_ms * MILLISECOND, self._print, site)


class _BusStuck(_OfShields, _Switched):
    """The I2C bus between board and shield is blocked; a sketch that waits for it hangs until a reset."""

    def _have(self, site: Site, *, on: bool) -> None:
        for name in self.on(site.robot):
            _shield(site, name).mega.jam_bus(site.world.now, stuck=on)


class I2cStuck(_BusStuck):
    """A line of the I2C bus is held low: the shield keeps its settings, and the sketch hangs."""

    kind: ClassVar = "i2c_stuck"


class ShieldAbsent(_BusStuck):
    """No shield is on the board, or it is off: the motors have no power, and the sketch hangs."""

    kind: ClassVar = "shield_absent"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Take it off; the board's pull-ups went with it."""
        super().put_on(site, chance)
        for name in self.on(site.robot):
            # Up to now the motors have turned by the outputs that the chip had.
            _shield(site, name).advance(site.world.now)
            _shield(site, name).mega.shield.chip.power_on()


class LineGarbage(_OfBoards, Lasting):
    """Foreign bytes, sent by neither end, are on the line between bridge and board."""

    kind: ClassVar = "line_garbage"
    every_ms: Annotated[int, Field(ge=1, le=10_000, description="interval between two bursts, in ms")] = 20

    def put_on(self, site: Site, chance: Generator) -> None:
        """Begin to disturb."""
        self._disturb((site, chance))

    def _disturb(self, sites: tuple[Site, Generator]) -> None:
        site, chance = sites
        if site.lasts(self, self.end):
            for name in self.on(site.robot):
                site.disturb(name, chance.bytes(BURST))
            site.world.call_at(site.world.now + self.every_ms * MILLISECOND, self._disturb, sites)


class _OnMotor(Lasting, ABC):
    among: ClassVar = Stations.MOTORS
    node: One

    def _found(self, site: Site) -> Iterator[tuple[Motors, int]]:
        for axis in site.robot.axes:
            if axis.name in self.targets(site.robot):
                yield _shield(site, axis.link).motors, axis.settings.number - 1


class ShaftBlocked(_OnMotor):
    """A motor's shaft is blocked."""

    kind: ClassVar = "shaft_blocked"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Let it begin; PlantError where the plant has no such input."""
        del chance
        for motors, place in self._found(site):
            motors.block(place, blocked=True)

    def take_off(self, site: Site) -> None:
        """Let it end."""
        for motors, place in self._found(site):
            motors.block(place, blocked=False)


class LoadLifted(_OnMotor):
    """The load of a motor is off the floor: it turns freely."""

    kind: ClassVar = "load_lifted"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Hoist it; PlantError where the plant has no such input."""
        del chance
        for motors, place in self._found(site):
            motors.hoist(place, lifted=True)

    def take_off(self, site: Site) -> None:
        """Put it down."""
        for motors, place in self._found(site):
            motors.hoist(place, lifted=False)


class MotorSupplySag(_OfShields, Lasting):
    """The motors' own supply sags; below a limit the half bridges switch their outputs off."""

    kind: ClassVar = "motor_supply_sag"

    to_v: Annotated[float, Field(ge=0, le=15, description="voltage of the motors' supply, in V")]

    def put_on(self, site: Site, chance: Generator) -> None:
        """Let it sag."""
        del chance
        self._have(site, self.to_v)

    def take_off(self, site: Site) -> None:
        """Give it back."""
        self._have(site, math.inf)

    def _have(self, site: Site, volts: float) -> None:
        for name in self.on(site.robot):
            _shield(site, name).motors.starves(volts)


class CurrentLimit(_OfShields, _Switched):
    """The half bridges cut a current that reaches their peak, which the emulation omits otherwise."""

    kind: ClassVar = "current_limit"

    def _have(self, site: Site, *, on: bool) -> None:
        for name in self.on(site.robot):
            _shield(site, name).motors.faults.limits_current = on


class OverTemperature(_OfShields, _Switched):
    """The half bridges warm up, and shut down where they are too hot, which the emulation omits otherwise."""

    kind: ClassVar = "over_temperature"

    def _have(self, site: Site, *, on: bool) -> None:
        for name in self.on(site.robot):
            _shield(site, name).motors.follow_heat(followed=on)


class _WireOff(_OnMotor, ABC):
    def put_on(self, site: Site, chance: Generator) -> None:
        """Let it begin."""
        del chance
        for motors, place in self._found(site):
            self._wires(motors).add(place)

    def take_off(self, site: Site) -> None:
        """Let it end."""
        for motors, place in self._found(site):
            self._wires(motors).discard(place)

    @abstractmethod
    def _wires(self, motors: Motors) -> set[int]:
        """Return the motors whose wires are off."""


class MotorCableOff(_WireOff):
    """A wire between shield and motor is off."""

    kind: ClassVar = "motor_cable_off"

    def _wires(self, motors: Motors) -> set[int]:
        return motors.faults.cut


class EncoderCableOff(_WireOff):
    """The cable of a motor's encoder is off."""

    kind: ClassVar = "encoder_cable_off"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Let it begin; PlantError where the motor has no encoder."""
        for motors, place in self._found(site):
            motors.has_encoder(place)
        super().put_on(site, chance)

    def _wires(self, motors: Motors) -> set[int]:
        return motors.faults.dead


class MotorLeadsSwapped(_WireOff):
    """The two leads of a motor are exchanged."""

    kind: ClassVar = "motor_leads_swapped"

    def _wires(self, motors: Motors) -> set[int]:
        return motors.faults.reversed
