"""The life cycle of drivers: its table, and at every instant the state in which power and motion are sent."""

import re
from collections import deque
from collections.abc import Callable, Sequence
from itertools import product
from typing import Final, NamedTuple, TypeAlias

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from emulators.arduino_omni.board import FIRMWARES, Board
from emulators.arduino_omni.motors import four_motors
from firmware_bridge.canopen_drive.driver.process_data import SET_POINT, SET_POINT_COB_ID, STATUS_COB_ID
from firmware_bridge.canopen_drive.driver.set_point import ENABLE, HALT, NEW_POSITION
from firmware_bridge.drivers.all_drivers import all_drivers_of
from firmware_bridge.drivers.driver import Driver, Homed, Position, Power, SetPoint, Speed, Stop
from firmware_bridge.drivers.life_cycle import (
    AT_REST,
    FOUND,
    NOT_ENDED,
    OUTCOMES,
    TABLE,
    DriverState,
    LifeCycle,
    Task,
    Transition,
)
from firmware_bridge.families.ar2 import wire
from firmware_bridge.families.ar2.driver.joint import Ar2Joint
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.families.motor_shield.driver.motor import ShieldMotor
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot, CommandForm
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, to_seconds
from hil_tests.lanes import examples
from hil_tests.unit.drivers.link_drivers_bench import Bench, Host
from hil_tests.unit.drivers.robots import RARS

TAKES_POWER: Final = {
    Transition.DEACTIVATE,
    Transition.LISTEN,
    Transition.QUICK_STOP,
    Transition.POWER_OFF,
    Transition.RESET,
}
GIVEN: Final = (DriverState.ACTIVATING, DriverState.ACTIVE, DriverState.HOMING)
"""States in which a device may be given power."""
SWITCHED_ON: Final = 0x0007
"""Bits of a Controlword that gives power: 0x0007, and 0x000F with what is set beside it."""
ENABLED: Final = (0x0137).to_bytes(2, "little")
"""Statusword of a drive in Operation enabled."""
SET_POINTS: Final = (Speed(1.0), Speed(0.0), Position(0.2), Homed(), *Stop)


def begun(state: DriverState) -> set[Transition]:
    return {transition for at, transition in TABLE if at is state}


def test_each_state_is_explained_and_reached() -> None:
    assert set(AT_REST) | {row.state for row in TABLE.values()} | {DriverState.RESTORING} == set(DriverState)
    assert {state for outcome in OUTCOMES.values() for state in outcome} <= set(AT_REST)


def test_after_a_failure_only_recover_leads_on_and_what_takes_the_power() -> None:
    assert begun(DriverState.FAILED) == {Transition.RECOVER} | TAKES_POWER


def test_power_is_requested_by_activate_and_recover_alone_and_recover_configures_before() -> None:
    for (_, transition), row in TABLE.items():
        if Task.ENABLE in row.tasks:
            assert transition in {Transition.ACTIVATE, Transition.RECOVER}
    assert begun(DriverState.UNCONFIGURED) == {Transition.CONFIGURE, Transition.RECOVER} | TAKES_POWER
    assert TABLE[DriverState.FAILED, Transition.RECOVER].tasks[:3] == FOUND


@pytest.mark.parametrize("transition", [Transition.ACTIVATE, Transition.HOME, Transition.SET_ZERO])
def test_what_a_state_does_not_begin_is_refused_by_name_and_leaves_it(transition: Transition) -> None:
    life = LifeCycle()
    life.begin(transition, configured=True)
    assert (life.state, life.tasks) == (DriverState.UNCONFIGURED, ())
    assert life.problem == f"'{transition.value}' is refused: it is unconfigured"


@pytest.mark.parametrize("transition", [Transition.ACTIVATE, Transition.HOME, Transition.SET_ZERO])
def test_an_active_device_that_has_lost_its_set_up_is_as_one_without(transition: Transition) -> None:
    life = LifeCycle()
    life.begin(Transition.RECOVER, configured=False)
    while life.tasks:
        life.done()
    assert life.state is DriverState.ACTIVE
    life.begin(transition, configured=False)
    assert (life.tasks, life.problem) == ((), f"'{transition.value}' is refused: it is unconfigured")
    # What it needs begins.
    life.begin(Transition.CONFIGURE, configured=False)
    assert life.tasks[:3] == FOUND


Operation: TypeAlias = tuple[Transition, bool] | str
"""A transition, with whether the set-up is in force, or something else."""
OPERATIONS: Final = st.one_of(
    st.tuples(st.sampled_from(Transition), st.booleans()),
    st.sampled_from(["done", "fail", "end", "power off", "restore"]),
)


def operate(life: LifeCycle, operation: Operation) -> None:
    if isinstance(operation, tuple):
        transition, configured = operation
        life.begin(transition, configured=configured)
    elif operation == "fail":
        life.fail("why")
    elif operation == "end":
        life.end()
    elif life.tasks and operation == "done":
        life.done()
    elif not life.tasks and operation == "restore":
        life.restore(FOUND)
    elif operation == "power off":
        life.power_off()


