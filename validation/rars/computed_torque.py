"""Computed torque with PID for the steering, through its emulated drive in current mode, [R] 3.5.1, 3.5.2.

A master on the CAN bus regulates the rack by (3.99) to (3.101): it configures the drive by SDO, reads
position and speed at each SYNC, and sends the current. Independent is the closed form of (3.102), corrected.
"""

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import Final, NamedTuple

import numpy as np

from emulators.devices import devices
from emulators.servo.axis import TICK, ServoAxis
from emulators.wires import FaultyCanWire
from emulators.world import World
from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import ControlwordCommand, PowerState, towards, word_of
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.pdo import Layout
from firmware_bridge.canopen.sdo_client import NodeClient, SdoError, Transfer
from firmware_bridge.canopen_drive.driver.process_data import pdos
from firmware_bridge.canopen_drive.driver.setup import Traffic
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.families.epos2.driver.product import configuration
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.families.epos2.wire.power_states import STATES
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, QUADCOUNTS_PER_LINE, RPM_PER_RAD_S, SECOND, Nanoseconds
from validation.rars.plant import P
from validation.rars.steering import KD, KI, KP, QUIET, _Model, response
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

STEP_M: Final = 0.020
CYCLES_MS: Final = (1, 5, 10, 20, 50)
"""Slower ones for comparison; the last is the bridge's own, [R] 4.2."""
HEARTBEAT: Final[Nanoseconds] = 50 * MILLISECOND
STARTED: Final[Nanoseconds] = SECOND
"""Longest time from power-on to the step."""
SAMPLE_S: Final = 0.001
LARGEST: Final = 0x7FFF
"""0x2030 is a whole number of 16 bits, in mA."""
PRINTED_SETTLED_S: Final = 0.8
BAND: Final = 0.02
"""Share of the step within which the rack has settled, assumed."""
LIMITED_MA: Final = (200, 300)
"""Continuous and peak current below what the step takes, assumed."""
BEGINS: Final = slice(2, 50)
"""Samples in which the current is large, and 1 mA of rounding small."""
LEAVES: Final = 0.5
"""Of its error the current loop leaves this share in each of its cycles, by the robot file's gains."""
OUTPUTS: Final = ("rack", "current_steer")
COMMAND: Final = Layout((od.CONTROLWORD, DataType.UNSIGNED16), (at.CURRENT_MODE_SETTING, DataType.INTEGER16))
WHY: Final = "the current loop's 4 % and a delay of 2 ms act against each other, see the remarks"
SETTLES: Final = "print has 0.8 s, 3.5.2: its gains do not give it, they make it pass the aim by a quarter"
SIGN: Final = "the friction's sign is that of a speed in counts, a ms old"
RATE: Final = (
    "Every ms (assumed: the source gives no rate) the master sends SYNC. The drive answers it with position "
    "(0x6064) and speed (0x606C), the master answers these with the current (0x2030)."
)
LAGS: Final = (
    "While the motor accelerates, the back-EMF rises, and the drive's current stays 4 % below its set value: "
    "the gains act as if 4 % smaller. A delay acts, to first order, as if larger by the share Kd times it: "
    "counts are up to 1 ms old at the SYNC, and the current flows 1 ms after it."
)
WIRED: Final = "The drive's gains and limits are the robot file's; it watches the master's heartbeat."
STATUS: Final = Layout((od.STATUSWORD, DataType.UNSIGNED16))
MOTION: Final = Layout((od.POSITION_ACTUAL, DataType.INTEGER32), (od.VELOCITY_ACTUAL, DataType.INTEGER32))
LAYOUTS: Final = {
    cia301.RECEIVE_PDO[0]: COMMAND,
    cia301.TRANSMIT_PDO[0]: STATUS,
    cia301.TRANSMIT_PDO[1]: MOTION,
}
"""By the identifiers without the node's number; the second to SYNC, the first on change."""


@dataclass(frozen=True, slots=True)
class Case:
    """One step on the bench."""

    seconds: float
    dry: bool = False
    """True for friction of tyres and motor."""
    compensated: bool = False
    """True if the regulator adds it."""
    cycle_ms: int = 1
    """The regulator's, assumed: the source gives no rate."""
    limits_ma: tuple[int, int] | None = None
    """Continuous and peak current in the drive; None: the robot file's."""


class Run(NamedTuple):
    """What a step has shown, every ms from the SYNC on at which it was commanded."""

    times: Floats
    """s."""
    rack: Floats
    """Over the step."""
    current: Floats
    """A, in the winding."""
    demand: Floats
    """A, behind the drive's limits."""
    commanded: float
    """A, the largest that the master has set."""


