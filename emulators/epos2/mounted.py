"""Equipment of a single drive: motor, encoder, gear and load; and a check of the client's settings for it.

A real drive cannot know its equipment, and neither does the emulated one: with other settings it counts,
commutates and supervises by those. Assumed: a brushed motor at a drive that is set up for hall sensors shows
none of them; a motor with three phases at one that is set up for a brushed motor gives no torque.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple, Self

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.control.sensing import BRUSHLESS, WITH_INDEX
from emulators.motors import Motor, MotorType
from emulators.servo.axis import ServoAxis
from emulators.servo.motor import MOTOR, DcMotor
from emulators.servo.sensors import HALL_LINES, HALL_LOW, INDEX_MISSING
from emulators.servo.winding import set_winding
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import ControlwordCommand, command_of
from firmware_bridge.canopen_drive.settings import BRUSHED
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.units import QUADCOUNTS_PER_LINE

POLE_PAIRS: Final = Address(0x6410, 3)
PULSES: Final = 500
"""Pulses of an encoder in one turn: the default of 0x2210:1."""
NO_TORQUE: Final = 1e-9
"""The constant of a motor that turns no current into torque, N m/A: 0 would divide."""
UNKNOWN: Final = f"no particular motor ({MOTOR.torque_constant:g} N m/A, {MOTOR.resistance:g} Ohm)"


class Named(NamedTuple):
    """Where a user gives what is mounted: options, or keys of a robot file."""

    encoder: str = "--encoder"
    motor: str = "--motor"
    pole_pairs: str = "--pole-pairs"


OPTIONS: Final = Named()
KEYS: Final = Named("encoder_lines", "motor_type", "pole_pairs")


class ShaftLoad(NamedTuple):
    """Load on the shaft: kg m2 and N m."""

    inertia_kg_m2: float
    friction_nm: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Mounted:
    """Equipment of one drive."""

    motor: Motor | None = None
    """The motor; None: no particular one, or one whose data the plant has."""
    type: MotorType | None = None
    """Whether it is brushed; None: as the motor, and without one every motor type is right."""
    pulses: int = PULSES
    """Pulses of the encoder at the motor's shaft, in one turn."""
    index: bool = True
    """True if the encoder has a third channel."""
    pole_pairs: int | None = None
    """Number of pole pairs; None: the motor's own."""
    gear: float = 1.0
    """Turns of the motor for one of the load."""
    gear_inertia: float = 0.0
    """Inertia of the gear at the motor's shaft, kg m2."""
    named: Named = OPTIONS
    load: ShaftLoad | None = None
    """Load at the output of the gear; without a motor at its shaft, the rotor's own included."""

    @classmethod
    def of(cls, settings: Epos2Axis) -> Self:
        """Return what a robot file has at a drive; the plant has the data of its motor, gear and load."""
        return cls(
            type="dc" if settings.motor_type == BRUSHED else "ec",
            pulses=settings.encoder_lines,
            pole_pairs=settings.pole_pairs,
            named=KEYS,
        )

    @property
    def kind(self) -> MotorType | None:
        """Whether the motor is brushed; None: unknown."""
        return self.type if self.motor is None else self.motor.kind

    @property
    def counts(self) -> int:
        """Counts of the encoder in one turn: edges of both channels."""
        return QUADCOUNTS_PER_LINE * self.pulses

    @property
    def pairs(self) -> int:
        """The motor's pole pairs; 0 where they are unknown."""
        own = None if self.motor is None else self.motor.pole_pairs
        return self.pole_pairs or own or 0

    @property
    def shaft(self) -> DcMotor:
        """The motor with all that hangs on it, seen at its shaft."""
        motor, load = self.motor, self.load
        if motor is None:
            load = load or ShaftLoad(MOTOR.inertia, MOTOR.friction)
            return DcMotor(
                MOTOR.resistance,
                MOTOR.inductance,
                MOTOR.torque_constant,
                self.gear_inertia + load.inertia_kg_m2 / self.gear**2,
                load.friction_nm / self.gear,
                MOTOR.damping,
            )
        # At the motor's shaft a load's inertia counts by the square of the ratio, its friction by the ratio.
        load = load or ShaftLoad(0.0, 0.0)
        return DcMotor(
            motor.resistance_ohm,
            motor.inductance_h,
            motor.torque_constant_nm_a,
            motor.rotor_inertia_kg_m2 + self.gear_inertia + load.inertia_kg_m2 / self.gear**2,
            motor.friction + load.friction_nm / self.gear,
        )

    @property
    def text(self) -> str:
        """The equipment as text."""
        kinds = {"dc": "brushed", "ec": "EC, as its DC equivalent"}
        motor = UNKNOWN if self.motor is None else f"{self.motor.title} ({kinds[self.motor.kind]})"
        pairs = f", {self.pairs} pole pairs" if self.pairs > 1 else ""
        index = "with" if self.index else "without"
        gear = f", gear {self.gear:g}:1" if self.gear != 1.0 else ""
        return f"{motor}{pairs}, encoder with {self.pulses} pulses {index} index{gear}"

    def mount(self, axis: ServoAxis) -> None:
        """Put all of it at an axis that was made for this encoder."""
        if not self.index:
            axis.sensor_faults |= INDEX_MISSING
        if self.kind == "dc":
            # A brushed motor has no hall sensors: its three lines
            # show one level, which the drive takes for a fault.
            axis.sensor_faults |= HALL_LINES << HALL_LOW
        else:
            axis.mounted_pole_pairs = self.pairs

    def contradicts(self, get: Callable[[Address], int]) -> Iterator[str]:
        """Yield what a client has set up otherwise than it is mounted; `get` reads an object."""
        pulses, sensor, kind = get(at.ENCODER_PULSES), get(at.SENSOR_TYPE), get(od.MOTOR_TYPE)
        if pulses != self.pulses:
            yield f"0x2210:1 is {pulses} pulses, the mounted encoder has {self.pulses} ({self.named.encoder})"
        if sensor in WITH_INDEX and not self.index:
            yield f"0x2210:2 is {sensor}, with index; the mounted encoder has none ({self.named.encoder})"
        if self.kind is None:
            return
        brushless = kind in BRUSHLESS
        if brushless != (self.kind == "ec"):
            mounted = "an EC motor is mounted" if self.kind == "ec" else "a brushed motor is mounted"
            yield f"0x6402 is motor type {kind}, {mounted} ({self.named.motor})"
        elif brushless and self.pairs and get(POLE_PAIRS) != self.pairs:
            given, where = get(POLE_PAIRS), self.named.pole_pairs
            yield f"0x6410:3 is {given} pole pairs, the mounted motor has {self.pairs} ({where})"