@given(st.lists(OPERATIONS, max_size=60))
@settings(max_examples=examples(300))
def test_at_every_instant_the_state_is_that_of_its_tasks(operations: Sequence[Operation]) -> None:
    life = LifeCycle()
    for operation in operations:
        before = life.state
        operate(life, operation)
        wanted = operation[0] if isinstance(operation, tuple) else operation
        if before is DriverState.FAILED and wanted not in {Transition.RECOVER, *TAKES_POWER, "restore"}:
            assert life.state is before
        assert (life.state in AT_REST) == (not life.tasks)
        assert (life.tasks[:1] == (Task.ENABLE,)) == (life.state is DriverState.ACTIVATING)
        assert life.tasks[:1] != (Task.HOME,) or life.state is DriverState.HOMING
        assert life.state is not DriverState.ACTIVE or before in GIVEN or before in NOT_ENDED
        assert life.seen(configured=True) is life.state
        assert life.seen(configured=False) not in {DriverState.ACTIVE, DriverState.INACTIVE}


class Act(NamedTuple):
    """A request or a set-point for one of the drivers, and how long nothing follows."""

    place: int
    does: Transition | SetPoint
    waits: Nanoseconds


ACTS: Final = st.lists(
    st.builds(
        Act,
        st.integers(0, 5),
        st.one_of(st.sampled_from(Transition), st.sampled_from(SET_POINTS)),
        st.sampled_from([0, MILLISECOND, 20 * MILLISECOND, 300 * MILLISECOND]),
    ),
    min_size=1,
    max_size=25,
)
DRIVEN: Final = [
    Act(0, Transition.RECOVER, 3 * SECOND),
    Act(0, Transition.SET_ZERO, 300 * MILLISECOND),
    Act(0, Speed(1.0), 300 * MILLISECOND),
    Act(0, Position(0.2), 300 * MILLISECOND),
    Act(0, Transition.POWER_OFF, 300 * MILLISECOND),
    Act(0, Speed(1.0), 300 * MILLISECOND),
    Act(0, Transition.RESET, 3 * SECOND),
    Act(0, Position(0.3), 300 * MILLISECOND),
]
"""It is activated, referenced where it can be, moves, loses its power, and is commanded to move."""


def does(driver: Driver, act: Act, set_points: dict[str, SetPoint], now: Nanoseconds) -> tuple[Packet, ...]:
    if act.does is Transition.SET_ZERO:
        return driver.set_zero(0.0, now)
    if isinstance(act.does, Transition):
        return driver.begin(act.does, now)
    set_points[driver.axis.name] = act.does
    return driver.command(act.does)


class Watched(Host):
    """A host that looks at each of its packets in the state in which it leaves."""

    def __init__(self, robot: AnyRobot) -> None:
        super().__init__(robot)
        self.acts: deque[Act] = deque()
        self.moves = 0
        self.repairs = False

    def _reaction(self, sent: tuple[Packet, ...], now: Nanoseconds) -> Reaction:
        self._judge(sent)
        while self.acts:
            act = self.acts.popleft()
            more = does(self.drivers[act.place % len(self.drivers)], act, self.set_points, now)
            self._judge(more)
            sent += more
        return super()._reaction(sent, now)

    def _judge(self, sent: tuple[Packet, ...]) -> None:
        for packet, driver in product(sent, self.drivers):
            axis = driver.axis
            if packet.address == SET_POINT_COB_ID[axis.command] + Epos2Axis.of(axis).node:
                word, target = SET_POINT[axis.command].unpack(packet.payload)
                if word == NEW_POSITION or (word == ENABLE and axis.command is CommandForm.SPEED and target):
                    assert driver.state is DriverState.ACTIVE
                    self.moves += 1
                if word & SWITCHED_ON == SWITCHED_ON:
                    assert driver.state in GIVEN or driver.feedback.power is Power.ON


def drives(acts: Sequence[Act]) -> int:
    bench = Bench(RARS, host=Watched)
    host = bench.host
    assert isinstance(host, Watched)
    bench.starts()
    for act in acts:
        host.acts.append(act)
        bench.runs(0.01 + to_seconds(act.waits))
    return host.moves


@pytest.mark.parametrize("transition", [Transition.END, Transition.LISTEN, Transition.POWER_OFF])
def test_an_enabled_drive_is_moved_by_an_active_driver_alone(transition: Transition) -> None:
    """It has power from elsewhere, or its report is of before."""
    (drivers,) = all_drivers_of(RARS)
    for driver in drivers.drivers:
        axis = driver.axis
        driver.begin(Transition.CONFIGURE, 0, Task.START)
        drivers.link.receive(Packet(axis.link, STATUS_COB_ID + Epos2Axis.of(axis).node, ENABLED), 0)
        driver.begin(transition, 0)
        driver.begin(Transition.END, 0)
        (*_, packet) = driver.command(Position(0.1) if axis.command is CommandForm.POSITION else Speed(1.0))
        word, target = SET_POINT[axis.command].unpack(packet.payload)
        assert driver.state is not DriverState.ACTIVE
        assert (word, target) == ((HALT if axis.command is CommandForm.POSITION else ENABLE), 0)


