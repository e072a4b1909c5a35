"""The motors on the shield's terminals and their encoders: volts out, shafts' angles back as counts.

The plant moves in ticks of 100 us. A motor that conducts gets the mean voltage of its PWM period, less what
the half bridge drops at the current of the tick before. While nothing is broken and the plant is an FMU, the
ticks are run by `emulators.servo.terminals`, to the same bits. They are run when a value is read, or before
the shield receives another command.

Sources: TB6612FNG data sheet for what conducts; community figures of the interrupts' load, about 100 kHz.
Where they are silent:
* encoders have 12 lines on the motor's shaft, and without a plant it turns a flywheel, in the
  order of magnitude of a gear motor of 12 V and 17 W.
* within a PWM period the current is steady: what a half bridge does is taken at its mean.
* a motor whose half bridge is open keeps its own voltage; what was left of its current ends in its winding.
* one half-bridge chip drives M1 and M2, the other M3 and M4.
* an edge keeps the processor for 10 us, whichever counter it is for; what comes faster is lost, from all
  counters in the same proportion, and never counted the other way.
"""

import math
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import floor, tau
from typing import Final

from emulators.arduino_omni.mega.pins import ENCODER_PINS, Shafts
from emulators.arduino_omni.shield.motor_shield import PORTS, MotorShield
from emulators.arduino_omni.shield.tb6612 import (
    COAST,
    COUNTS,
    ON_RESISTANCE,
    BridgeDuty,
    Thermal,
    limited,
    locked,
    on_resistance,
)
from emulators.servo.axis import TICK
from emulators.servo.motor import DcMotor, DcMotors
from emulators.servo.seam import WIDEST_ANGLE, ServoPlant, no_measurement
from emulators.servo.terminals import Terminals, Wired, terminals
from firmware_bridge.units import MICROSECOND, NEVER, Nanoseconds
from fmu.errors import PlantError

SUPPLY_V: Final = 12.0
COUNTS_PER_TURN: Final = 48
"""Encoder counts per turn of a motor's shaft."""
MOTOR: Final = DcMotor(
    resistance=2.0, inductance=1e-3, torque_constant=0.013, inertia=4e-6, friction=8e-4, damping=9e-7
)
"""Motor at each of the four terminals, where there is no plant."""
BLOCKED: Final = 20.0
"""N m that hold what is blocked: some four times what a motor of 12 V and 17 W does behind its gear."""
CHANNELS_A_CHIP: Final = 2
EDGE: Final[Nanoseconds] = 10 * MICROSECOND
EDGES_A_TICK: Final = TICK // EDGE
"""Edges of all encoders together that the processor counts in a tick: 100,000 per second."""


@dataclass(frozen=True, slots=True)
class MotorLoad:
    """The load on the terminals M1, M2 and so on: a plant, and its data that the shield needs."""

    plant: ServoPlant
    names: tuple[str, ...]
    torque_constants: tuple[float, ...]
    """N m/A, or V s/rad: of each motor."""
    supply: int | None = None
    """Index of the plant's output that is the supply in V; None: it is constant."""
    rests: bool = False
    """True if a plant in which nothing turns and no motor is driven stays as it is."""
    counts_per_turn: int = COUNTS_PER_TURN
    holds: Callable[[int, float], None] | None = None
    """Function that makes a motor's shaft rub behind its gear, N m, from 0 on; None: this plant cannot."""
    hoists: Callable[[int, float], None] | None = None
    """Function that lifts a motor's load into the air, 1, or puts it down, 0; None: this plant cannot."""


def four_motors(motor: DcMotor = MOTOR) -> MotorLoad:
    """Return a motor at each of the shield's terminals."""
    count = len(PORTS)
    names = tuple(port.name for port in PORTS)
    motors = DcMotors((motor,) * count)

    def hold(place: int, torque: float) -> None:
        motors.becomes(place, replace(motor, friction=motor.friction + torque))

    return MotorLoad(motors, names, (motor.torque_constant,) * count, rests=True, holds=hold)


