"""The energy law of a winding whose stage is off: its terminals give it nothing, whatever is known of the
motor.

The work at the terminals is the integral of voltage times current. The plant solves its tick exactly at a
constant voltage, so that work is known to the last bit: the charge of a tick is (u t - k turned - L change)
/ R.
"""

from dataclasses import dataclass
from math import copysign

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from emulators.servo.axis import RAMP, TICK, ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.commands import regulate_velocity
from emulators.servo.motor import MOTOR, DcMotor, DcMotors
from emulators.servo.scaling import Settings, acceleration_units, configure, speed_units
from emulators.servo.winding import DIODES_MV, set_winding
from firmware_bridge.units import MILLISECOND, to_seconds
from hil_tests.lanes import examples

GAINS = Settings(
    current_p=180,
    current_i=60,
    velocity_p=1200,
    velocity_i=150,
    peak_current=20_000,
    continuous_current=20_000,
    max_speed=25_000,
)
PLAIN = DcMotor(1.0, 0.5e-3, 0.04, 2e-4)
SUPPLY_V = 24.0
TOLERANCE_J = 5e-5
"""Allowance for a tick in which a load begins to slow the shaft down, which is not yet detected."""
SHARE = 1e-4
"""... and so much of what rotor and winding hold when the stage opens."""


@dataclass
class Bench:
    """A motor, a drive's axis above it, and the work done at the terminals since the stage was opened."""

    motor: DcMotor
    reported: str = "all"

    def __post_init__(self) -> None:
        self.plant = DcMotors((self.motor,))
        self.axis = ServoAxis("one", 2000, supply_mv=round(SUPPLY_V * 1000))
        configure(self.axis, GAINS)
        if self.reported == "all":
            set_winding(self.axis, self.motor.torque_constant, self.motor.resistance, self.motor.inductance)
        elif self.reported == "constant":
            set_winding(self.axis, self.motor.torque_constant)
        self.bank = ServoBank(self.plant, [self.axis])
        self.work = 0.0
        self.most_current = 0.0

    @property
    def current(self) -> float:
        return self.plant.outputs[0]

    @property
    def speed(self) -> float:
        return self.plant.outputs[2]

    def turns(self, speed: float, current: float = 0.0) -> None:
        """Let the shaft turn at this speed (rad/s) with this current (A), its load in balance."""
        self.plant.outputs[0], self.plant.outputs[2] = current, speed
        self.plant.load[0] = -self.motor.torque_constant * current

    def runs(self, milliseconds: float) -> None:
        """Run on; while the stage is off, count the work at the terminals."""
        for _ in range(round(milliseconds * MILLISECOND / TICK)):
            current, angle, _ = self.plant.outputs[:3]
            off = not self.axis.powered
            self.bank.advance(self.bank.now + TICK)
            if off:
                voltage = self.plant.inputs[0]
                after, turned = self.plant.outputs[0], self.plant.outputs[1] - angle
                flux = self.motor.torque_constant * turned + self.motor.inductance * (after - current)
                self.work += voltage * (voltage * to_seconds(TICK) - flux) / self.motor.resistance
                self.most_current = max(self.most_current, abs(after))
                assert self.work <= self.bound, f"{self.work:g} J through an open stage"
                assert abs(voltage) <= SUPPLY_V + DIODES_MV / 1000

    def opens(self) -> None:
        """Open the stage, and begin to count."""
        self.axis.switch_off()
        self.work = self.most_current = 0.0
        self.bound = TOLERANCE_J + SHARE * self.stored() + self.drawn()

    def stored(self) -> float:
        """Return the energy of winding and rotor in J."""
        return (self.motor.inductance * self.current**2 + self.motor.inertia * self.speed**2) / 2

    def drawn(self) -> float:
        """Return what a load that was in balance draws through the stage in its first tick, in J.

        The current ends and the load is there still: it changes the speed by as much of itself as the tick is
        of the mechanical time constant, and the stage knows the speed of a tick ago.
        """
        lasts, motor = to_seconds(TICK), self.motor
        share = lasts * motor.torque_constant**2 / (motor.resistance * motor.inertia)
        return abs(self.plant.load[0] * self.speed) * lasts * min(share, 1.0)


