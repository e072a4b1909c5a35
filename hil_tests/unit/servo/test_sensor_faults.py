"""Sensors with any fault, in any surroundings: reference and kernel notice the same; time can be rewound."""

import ctypes

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from emulators.rewind import Rewind
from emulators.servo import axis as servo
from emulators.servo import kernel
from emulators.servo.axis_faults import AxisFaults, IndexPulse, SensorWires
from emulators.servo.bank import ServoBank
from emulators.servo.motor import DcMotor, DcMotors
from emulators.servo.sensors import align
from emulators.servo.winding import set_winding
from firmware_bridge.units import MILLISECOND
from hil_tests.lanes import examples
from hil_tests.unit.servo.campaign import legs
from hil_tests.unit.servo.side_by_side import COUNT, REFERENCE, SANE, Leg, Motors, Side, difference

WIRES = st.builds(
    SensorWires,
    broken=st.booleans(),
    swapped=st.booleans(),
    index=st.sampled_from(IndexPulse),
    lost_per_mille=st.one_of(st.just(0), st.integers(0, 1000)),
    auxiliary_swapped=st.booleans(),
    hall_high=st.sets(st.integers(1, 3)),
    hall_low=st.sets(st.integers(1, 3)),
)


@settings(max_examples=examples(40), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    seed=st.integers(0, 2**16),
    wires=st.lists(WIRES, min_size=COUNT, max_size=COUNT),
    pairs=st.tuples(st.integers(0, 255), st.integers(0, 255)),
    air=st.floats(-40, 120),
    supply=st.one_of(st.just(0), st.integers(1, 100_000)),
    limit=st.integers(0, 5000),
    marks=st.lists(st.booleans(), min_size=6, max_size=6),
)
def test_whatever_is_wrong_both_notice_alike(
    *,
    plant_library: ctypes.CDLL,
    native: kernel.KernelLibrary,
    seed: int,
    wires: list[SensorWires],
    pairs: tuple[int, int],
    air: float,
    supply: int,
    limit: int,
    marks: list[bool],
) -> None:
    sides = [Side(Motors(plant_library, seed=seed), (SANE,) * COUNT, each) for each in (REFERENCE, native)]
    for side in sides:
        for axis, cables in zip(side.axes, wires, strict=True):
            axis.encoder_reversed, axis.encoder_supervised, axis.index_supervised = map(int, marks[:3])
            axis.hall_angle_supervised, axis.auxiliary_supervised, axis.position_limited = map(int, marks[3:])
            axis.hall_pole_pairs, axis.forced_supply_mv = pairs[0], supply
            axis.lowest_qc, axis.highest_qc = -limit, limit
            axis.compare_direction, axis.compare_width = seed % 4, limit
            axis.compare_first, axis.compare_last = -(seed % 3), seed % 5
            axis.compare_pulse_ms = 1 + seed % 3
            AxisFaults(axis).motor(pole_pairs=pairs[1])
            AxisFaults(axis).wires(cables)
            AxisFaults(axis).air(air)
            align(axis)
    for leg in legs(np.random.default_rng(seed), 8):
        events = sides[0].lives(leg)
        assert events == sides[1].lives(leg)
        assert not difference(*sides)
        if isinstance(events, str):
            return


def test_every_finding_is_met_by_some_campaign(
    plant_library: ctypes.CDLL, native: kernel.KernelLibrary
) -> None:
    seen, draw = 0, np.random.default_rng(7)
    findings = (
        servo.ENCODER_BROKEN | servo.INDEX_LOST | servo.INDEX_DISTANCE_WRONG | servo.HALL_IMPOSSIBLE
        | servo.HALL_ANGLE_APART | servo.AUXILIARY_AGAINST_MAIN | servo.POSITION_LIMIT_PASSED
        | servo.OVER_TEMPERATURE
    )  # fmt: skip
    for seed in range(12):
        sides = [Side(Motors(plant_library, seed=seed), (SANE,) * COUNT, f) for f in (REFERENCE, native)]
        faults = [int(value) for value in draw.integers(0, 1 << 11, COUNT)]
        for side in sides:
            for axis, fault in zip(side.axes, faults, strict=True):
                axis.sensor_faults, axis.encoder_loss = fault, fault % 60
                axis.encoder_supervised = axis.index_supervised = axis.hall_angle_supervised = 1
                axis.auxiliary_supervised = axis.position_limited = 1
                axis.hall_pole_pairs, axis.highest_qc = 1 + fault % 4, 400
                axis.ambient_mc = 99_999
        for leg in legs(np.random.default_rng(seed), 12):
            assert sides[0].lives(leg) == sides[1].lives(Leg(leg.orders, leg.ticks))
            assert not difference(*sides)
            for axis in sides[1].axes:
                seen |= axis.flags
    assert seen & findings == findings


def test_faults_are_rewound_with_everything_else() -> None:
    plant = DcMotors((DcMotor(1.0, 1e-3, 0.04, 1e-5),))
    axis = servo.ServoAxis("one", 2000)
    set_winding(axis, 0.04)
    bank = ServoBank(plant, [axis])
    axis.encoder_supervised = axis.index_supervised = 1
    plant.outputs[2] = 300.0
    rewind = Rewind((bank, axis))
    bank.advance(5 * MILLISECOND)
    moment = rewind.snapshot()
    ends = []
    for _ in range(2):
        AxisFaults(axis).wires(SensorWires(lost_per_mille=77, index=IndexPulse.SPURIOUS))
        while bank.now < 100 * MILLISECOND:
            bank.advance(100 * MILLISECOND)
        ends.append((bytes(axis), list(plant.outputs)))
        rewind.restore(moment)
        assert axis.sensor_faults == axis.encoder_loss == 0
    assert ends[0] == ends[1]


def test_a_forced_supply_is_what_its_axis_sees_and_no_other(
    plant_library: ctypes.CDLL, native: kernel.KernelLibrary
) -> None:
    sides = [Side(Motors(plant_library, seed=3), (SANE,) * COUNT, each) for each in (REFERENCE, native)]
    for side in sides:
        side.bank.advance(2 * MILLISECOND)
        plants = side.axes[1].supply_mv
        assert plants > 0
        for axis, forced in ((side.axes[0], 9_000), (side.axes[0], 0)):
            axis.forced_supply_mv = forced
            side.bank.advance(side.bank.now + 2 * MILLISECOND)
            assert axis.supply_mv == (forced or side.axes[1].supply_mv)
            assert axis.analogue_1_mv == int(axis.supply_mv / 6.0)
            assert bool(axis.flags & servo.UNDER_VOLTAGE) is (axis.supply_mv < axis.under_voltage_mv)
            assert side.axes[1].supply_mv != 9_000
    assert not difference(*sides)
