"""Set-up of one EPOS2 before it may move: rows of (object, value, why, source) from the robot file.

It knows no time and no answers; `firmware_bridge.families.epos2.driver.tasks` carries the rows to the drive.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.families.epos2.driver.process_data import Pdo, pdos
from firmware_bridge.families.epos2.driver.scale import Travel, travel_of
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2DigitalOutput, Epos2Link
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.functions import OUTPUT_MASK, OUTPUT_PINS, OutputFunction
from firmware_bridge.families.epos2.wire.hardware import alike
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.families.epos2.wire.rows import APPLICATION_NOTES, CIA_301, EDS, FIRMWARE_SPECIFICATION
from firmware_bridge.robot import Axis, CommandForm, Output

U8: Final = DataType.UNSIGNED8
U16: Final = DataType.UNSIGNED16
U32: Final = DataType.UNSIGNED32
I8: Final = DataType.INTEGER8
I16: Final = DataType.INTEGER16
I32: Final = DataType.INTEGER32

SERVO_DRIVE: Final = 0x0002_0192
MAXON: Final = 0xFB
QUICK_STOP_ON_LOST_CONNECTION: Final = 3
QUICK_STOP_ON_FAULT: Final = 2
TRAPEZOID: Final = 0
INHIBIT_UNITS_PER_MS: Final = 10
"""Of 100 us each."""
MODE: Final = {
    CommandForm.SPEED: Mode.PROFILE_VELOCITY,
    CommandForm.POSITION: Mode.PROFILE_POSITION,
}
_MAPPING_SOURCE: Final = f"{FIRMWARE_SPECIFICATION}; {CIA_301}"


@dataclass(frozen=True, slots=True)
class SetupObject:
    """One object: the value that it must have, or is given, and why."""

    address: Address
    type: DataType
    value: int
    name: str
    why: str
    source: str = EDS
    read_back: bool = False
    """Safety hangs on this value: it is read again after it was written."""
    also: frozenset[int] = frozenset()
    """Values that are as good."""

    def has(self, raw: bytes) -> bool:
        """Return whether this is the value, or as good."""
        return raw == self.raw or raw in {self.type.encode(value) for value in self.also}

    @property
    def raw(self) -> bytes:
        """The value as it stands on the wire."""
        return self.type.encode(self.value)

    @property
    def expected(self) -> str:
        """The name and the value for people, unsigned 32-bit values in hexadecimal as in the manuals."""
        return f"{self.name} {self.show(self.raw)}"

    def show(self, raw: bytes) -> str:
        """Write what came for this object."""
        if len(raw) != self.type.size:
            return f"{len(raw)} bytes {raw.hex(' ')}"
        value = self.type.decode(raw)
        return f"0x{value:08X}" if self.type is U32 else str(value)


class Traffic(NamedTuple):
    """Traffic between bridge and drive beside reading and writing objects."""

    pdos: tuple[Pdo, ...]
    watched: int
    """The node whose silence stops the drive."""
    heartbeat_ms: int
    """Period of the drive's heartbeat in ms; 0: none."""


def general_purpose(pin: int) -> OutputFunction:
    """Return the function of an output pin, from 1, that the bridge switches: A at the first (EDS)."""
    # The functions count down: A is 15, B is 14.
    return OutputFunction(OutputFunction.GENERAL_A + 1 - pin)


def over_can(axis: Axis, link: Epos2Link) -> Traffic:
    """Return what flows where the bridge is on the CAN bus."""
    return Traffic(pdos(axis), link.bridge_node, link.drive_heartbeat_ms)


def through_gateway(axis: Axis, link: Epos2Link, nodes: Sequence[int]) -> Traffic:
    """Return the traffic where the bridge is on the gateway's serial port: no process data, no heartbeat.

    No node there would receive either; and a drive with a heartbeat of its own does not answer node guarding,
    which the gateway's watchdog depends on.
    """
    off = tuple(replace(pdo, layout=None) for pdo in pdos(axis))
    return Traffic(off, link.watched_by(Epos2Axis.of(axis).node, nodes), 0)


def identity(axis: Axis) -> tuple[SetupObject, ...]:
    """Return what the drive must answer before anything is written to it."""
    return (
        SetupObject(od.DEVICE_TYPE, U32, SERVO_DRIVE, "device type", "a CiA 402 servo drive answers"),
        SetupObject(od.VENDOR_ID, U32, MAXON, "vendor", "the objects below are maxon's"),
        SetupObject(
            od.PRODUCT_CODE,
            U32,
            Epos2Axis.of(axis).product_code,
            "product code",
            "the drive that the robot file names",
            also=alike(Epos2Axis.of(axis).product_code),
        ),
    )