REPORTED = st.sampled_from(("all", "constant", "nothing"))
MOTORS = st.builds(
    lambda resistance, delay, constant, inertia, friction, damping: DcMotor(
        resistance, resistance * delay, constant, inertia, friction, damping
    ),
    resistance=st.floats(0.06, 15.0),
    delay=st.floats(1e-5, 1e-3),
    constant=st.floats(0.005, 0.2),
    inertia=st.floats(1e-5, 1e-3),
    friction=st.sampled_from((0.0, 1e-3, 5e-3)),
    damping=st.sampled_from((0.0, 1e-5)),
)


@settings(max_examples=examples(60))
@given(
    motor=MOTORS,
    reported=REPORTED,
    speed=st.floats(-300.0, 300.0),
    current=st.floats(-15.0, 15.0),
    load=st.floats(-0.1, 0.1),
)
@example(motor=DcMotor(0.0625, 6.25e-7, 0.1875, 1e-5), reported="all", speed=3.0, current=2.0, load=0.0)
@example(
    motor=DcMotor(0.0605, 2.85e-5, 0.0957, 6.95e-5), reported="nothing", speed=59.0, current=0.0, load=0.0
)
def test_an_open_stage_gives_no_motor_energy(
    *, motor: DcMotor, reported: str, speed: float, current: float, load: float
) -> None:
    bench = Bench(motor, reported)
    bench.turns(speed, current)
    bench.opens()
    bench.runs(10)
    bench.plant.load[0] = load
    bench.runs(40)


@settings(max_examples=examples(25))
@given(
    motor=MOTORS,
    reported=REPORTED,
    cycles=st.lists(
        st.tuples(st.integers(-6000, 6000), st.floats(0.3, 30.0), st.floats(0.1, 30.0)), max_size=5
    ),
)
def test_however_often_the_stage_is_opened_it_gives_no_energy(
    motor: DcMotor, reported: str, cycles: list[tuple[int, float, float]]
) -> None:
    bench = Bench(motor, reported)
    for rpm, on_ms, off_ms in cycles:
        bench.axis.switch_on()
        regulate_velocity(bench.axis)
        bench.axis.profile = RAMP
        bench.axis.acceleration = bench.axis.deceleration = acceleration_units(bench.axis, 500_000)
        bench.axis.target_velocity = speed_units(bench.axis, rpm)
        bench.runs(on_ms)
        bench.opens()
        bench.runs(off_ms)


@pytest.mark.long(
    keeps=[
        "-6.5--234.0-all",
        "-6.5--0.5-nothing",
        "-6.5-7.6-constant",
        "-0.05--7.6-all",
        "-0.05-0.0-nothing",
        "-0.05-234.0-constant",
        "0.0--0.5-all",
        "0.0-3.0-nothing",
        "0.05--234.0-constant",
        "0.05-0.0-all",
        "0.05-7.6-nothing",
        "6.5--7.6-constant",
        "6.5-3.0-all",
        "6.5-234.0-nothing",
    ]
)
@pytest.mark.parametrize("reported", ["all", "constant", "nothing"])
@pytest.mark.parametrize("speed", [-234.0, -7.6, -0.5, 0.0, 3.0, 7.6, 234.0])
@pytest.mark.parametrize("current", [-6.5, -0.05, 0.0, 0.05, 6.5])
def test_a_shaft_whose_stage_is_off_never_gets_faster_nor_passes_rest(
    reported: str, speed: float, current: float
) -> None:
    """With what is in its winding alone: the energy of a current that drives is small beside the rotor's."""
    bench = Bench(PLAIN, reported)
    bench.turns(speed, current)
    bench.opens()
    bench.plant.load[0] = 0.0
    fastest = ((2 * bench.stored()) / PLAIN.inertia) ** 0.5
    bench.runs(300)
    assert abs(bench.speed) <= fastest + 0.01
    assert bench.speed * speed >= 0.0 or abs(bench.speed) <= fastest - abs(speed) + 1.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("driving", [True, False])