class Line:
    """A board's drivers and what answers them; each packet is looked at in the state in which it leaves."""

    def __init__(self, robot: AnyRobot) -> None:
        (self.drivers,) = all_drivers_of(robot)
        self.link: Final = self.drivers.link
        self.cycle: Final = robot.cycle
        self.set_points: dict[str, SetPoint] = {}
        self.now: Nanoseconds = 5 * SECOND
        self.moves = 0
        self.sent = 0
        """Number of the bridge's packets."""
        self.silent = False
        """Nothing of the board arrives."""

    def runs(self, time: Nanoseconds) -> None:
        end = self.now + time
        while self.now < end:
            self.now += MILLISECOND
            self.sends(self.link.wake(self.now) if self.link.wake_at <= self.now else ())
            self.sends(self.passes())
            if self.now % self.cycle == 0:
                self.sends(self.link.sample(self.now))
                self.sends(self.drivers.command(self.set_points))

    def sends(self, packets: tuple[Packet, ...]) -> None:
        waiting = deque(packets)
        while waiting:
            packet = waiting.popleft()
            for driver in self.moved(packet.payload):
                assert driver.state is DriverState.ACTIVE
                self.moves += 1
            self.sent += 1
            for answer in () if self.silent else self.answers(packet):
                waiting.extend(
                    self.link.receive(Packet(self.link.name, answer.address, answer.payload), self.now)
                )

    def does(self, acts: Sequence[Act]) -> int:
        for act in acts:
            driver = self.drivers.drivers[act.place % len(self.drivers.drivers)]
            self.sends(does(driver, act, self.set_points, self.now))
            self.runs(act.waits)
        return self.moves

    def moved(self, payload: bytes) -> Sequence[Driver]:
        """Return the drivers whose motors this line moves."""
        raise NotImplementedError

    def answers(self, packet: Packet) -> tuple[Packet, ...]:
        raise NotImplementedError

    def passes(self) -> tuple[Packet, ...]:
        """Return what the board's time brings about."""
        return ()


class ShieldLine(Line):
    """The omnidirectional base's emulated board."""

    def __init__(self) -> None:
        super().__init__(over_protocol(find("rome"), "ros-arduino-bridge"))
        self._board = Board(FIRMWARES["ros-arduino-bridge"], four_motors(), encoders=3)
        for at in range(0, self.now, SECOND // 10):
            self._board.wake(at)

    def moved(self, payload: bytes) -> Sequence[Driver]:
        found = re.fullmatch(rb"m (-?\d+) (-?\d+) (-?\d+)\r", payload)
        motors = [driver for driver in self.drivers.drivers if isinstance(driver, ShieldMotor)]
        return [motor for motor in motors if found is not None and int(found[motor.number])]

    def answers(self, packet: Packet) -> tuple[Packet, ...]:
        return self._board.receive(Packet(SERIAL, packet.address, packet.payload), self.now).sent

    def passes(self) -> tuple[Packet, ...]:
        sent: tuple[Packet, ...] = ()
        for stated in () if self.silent else self._board.wake(self.now).sent:
            sent += self.link.receive(Packet(self.link.name, stated.address, stated.payload), self.now)
        return sent


class ArmLine(Line):
    """The arm's board: it echoes what it is to echo, and takes every move."""

    def __init__(self) -> None:
        super().__init__(find("ar2"))

    def moved(self, payload: bytes) -> Sequence[Driver]:
        request = wire.decode(payload.rstrip())
        joints = [driver for driver in self.drivers.drivers if isinstance(driver, Ar2Joint)]
        steps = {} if request is None or request.letters != "MJ" else request.steps
        return [joint for joint in joints if steps.get(wire.LETTERS[joint.number - 1])]

    def answers(self, packet: Packet) -> tuple[Packet, ...]:
        request = wire.decode(packet.payload.rstrip())
        echoes = request is not None and request.letters == "TM"
        return (Packet(SERIAL, 0, wire.echo(request.text)),) if request is not None and echoes else ()


def shields(acts: Sequence[Act]) -> int:
    return ShieldLine().does(acts)


def arms(acts: Sequence[Act]) -> int:
    return ArmLine().does(acts)


FAMILIES: Final = pytest.mark.parametrize("family", [drives, shields, arms])


@FAMILIES
def test_a_driver_moves_its_axis_once_it_is_active(family: Callable[[Sequence[Act]], int]) -> None:
    assert family(DRIVEN) > 0


@FAMILIES
@settings(max_examples=examples(15), phases=(Phase.explicit, Phase.reuse, Phase.generate))
@given(acts=ACTS)
def test_at_no_instant_what_moves_or_gives_power_is_sent_in_a_state_without(
    family: Callable[[Sequence[Act]], int], acts: Sequence[Act]
) -> None:
    family([*DRIVEN[:3], *acts])
