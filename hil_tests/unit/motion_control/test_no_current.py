"""Any fault around a drive, in any mode: current flows only while the state allows it."""

from hypothesis import example, given, settings
from hypothesis import strategies as st

from emulators.servo.axis_faults import AxisFaults, IndexPulse, SensorWires
from emulators.servo.winding import set_winding
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire import address as at
from hil_tests.lanes import examples
from hil_tests.unit.motion_control.conftest import STEERING, Drive, into_the_supply, make_drive
from hil_tests.unit.motion_control.test_any_order import POWERED

SETTLED_MS = 10
"""Time after which the inductive current of the winding is over (its time constant is 0.1 ms)."""
LEAK = 0.05
"""A: a millivolt of rounding, and what the shaft's speed changes within one tick."""

WIRES = st.builds(
    SensorWires,
    broken=st.booleans(),
    swapped=st.booleans(),
    index=st.sampled_from(IndexPulse),
    lost_per_mille=st.sampled_from((0, 0, 3, 100, 1000)),
    auxiliary_swapped=st.booleans(),
    hall_high=st.sets(st.integers(1, 3)),
    hall_low=st.sets(st.integers(1, 3)),
)
DEEDS = st.one_of(
    st.tuples(st.just("wires"), WIRES),
    st.tuples(st.just("air"), st.sampled_from((25.0, 99.99, 120.0))),
    st.tuples(st.just("logic"), st.sampled_from((5.0, 3.0))),
    st.tuples(st.just("gate"), st.sampled_from((12.0, 5.0))),
    st.tuples(st.just("supply"), st.sampled_from((24_000, 24_000, 5_000, 90_000))),
    st.tuples(st.just("load"), st.floats(-0.004, 0.004)),
    st.tuples(st.just("pins"), st.integers(0, 0x1FF)),
    st.tuples(st.just("limits"), st.integers(-3000, 3000)),
    st.tuples(st.just("command"), st.sampled_from((0x00, 0x02, 0x06, 0x0F, 0x1F, 0x80, 0x10F))),
    st.tuples(st.just("again"), st.none()),
    st.tuples(st.just("node reset"), st.none()),
)


def does(drive: Drive, deed: str, value: object) -> None:
    around = AxisFaults(drive.axis)
    if isinstance(value, SensorWires):
        around.wires(value)
    elif isinstance(value, float):
        if deed == "load":
            drive.plant.load[0] = value
        else:
            {"air": around.air, "logic": around.logic_supply, "gate": around.gate_supply}[deed](value)
    elif isinstance(value, int):
        if deed == "limits":
            drive.write(od.MAX_POSITION_LIMIT, value)
        elif deed == "command":
            drive.command(value)
        else:
            setattr(drive.axis, {"supply": "supply_mv", "pins": "pins"}[deed], value)
    elif deed == "again":
        drive.command(0x80, 0x00, 0x06, 0x07, 0x0F)
    else:
        drive.control.reset()


@settings(max_examples=examples(60))
@given(
    mode=st.sampled_from((1, 3, -1, -2, -3)),
    motor=st.sampled_from((1, 10, 11)),
    target=st.integers(-4000, 4000),
    deeds=st.lists(st.tuples(DEEDS, st.integers(1, 60)), max_size=10),
)
@example(
    mode=1, motor=1, target=-4, deeds=[(("wires", SensorWires(swapped=True)), 38), (("supply", 5_000), 3)]
).via("a runaway that brakes into a supply of 5 V")
def test_no_current_flows_where_the_state_does_not_allow_it(
    mode: int, motor: int, target: int, deeds: list[tuple[tuple[str, object], int]]
) -> None:
    drive = make_drive()
    set_winding(drive.axis, STEERING.torque_constant, STEERING.resistance, STEERING.inductance)
    drive.write(od.MOTOR_TYPE, motor)
    drive.write(Address(0x2070, 1), 5)
    drive.write(Address(0x2071, 4), 0x2B)  # limit switches, marker and quick stop act
    drive.enable(mode=mode)
    drive.run(15)
    assert drive.state in POWERED
    for address in (od.TARGET_POSITION, od.TARGET_VELOCITY, at.POSITION_MODE_SETTING):
        drive.write(address, target)
    drive.write(at.VELOCITY_MODE_SETTING, target)
    drive.write(at.CURRENT_MODE_SETTING, target // 4)
    drive.command(0x1F)
    off = 0
    for (deed, value), milliseconds in deeds:
        does(drive, deed, value)
        for _ in range(milliseconds):
            assert bool(drive.axis.powered) == (drive.state in POWERED)
            drive.run(1)
            off = 0 if drive.state in POWERED else off + 1
            if off > SETTLED_MS:
                assert abs(drive.plant.outputs[0]) < LEAK + into_the_supply(drive)