class Regulator:
    """(3.99) to (3.101): rack in m and its speed in m/s to current in mA."""

    def __init__(self, aim: float, cycle: Nanoseconds, *, compensated: bool) -> None:
        self._aim, self._cycle, self._compensated = aim, cycle / SECOND, compensated
        self._model, self._integral = _Model(), 0.0
        self.largest = 0
        """mA, so far."""

    def current(self, rack: float, speed: float) -> int:
        """Return the current of this cycle."""
        model, error = self._model, rack - self._aim
        self._integral += error * self._cycle
        wanted = -KD * speed - KP * error - KI * self._integral
        force = model.mass(rack) * wanted + model.convection(rack) * speed**2
        if self._compensated:
            force += math.copysign(model.dry(rack), speed if abs(speed) > model.CREEPS else wanted)
        set_ma = round(1000.0 * force * model.ratio / P["torque_constant_steer"])
        self.largest = max(self.largest, abs(set_ma))
        return max(-LARGEST, min(LARGEST, set_ma))


class Master:
    """The bridge's place on the bus: sets one drive up, enables it, and regulates from then on."""

    def __init__(self, axis: Axis, table: Epos2Link, regulator: Regulator, cycle: Nanoseconds) -> None:
        settings = Epos2Axis.of(axis)
        self._node, self._own = settings.node, table.bridge_node
        self._regulator, self._cycle = regulator, cycle
        self._client, self._rows = NodeClient(CAN, self._node), list(_rows(axis, table))
        self._next = self._next_heartbeat = self._synchronized = 0
        self._state: PowerState | None = None
        # The rack's way is that of the pinion's rim, behind the gear.
        self._per_radian: Final = P["pinion_diameter"] / (2.0 * axis.ratio)
        self._per_count: Final = math.tau * self._per_radian / (QUADCOUNTS_PER_LINE * settings.encoder_lines)
        self.begun: Nanoseconds | None = None
        """Instant of the SYNC whose position the regulator has had first."""
        self._takes: Final = {
            cia301.ERROR_CONTROL + self._node: self._booted,
            cia301.SDO_RESPONSE + self._node: self._answered,
            cia301.TRANSMIT_PDO[0] + self._node: self._reported,
            cia301.TRANSMIT_PDO[1] + self._node: self._moved,
        }

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take a frame of the drive; those of others are none of this master's."""
        take = self._takes.get(packet.address)
        return Reaction(() if take is None else take(packet.payload, now), self._next)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send SYNC, and the heartbeat without which the drive stops."""
        sent = [Packet(CAN, cia301.SYNC, b"")]
        self._synchronized, self._next = now, now + self._cycle
        if now >= self._next_heartbeat:
            self._next_heartbeat = now + HEARTBEAT
            alive = cia301.encode_heartbeat(cia301.NmtState.OPERATIONAL)
            sent.append(Packet(CAN, cia301.ERROR_CONTROL + self._own, alive))
        return Reaction(tuple(sent), self._next)

    def _booted(self, payload: bytes, now: Nanoseconds) -> tuple[Packet, ...]:
        boots = cia301.decode_heartbeat(payload) is cia301.NmtState.BOOT_UP
        return self._write(now) if boots else ()

    def _answered(self, payload: bytes, now: Nanoseconds) -> tuple[Packet, ...]:
        more = self._client.receive(payload, now)
        outcome = self._client.take()
        if isinstance(outcome, SdoError):
            raise outcome
        return more if outcome is None else self._write(now)

    def _write(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Write the next object; behind the last start the node, and with it its process data."""
        if not self._rows:
            return (Packet(CAN, cia301.NMT, cia301.encode_nmt(cia301.NmtCommand.START, self._node)),)
        row = self._rows.pop(0)
        return self._client.start(Transfer(row.address, row.raw), now)

    def _reported(self, payload: bytes, _now: Nanoseconds) -> tuple[Packet, ...]:
        self._state = STATES.state_of(STATUS.unpack(payload)[0])
        return ()

    def _moved(self, payload: bytes, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Answer position and speed by controlword and current."""
        counts, rpm = MOTION.unpack(payload)
        command, current = towards(self._state, PowerState.OPERATION_ENABLED), 0
        if self._state is PowerState.OPERATION_ENABLED:
            if self.begun is None:
                self.begun = self._synchronized
            command = ControlwordCommand.ENABLE_OPERATION
            speed = self._per_radian * rpm / RPM_PER_RAD_S
            current = self._regulator.current(self._per_count * counts, speed)
        word = 0 if command is None else word_of(command)
        return (Packet(CAN, cia301.RECEIVE_PDO[0] + self._node, COMMAND.pack(word, current)),)


def _rows(axis: Axis, table: Epos2Link) -> tuple[SetupObject, ...]:
    """Return the drive's set-up: motor, limits and gains of the robot file, process data, current mode."""
    flows = tuple(replace(pdo, layout=LAYOUTS.get(pdo.cob_id)) for pdo in pdos(axis, at.CURRENT_AVERAGED))
    why = "the master regulates the motion"
    return (
        *configuration(axis, table, (), Traffic(flows, table.bridge_node, table.drive_heartbeat_ms)),
        SetupObject(od.MODE, DataType.INTEGER8, Mode.CURRENT, "mode of operation", why),
        SetupObject(at.CURRENT_MODE_SETTING, DataType.INTEGER16, 0, "current", "no torque before the step"),
    )


def _robot(case: Case) -> tuple[AnyRobot, Axis]:
    """Return RARS with the plant's parameters and the drive's limits of a case, and its steering axis."""
    robot = find("rars")
    parameters = robot.plant.parameters | ({} if case.dry else QUIET)
    plant = robot.plant.model_copy(update={"parameters": parameters})
    axis = robot.axis("steering")
    if case.limits_ma is not None:
        limits = dict(zip(("continuous_current_ma", "peak_current_ma"), case.limits_ma, strict=True))
        axis = axis.model_copy(update={"settings": axis.settings.model_copy(update=limits)})
    return robot.model_copy(update={"plant": plant}), axis


@cache
def driven(case: Case) -> Run:
    """Let the master drive the step of a case; TimeoutError where the drive is not enabled."""
    robot, axis = _robot(case)
    table, cycle = Epos2Link.of_link(robot, axis.link), case.cycle_ms * MILLISECOND
    regulator = Regulator(STEP_M, cycle, compensated=case.compensated)
    master = Master(axis, table, regulator, cycle)
    below = devices(robot, outputs=OUTPUTS, on_bench=True)
    wire, world = FaultyCanWire(table.bit_rate), World(below.physics)
    for name, station in below.stations.items():
        world.attach(name, station.node, {CAN: wire})
    world.attach("master", master, {CAN: wire})
    motor, found = below.motors(ServoAxis)[axis.name], [(0.0, 0.0, 0.0)]
    names = (*below.plant.output_names, *below.plant.shown_names)
    rack, winding = (names.index(name) for name in OUTPUTS)
    try:
        while master.begun is None:
            if world.now >= STARTED:
                raise TimeoutError(f"the drive is not enabled {STARTED / SECOND:g} s after power-on")
            world.run(world.now + MILLISECOND)
        for now in range(world.now, master.begun + round(case.seconds * SECOND), MILLISECOND):
            world.run(now)
            outputs = (*below.plant.outputs[:], *below.plant.look())
            found.append((outputs[rack] / STEP_M, outputs[winding], motor.current_demand_ma / 1000.0))
    finally:
        below.plant.close()
    shares, current, demand = np.array(found, dtype=np.float64).T
    times: Floats = SAMPLE_S * np.arange(len(found), dtype=np.float64)
    return Run(times, shares, current, demand, regulator.largest / 1000.0)


def computed_torque(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    seconds = 3.0 if quick else 6.0
    cases = {
        "without friction": Case(seconds),
        "friction not in the model": Case(seconds, dry=True),
        "friction compensated": Case(seconds, dry=True, compensated=True),
        "limits below the step's current": Case(seconds, limits_ma=LIMITED_MA),
    }
    bare, rough, smooth, limited = (driven(case) for case in cases.values())
    closed = response(1.0, bare.times)
    slower = {each: driven(Case(seconds, cycle_ms=each)) for each in CYCLES_MS}
    return Findings(
        compared=(*_of_step(closed, bare), *_of_friction(closed, smooth), *_of_currents(bare)),
        plots=(_racks(closed, bare, rough, smooth), _currents(bare, smooth, limited)),
        sheets=(
            Sheet(
                "Largest currents of the step, and the drive's limits",
                ("case", "continuous [A]", "peak [A]", "set [A]", "behind the limits [A]", "winding [A]"),
                tuple((name, *_sizes(case)) for name, case in cases.items()),
            ),
            Sheet(
                "The same regulator in slower cycles",
                ("cycle [ms]", "overshoot [%]", "within 2 % after [s]", "from closed form [% of the step]"),
                tuple(
                    (float(each), overshoot(run.rack), settled(run.times, run.rack), apart(run.rack, closed))
                    for each, run in slower.items()
                ),
            ),
        ),
        remarks=(RATE, LAGS, WIRED),
    )


def settled(times: Floats, rack: Floats) -> float:
    """Return from when on a rack, over the step, stays within the band, s."""
    return float(times[np.flatnonzero(np.abs(rack - 1.0) > BAND)[-1]]) + SAMPLE_S


def overshoot(rack: Floats) -> float:
    """Return by how much a rack passes its aim, % of the step."""
    return 100.0 * (float(rack.max()) - 1.0)


def apart(rack: Floats, closed: Floats) -> float:
    """Return the largest distance of two racks, % of the step."""
    return 100.0 * float(np.abs(rack - closed).max())


def share_that_flows() -> float:
    """Return the winding's current over its set value while the motor accelerates by it.

    The back-EMF rises with the speed, and the loop's integral term alone makes up for it: by the share of the
    error that it removes, times the resistance, in each cycle. So the error is the rise of a cycle over that.
    """
    rise = P["torque_constant_steer"] ** 2 * TICK / SECOND / (_Model().mass(0.0) * _Model().ratio ** 2)
    return 1.0 / (1.0 + rise / ((1.0 - LEAVES) * P["resistance_steer"]))


def largest_current() -> float:
    """Return what (3.99) to (3.101) take at the begin of the step, A: the rack rests, the error is whole."""
    return _Model().mass(0.0) * KP * STEP_M * _Model().ratio / P["torque_constant_steer"]


def _of_step(closed: Floats, bare: Run) -> tuple[Compared, ...]:
    times, rack, place = bare.times, bare.rack, round(PRINTED_SETTLED_S / SAMPLE_S)
    mm, until = 1e3 * STEP_M, settled(times, closed)
    expected = (mm * closed[place], overshoot(closed), times[closed.argmax()], 0.0)
    ours = (mm * rack[place], overshoot(rack), times[rack.argmax()], apart(rack, closed))
    rows = (
        ("rack 0.8 s after a step of 20 mm", "mm", 0.06),
        ("overshoot", "%", 0.2),
        ("time of the overshoot", "s", 0.01),
        ("largest distance from the closed form", "% of the step", 0.5),
    )
    return (
        *(
            Compared(name, unit, None, float(one), float(other), within, WHY)
            for (name, unit, within), one, other in zip(rows, expected, ours, strict=True)
        ),
        Compared("time until within 2 %", "s", PRINTED_SETTLED_S, until, settled(times, rack), 0.01, SETTLES),
    )


def _of_friction(closed: Floats, smooth: Run) -> tuple[Compared, ...]:
    over, own, beside = overshoot(closed), overshoot(smooth.rack), apart(smooth.rack, closed)
    return (
        Compared("overshoot, friction compensated", "%", None, over, own, 0.5, SIGN),
        Compared("largest distance likewise", "% of the step", None, 0.0, beside, 0.8, SIGN),
    )


def _of_currents(bare: Run) -> tuple[Compared, ...]:
    share, flows = share_that_flows(), float(np.median(bare.current[BEGINS] / bare.demand[BEGINS]))
    largest, begun, rounded = largest_current(), "the integral term begins first", "rounding to 1 mA"
    return (
        Compared("largest current that the master sets", "A", None, largest, bare.commanded, 0.005, begun),
        Compared("winding's current over set value", "%", None, 100.0 * share, 100.0 * flows, 0.5, rounded),
    )


def _racks(closed: Floats, bare: Run, rough: Run, smooth: Run) -> Plot:
    few, fewer, times = slice(None, None, 20), slice(None, None, 100), bare.times[::20]
    return Plot(
        "Rack after a step of 20 mm, through the drive in current mode",
        "time [s]",
        "rack over the step [1]",
        (
            Curve("(3.102) corrected", times, closed[few]),
            Curve("on the bench, without friction", bare.times[fewer], bare.rack[fewer], "points"),
            Curve("with friction that the regulator does not know", times, rough.rack[few], "dots"),
            Curve("with friction, compensated", times, smooth.rack[few], "dashed"),
        ),
        "Computed torque (3.99) to (3.101), Kd = 20, Kp = 60, Ki = 100, every ms; as Fig. 3.23 and 3.24.",
    )


def _currents(bare: Run, smooth: Run, limited: Run) -> Plot:
    first, times = slice(0, 1000, 2), bare.times[:1000:2]
    return Plot(
        "Current in the winding, in the first second",
        "time [s]",
        "current [A]",
        (
            Curve("without friction", times, bare.current[first]),
            Curve("with friction, compensated", times, smooth.current[first], "dashed"),
            Curve("drive limited to 0.3 A", times, limited.current[first], "dots"),
        ),
        "The drive's own limits are 1.2 A continuously and 3 A at the peak.",
    )


def _sizes(case: Case) -> tuple[float, ...]:
    """Return the drive's limits, and the largest current set, allowed and in the winding, A."""
    drive, run = Epos2Axis.of(_robot(case)[1]), driven(case)
    limits = (drive.continuous_current_ma / 1000.0, drive.peak_current_ma / 1000.0)
    return (*limits, run.commanded, float(np.abs(run.demand).max()), float(np.abs(run.current).max()))