class Comparison:
    """Comparison of the settings with the mounted equipment, reported when the drive is enabled."""

    def __init__(self, mounted: Mounted, store: ObjectStore, say: Callable[[str], None]) -> None:
        """Look at each controlword that a client sends."""
        self._mounted = mounted
        self._store = store
        self._say = say
        self._reported: tuple[str, ...] = ()
        store.on_write(od.CONTROLWORD, self._look)

    def _look(self, word: int) -> None:
        # Not before: settings may be written one after the other until the drive is enabled.
        if command_of(word) is ControlwordCommand.ENABLE_OPERATION:
            found = tuple(self._mounted.contradicts(self._store.get))
            if found and found != self._reported:
                self._say("; ".join(found))
            self._reported = found


class Torque:
    """Removal of an EC motor's torque while the drive is set up for a brushed one."""

    def __init__(
        self, mounted: Mounted, store: ObjectStore, axis: ServoAxis, becomes: Callable[[DcMotor], None]
    ) -> None:
        """`becomes` puts another motor in the place of the present one."""
        self._mounted = mounted
        self._axis = axis
        self._becomes = becomes
        if mounted.motor is not None and mounted.kind == "ec":
            store.on_write(od.MOTOR_TYPE, self._take)
            self._take(store.get(od.MOTOR_TYPE))

    def _take(self, kind: int) -> None:
        shaft = self._mounted.shaft
        if kind not in BRUSHLESS:
            shaft = DcMotor(shaft.resistance, shaft.inductance, NO_TORQUE, shaft.inertia, shaft.friction)
        # Also for the open winding, whose voltage follows from these data.
        set_winding(self._axis, shaft.torque_constant, shaft.resistance, shaft.inductance)
        self._becomes(shaft)