def counted(turned: Sequence[int], most: int = EDGES_A_TICK) -> list[int]:
    """Return how many of these edges the processor counts in a tick, encoder by encoder, with signs."""
    all_of_them = sum(abs(it) for it in turned)
    if all_of_them <= most:
        return list(turned)
    # In integers, towards zero, so that the library in C loses the same edges.
    return [abs(it) * most // all_of_them * (1 if it > 0 else -1) for it in turned]


@dataclass(slots=True)
class MotorFaults:
    """Faults between a shield and its motors; none by default."""

    limits_current: bool = False
    """True if the half bridges cut a current that has reached their peak."""
    warms: bool = False
    """True if the half bridges' temperature is simulated, and shuts them down."""
    cut: set[int] = field(default_factory=set)
    """Motors, from 0, whose cable is off."""
    dead: set[int] = field(default_factory=set)
    """Encoders, from 0, that give no edges."""
    swapped: set[int] = field(default_factory=set)
    """Encoders, from 0, whose channels are exchanged: they count the other way."""
    reversed: set[int] = field(default_factory=set)
    """Motors, from 0, whose two leads are exchanged: they turn the other way."""
    supply: float = math.inf
    """V: the motors' supply has no more."""

    def __bool__(self) -> bool:
        """Return whether anything is otherwise than it should be."""
        wires = self.cut or self.dead or self.swapped or self.reversed
        return self.limits_current or self.warms or bool(wires) or self.supply < math.inf


class Motors(Shafts):
    """Shafts that a shield's motors turn. `angles` is the truth, `edges` what an encoder's counters see."""

    def __init__(
        self,
        shield: MotorShield,
        load: MotorLoad,
        wiring: tuple[tuple[int, int], ...] = ENCODER_PINS,
        *,
        supply: float = SUPPLY_V,
    ) -> None:
        """Put a load on a shield; motors beyond the wired encoders turn unseen. `supply` in V."""
        super().__init__(wiring)
        self.wiring: Final = wiring
        """The two pins of each motor's encoder."""
        self._channels: Final = {
            pin: (motor, channel) for motor, pins in enumerate(wiring) for channel, pin in enumerate(pins)
        }
        self._shield: Final = shield
        self._load: Final = load
        self._plant: Final = load.plant
        self._constant_supply: Final = supply
        self._scale: Final = load.counts_per_turn / tau
        self.faults: Final = MotorFaults()
        self.chips: Final = tuple(Thermal() for _ in PORTS[::CHANNELS_A_CHIP])
        """Temperatures of the half bridges, simulated where `faults` requires it."""
        self._locked = False
        """True if the supply is too low for the half bridges."""
        self._ticks = 0
        self._seen = min(len(wiring), len(load.names))
        self._places: Final = array("q", self._counts())
        self._counted: Final = array("q", self._edges)
        self._shown: Sequence[int] = self._places
        self._due = 0
        """Ticks to be run before someone looks."""
        self._changes = -1
        """The chip's count of output changes when these were read."""
        self._outputs: list[BridgeDuty] = []
        self._untold = True
        """True until `_native` has received the outputs."""
        self._starts: Nanoseconds = NEVER
        """Start of the chip's oscillator, at which the outputs change by themselves."""
        self._started: list[BridgeDuty] = []
        self._native: Final = terminals(
            load.plant,
            Wired(
                load.names,
                load.torque_constants,
                self._seen,
                COUNTS,
                ON_RESISTANCE,
                load.supply,
                supply,
                self._scale,
                EDGES_A_TICK,
            ),
            self._places,
            self._counted,
        )

    @property
    def now(self) -> Nanoseconds:
        """Time up to which the motors have turned."""
        return self._ticks * TICK

    @property
    def edges(self) -> list[int]:
        """Edges as the processor has counted them."""
        self._run()
        return self._counted.tolist()

    @property
    def currents(self) -> Sequence[float]:
        """Current of each motor, in A."""
        self._run()
        return self._plant.outputs[: len(self._load.names)]

    @property
    def angles(self) -> Sequence[float]:
        """Angle of each motor's shaft, in rad."""
        self._run()
        count = len(self._load.names)
        return self._plant.outputs[count : 2 * count]

    @property
    def speeds(self) -> Sequence[float]:
        """Speed of each motor's shaft, in rad/s."""
        self._run()
        count = len(self._load.names)
        return self._plant.outputs[2 * count : 3 * count]

    @property
    def supply(self) -> float:
        """Supply of the half bridges, in V."""
        self._run()
        return self._supplied()

    def _supplied(self) -> float:
        place = self._load.supply
        given = self._constant_supply if place is None else self._plant.outputs[place : place + 1][0]
        return min(given, self.faults.supply)

    def has_encoder(self, motor: int) -> None:
        """Raise PlantError where a motor has none."""
        if motor >= self._seen:
            raise PlantError(f"{self._load.names[motor]} has no encoder")

    def block(self, motor: int, *, blocked: bool) -> None:
        """Let something hold a motor's shaft, or let it go; PlantError where the plant has no way for it."""
        # Before any tick is run: a plant without that input stays as it was.
        if self._load.holds is None:
            raise PlantError(f"the plant has no input held_{self._load.names[motor]}: nothing can hold it")
        self._run()
        self._load.holds(motor, BLOCKED if blocked else 0.0)

    def hoist(self, motor: int, *, lifted: bool) -> None:
        """Hoist what a motor turns, or put it down; PlantError where the plant has no way for it."""
        if self._load.hoists is None:
            raise PlantError(f"the plant has no input lifted_{self._load.names[motor]}: nothing can hoist it")
        self._run()
        self._load.hoists(motor, float(lifted))

    def starves(self, volts: float) -> None:
        """Limit the motors' supply to these volts from here on; inf: no limit."""
        self._run()
        self.faults.supply = volts

    def follow_heat(self, *, followed: bool) -> None:
        """Follow the half bridges' temperatures from here on, cold, or no more."""
        self.faults.warms = followed
        for chip in self.chips:
            chip.begin(self._ticks * TICK)

    def level(self, pin: int) -> bool | None:
        """Return what an encoder puts on a pin: forwards A comes a quarter of a line before B."""
        motor, channel = self._channels.get(pin, (self._seen, 0))
        if motor >= self._seen:
            return None
        self._run()
        if motor in self.faults.swapped:
            channel = 1 - channel
        # Each channel is high for two of four counts, B one count behind A.
        return (self._shown[motor] - channel) % 4 in {1, 2}

    def reach(self, now: Nanoseconds) -> None:
        """Advance to `now`, in whole ticks, by the commands that the shield has received so far."""
        # The ticks before the new command are run with the outputs of the former one.
        if self._shield.chip.changes != self._changes:
            self._run()
            self._read()
        self._due = max(self._due, now // TICK)

    def advance(self, now: Nanoseconds) -> None:
        """Turn them up to `now`."""
        self.reach(now)
        self._run()

    def _read(self) -> None:
        """Read the shield's present state, and the change that will come of it."""
        at, chip = self._ticks * TICK, self._shield.chip
        self._changes = chip.changes
        self._outputs = self._outputs_at(at)
        self._untold = True
        self._starts = chip.next_change(at)
        if self._starts != NEVER:
            self._started = self._outputs_at(self._starts)

    def _outputs_at(self, at: Nanoseconds) -> list[BridgeDuty]:
        return [self._shield.output(port, at) for port in PORTS[: len(self._load.names)]]

    def _run(self) -> None:
        """Run the ticks that are due; where one fails, none of them is any more."""
        if self._ticks >= self._due:
            return
        try:
            while self._ticks < self._due:
                if self._starts <= self._ticks * TICK:
                    self._outputs, self._starts, self._untold = self._started, NEVER, True
                # The oscillator's start counts from the first whole tick behind it.
                until = min(self._due, -(-self._starts // TICK))
                if self._native is not None and not self.faults:
                    self._run_native(self._native, until)
                else:
                    self._run_reference(until)
        finally:
            self._due = self._ticks

    def _run_native(self, native: Terminals, until: int) -> None:
        if self._untold:
            self._untold = False
            native.connect(self._outputs)
        self._shown = self._places
        try:
            native.run(self._ticks, until)
        finally:
            self._ticks = native.tick

    def _run_reference(self, until: int) -> None:
        # Nothing moves and nothing drives: the ticks would change no value.
        if self._load.rests and self._still(self._outputs):
            self._ticks = until
            if self.faults.warms:
                self._warm()
        while self._ticks < until:
            self._tick(self._outputs)

    def _still(self, outputs: Sequence[BridgeDuty]) -> bool:
        """Return whether nothing will change: all stands, and no one drives."""
        driven = any(it.cw != it.ccw for it in outputs)
        count, state = len(outputs), self._plant.outputs
        return not driven and not any(state[:count]) and not any(state[2 * count : 3 * count])

    def _warm(self) -> None:
        currents = tuple(self._plant.outputs[: len(self._load.names)])
        for place, chip in enumerate(self.chips):
            begin = CHANNELS_A_CHIP * place
            chip.advance(currents[begin : begin + CHANNELS_A_CHIP], self._ticks * TICK)

    def _passed(self, motor: int, output: BridgeDuty, current: float) -> BridgeDuty:
        """Return the motor's drive after the half bridge, its faults and its cable."""
        if motor in self.faults.cut or self._locked:
            return COAST
        if motor in self.faults.reversed:
            output = replace(output, cw=output.ccw, ccw=output.cw)
        if self.faults.limits_current:
            output = limited(output, current)
        return self.chips[motor // CHANNELS_A_CHIP].passes(output) if self.faults.warms else output

    def _tick(self, outputs: Sequence[BridgeDuty]) -> None:
        faults, plant, supply = self.faults, self._plant, self._supplied()
        resistance = on_resistance(supply)
        count = len(outputs)
        state = plant.outputs[: 3 * count]
        if faults:
            self._locked = locked(supply, was=self._locked)
            outputs = [self._passed(motor, it, state[motor]) for motor, it in enumerate(outputs)]
        for motor, output in enumerate(outputs):
            volts = output.volts(supply, state[motor], resistance)
            if output.open:
                # While it is open the motor has its own voltage, so that this share drives no current.
                volts += output.open / COUNTS * self._load.torque_constants[motor] * state[2 * count + motor]
            plant.inputs[motor] = volts
        plant.step()
        self._ticks += 1
        if faults.warms:
            self._warm()
        places = self._counts()
        turned = self._seen_turning(places)
        self._places[:] = array("q", places)
        if any(turned):
            for place, edges in enumerate(counted(turned)):
                self._counted[place] += edges

    def _seen_turning(self, places: Sequence[int]) -> list[int]:
        """Return by how many edges each encoder has turned, as its wires show it, and note what they show."""
        dead, swapped = self.faults.dead, self.faults.swapped
        turned = [new - old for new, old in zip(places, self._places, strict=True)]
        # A dead encoder keeps its last levels.
        shown = [old if it in dead else places[it] for it, old in enumerate(self._shown)] if dead else None
        self._shown = self._places if shown is None else shown
        directions = [0 if it in dead else -1 if it in swapped else 1 for it in range(len(turned))]
        return [direction * turn for direction, turn in zip(directions, turned, strict=True)]

    def _counts(self) -> list[int]:
        count, found = len(self._load.names), []
        for motor, angle in enumerate(self._plant.outputs[count : count + self._seen]):
            place = angle * self._scale
            if not -WIDEST_ANGLE <= place <= WIDEST_ANGLE:
                no_measurement("angle", self._load.names[motor], place, self._ticks)
            found.append(floor(place))
        return found