def test_an_inductive_current_decays_against_the_supply_and_is_over_for_good(
    sign: float, *, driving: bool
) -> None:
    motor = DcMotor(1.0, 2e-3, 0.04, 2e-4)
    bench = Bench(motor)
    current = (5.0 if driving else -5.0) * sign
    bench.turns(100.0 * sign, current)
    bench.opens()
    # di/dt = (supply + diodes + R i +- back-EMF) / L: ended after 0.33 ms by a back-EMF that helps, else
    # 0.43 ms.
    bench.runs(0.2)
    assert abs(bench.plant.inputs[0]) == SUPPLY_V + DIODES_MV / 1000
    assert bench.plant.inputs[0] * current < 0
    assert abs(bench.current) > 1.0
    bench.runs(0.3)
    assert abs(bench.current) < 0.01
    bench.opens()
    bench.plant.load[0] = 0.0
    bench.runs(50)
    assert bench.most_current < 0.01
    assert abs(bench.speed) > 95.0


def test_a_back_emf_beyond_supply_and_diodes_brakes_into_the_supply() -> None:
    bench = Bench(PLAIN)
    limit = SUPPLY_V + DIODES_MV / 1000
    bench.turns(1000.0)
    bench.opens()
    bench.runs(5)
    assert bench.plant.inputs[0] == limit
    assert bench.current == pytest.approx((limit - 0.04 * bench.speed) / 1.0, rel=0.05)
    assert bench.work < -0.1
    bench.runs(900)
    assert bench.speed == pytest.approx(limit / 0.04, rel=0.01)
    bench.runs(50)
    bench.opens()
    bench.runs(50)
    assert bench.most_current < 0.05


def test_a_voltage_that_only_sags_at_the_drive_brakes_nothing() -> None:
    bench = Bench(PLAIN)
    bench.axis.source_mv, bench.axis.supply_mv = 24_000, 5_000
    bench.turns(500.0)
    bench.opens()
    bench.runs(50)
    assert bench.most_current < 0.05
    assert bench.speed > 499.0


def test_what_was_reported_is_never_learnt_over() -> None:
    bench = Bench(PLAIN)
    before = (bench.axis.back_emf, bench.axis.decay_resistance, bench.axis.balance_resistance)
    for current in (6.5, -6.5, 0.0):
        bench.axis.switch_on()
        bench.turns(200.0, current)
        bench.opens()
        bench.runs(20)
    assert (bench.axis.back_emf, bench.axis.decay_resistance, bench.axis.balance_resistance) == before


@pytest.mark.parametrize("speed", [-300.0, -60.0, 60.0, 300.0])
@pytest.mark.parametrize("current", [-5.0, 0.0, 5.0])
def test_a_constant_that_no_one_reported_is_learnt_from_below(speed: float, current: float) -> None:
    bench = Bench(PLAIN, "nothing")
    bench.turns(speed, current)
    bench.opens()
    bench.plant.load[0] = 0.0
    bench.runs(30)
    learnt = bench.axis.back_emf / 2**24
    assert 0.98 * PLAIN.torque_constant < learnt <= 1.001 * PLAIN.torque_constant
    bench.opens()
    bench.runs(100)
    assert bench.most_current < 0.1


def test_a_winding_that_is_not_what_was_reported_is_not_fed_by_what_was() -> None:
    """A winding with a short has a hundredth of its inductance: the given one's decay voltage is too much."""
    bench = Bench(MOTOR)
    shorted = DcMotor(0.1, 5e-6, MOTOR.torque_constant, MOTOR.inertia)
    bench.plant.becomes(0, shorted)
    bench.motor = shorted
    bench.turns(200.0, 5.0)
    bench.axis.switch_off()
    bench.bound = 0.5
    bench.runs(1)
    assert bench.axis.balance_resistance == 0
    bench.opens()
    bench.runs(100)


def three_seen() -> list[tuple[float, float]]:
    """Speed (rad/s) and current (A) at which a stage that was off was seen to drive."""
    return [(7.6, -2.0), (-234.0, 6.5), (-56.0, -0.87)]


@pytest.mark.parametrize(("speed", "current"), three_seen())
@pytest.mark.parametrize("reported", ["all", "constant", "nothing"])
def test_what_was_seen_to_drive_does_so_no_more(reported: str, speed: float, current: float) -> None:
    for motor in (DcMotor(15.0, 13.6e-3, 0.1875, 6.1e-5), MOTOR):
        bench = Bench(motor, reported)
        bench.turns(speed, current)
        bench.opens()
        bench.plant.load[0] = 0.0
        fastest = ((2 * bench.stored()) / motor.inertia) ** 0.5
        bench.runs(300)
        assert abs(bench.speed) <= fastest
        assert copysign(1.0, bench.speed) == copysign(1.0, speed) or abs(bench.speed) < 3.0