def configuration(
    axis: Axis, link: Epos2Link, outputs: Sequence[Output] = (), traffic: Traffic | None = None
) -> tuple[SetupObject, ...]:
    """Return what is written in pre-operational, with the power stage off, in this order.

    An axis without `travel` leaves the drive's position limits alone. `outputs` are those at this drive.
    `traffic` is what flows on the link, without it what flows on CAN.
    """
    flows = traffic or over_can(axis, link)
    return (
        *(row for pdo in flows.pdos for row in _process_data(pdo, Epos2Axis.of(axis).node)),
        *_supervision(link, flows),
        *commissioned(axis),
        *_switched(outputs),
    )


def commissioned(axis: Axis) -> tuple[SetupObject, ...]:
    """Return what belongs to motor and mechanics: what who commissions the axis saves in its drive, too."""
    travel = travel_of(axis)
    return (
        *_protection(axis),
        *(() if travel is None else _range(travel, Epos2Axis.of(axis).profile.max_following_error_qc)),
        *_motion(axis),
        *_gains(axis),
    )


def farewell() -> tuple[SetupObject, ...]:
    """Return what is written before the bridge leaves for good."""
    return (
        SetupObject(
            od.CONSUMER_HEARTBEAT_1, U32, 0, "heartbeat consumer", "the bridge's silence is no fault now"
        ),
    )


def _process_data(pdo: Pdo, node: int) -> Iterator[SetupObject]:
    """Give the procedure of a mapping: invalid, empty, entries, how many, how sent, valid."""
    title = f"PDO 0x{pdo.communication:04X}"
    cob_id = Address(pdo.communication, 1)
    count = Address(pdo.mapping, 0)
    off = pdo.cob_id_entry(node, valid=False)
    on = pdo.cob_id_entry(node, valid=True)
    if pdo.layout is None:
        yield SetupObject(cob_id, U32, off, f"{title} COB-ID", "not used", read_back=True)
        return
    yield SetupObject(
        cob_id, U32, off, f"{title} COB-ID", "a mapping changes only while it is off", _MAPPING_SOURCE
    )
    yield SetupObject(
        count, U8, 0, f"{title} entries", "a mapping changes only while it is empty", _MAPPING_SOURCE
    )
    entries = pdo.layout.entries()
    for number, entry in enumerate(entries, 1):
        where = Address(pdo.mapping, number)
        yield SetupObject(where, U32, entry.encode(), f"{title} entry {number}", f"carries {entry.address}")
    yield SetupObject(count, U8, len(entries), f"{title} entries", "the drive checks length and objects now")
    kind = Address(pdo.communication, 2)
    yield SetupObject(kind, U8, pdo.transmission, f"{title} type", "1 with each SYNC, 255 on change")
    if pdo.transmits:
        inhibit = Address(pdo.communication, 3)
        why = "what is sent on change must not fill the bus; unit 100 us"
        units = INHIBIT_UNITS_PER_MS * pdo.inhibit_ms
        yield SetupObject(inhibit, U16, units, f"{title} inhibit time", why)
    yield SetupObject(cob_id, U32, on, f"{title} COB-ID", "on", _MAPPING_SOURCE, read_back=True)


def _supervision(link: Epos2Link, flows: Traffic) -> Iterator[SetupObject]:
    # 0x1016: the node in bits 16 to 23, the consumer time in ms below (CiA 301).
    watch = flows.watched << 16 | link.bridge_silent_ms
    why = "the bridge sees that the drive lives; without, it answers node guarding"
    yield SetupObject(
        od.PRODUCER_HEARTBEAT, U16, flows.heartbeat_ms, "heartbeat producer", why, APPLICATION_NOTES
    )
    why = "a dead bridge stops the drive"
    yield SetupObject(
        od.CONSUMER_HEARTBEAT_1, U32, watch, "heartbeat consumer", why, APPLICATION_NOTES, read_back=True
    )
    why = "a dead bridge means a quick stop, not a coasting motor"
    reaction = QUICK_STOP_ON_LOST_CONNECTION
    yield SetupObject(
        od.ABORT_CONNECTION_OPTION, I16, reaction, "abort connection option", why, read_back=True
    )
    why = "a fault ends in a quick stop"
    yield SetupObject(
        od.FAULT_REACTION_OPTION, I16, QUICK_STOP_ON_FAULT, "fault reaction option", why, read_back=True
    )


def _protection(axis: Axis) -> Iterator[SetupObject]:
    motor, profile = Epos2Axis.of(axis), Epos2Axis.of(axis).profile
    protects = "protects the motor and people near it"
    yield SetupObject(
        od.MOTOR_TYPE, U16, motor.motor_type, "motor type", "how the winding is driven", read_back=True
    )
    if motor.pole_pairs is not None:
        why = "the winding is commutated by them"
        yield SetupObject(at.POLE_PAIRS, U8, motor.pole_pairs, "pole pairs", why, read_back=True)
    for address, kind, value, name, why in (
        (at.ENCODER_PULSES, U32, motor.encoder_lines, "encoder lines", "every position is counted in them"),
        (at.CONTINUOUS_CURRENT_LIMIT, U16, motor.continuous_current_ma, "continuous current limit", protects),
        (at.OUTPUT_CURRENT_LIMIT, U16, motor.peak_current_ma, "output current limit", protects),
        (at.THERMAL_TIME_CONSTANT, U16, motor.thermal_time_constant_100ms, "thermal time constant", protects),
        (at.MAX_MOTOR_SPEED, U32, profile.max_velocity_rpm, "motor speed limit", protects),
        (od.MAX_PROFILE_VELOCITY, U32, profile.max_velocity_rpm, "profile velocity limit", protects),
        (od.MAX_FOLLOWING_ERROR, U32, profile.max_following_error_qc, "following error limit", protects),
    ):
        yield SetupObject(address, kind, value, name, why, read_back=True)


def _range(travel: Travel, margin_qc: int) -> Iterator[SetupObject]:
    # The drive judges the actual position, too: without the margin an overshoot at the end would be a fault.
    why = "no target beyond the mechanics; the margin is the following error, within which all is well"
    low, high = travel.low_qc - margin_qc, travel.high_qc + margin_qc
    yield SetupObject(od.MIN_POSITION_LIMIT, I32, low, "lower position limit", why, read_back=True)
    yield SetupObject(od.MAX_POSITION_LIMIT, I32, high, "upper position limit", why, read_back=True)


def _motion(axis: Axis) -> Iterator[SetupObject]:
    profile, mode = Epos2Axis.of(axis).profile, MODE[axis.command]
    yield SetupObject(od.MODE, I8, mode, "mode of operation", "by the robot file", read_back=True)
    why = "a trapezoid: its acceleration is bounded"
    yield SetupObject(od.MOTION_PROFILE_TYPE, I16, TRAPEZOID, "motion profile type", why)
    for address, value, name in (
        (od.PROFILE_VELOCITY, profile.velocity_rpm, "profile velocity"),
        (od.PROFILE_ACCELERATION, profile.acceleration_rpm_s, "profile acceleration"),
        (od.PROFILE_DECELERATION, profile.deceleration_rpm_s, "profile deceleration"),
        (od.QUICK_STOP_DECELERATION, profile.quick_stop_rpm_s, "quick stop deceleration"),
    ):
        yield SetupObject(address, U32, value, name, "how the axis starts and stops", read_back=True)


def _gains(axis: Axis) -> Iterator[SetupObject]:
    gains = Epos2Axis.of(axis).gains
    for address, kind, value, name in (
        (at.CURRENT_P, I16, gains.current_p, "current P gain"),
        (at.CURRENT_I, I16, gains.current_i, "current I gain"),
        (at.VELOCITY_P, I16, gains.velocity_p, "velocity P gain"),
        (at.VELOCITY_I, I16, gains.velocity_i, "velocity I gain"),
        (at.VELOCITY_FEEDFORWARD, U16, gains.velocity_feedforward, "velocity feed-forward"),
        (at.VELOCITY_ACCELERATION_FEEDFORWARD, U16, gains.acceleration_feedforward, "its acceleration part"),
        (at.POSITION_P, I16, gains.position_p, "position P gain"),
        (at.POSITION_I, I16, gains.position_i, "position I gain"),
        (at.POSITION_D, I16, gains.position_d, "position D gain"),
        (
            at.POSITION_VELOCITY_FEEDFORWARD,
            U16,
            gains.position_velocity_feedforward,
            "position feed-forward",
        ),
        (
            at.POSITION_ACCELERATION_FEEDFORWARD,
            U16,
            gains.position_acceleration_feedforward,
            "position feed-forward of acceleration",
        ),
    ):
        yield SetupObject(address, kind, value, name, "the regulators as tuned for this axis")


def _switched(outputs: Sequence[Output]) -> Iterator[SetupObject]:
    """Give pins to the bridge; their polarity stays as the wiring needs it, their state is not touched."""
    if not outputs:
        return
    mask = 0
    for output in outputs:
        pin = Epos2DigitalOutput.of(output).output
        function = general_purpose(pin)
        mask |= function.bit
        why = f"switched by the bridge: {output.title}"
        yield SetupObject(OUTPUT_PINS[pin - 1], U16, function, f"digital output {pin}", why, read_back=True)
    why = "lets the bridge's outputs through, and no others"
    yield SetupObject(
        OUTPUT_MASK, U16, mask, "digital outputs' mask", why, FIRMWARE_SPECIFICATION, read_back=True
    )
