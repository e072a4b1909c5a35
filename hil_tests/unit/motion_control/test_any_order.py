"""Any writes in any order: no exception, a real state, never torque without being enabled."""

from contextlib import suppress

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from emulators.epos2.modes.homing_methods import METHODS
from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.functions import (
    INPUT_EXECUTION,
    INPUT_PINS,
    INPUT_POLARITY,
    OUTPUT_PINS,
    OUTPUT_STATE,
)
from firmware_bridge.families.epos2.wire.power_states import state_of
from hil_tests.lanes import examples
from hil_tests.unit.motion_control.conftest import Drive, make_drive

POWERED = {
    PowerState.MEASURE_INIT,
    PowerState.OPERATION_ENABLED,
    PowerState.QUICK_STOP_ACTIVE,
    PowerState.FAULT_REACTION_ENABLED,
}
WRITABLE = sorted(
    (
        address
        for address, row in EPOS2_70_10.objects.items()
        if row.access.writable and row.type.size and address.index >= 0x2008
    ),
)
COMMANDS = (0x00, 0x02, 0x06, 0x07, 0x0F, 0x1F, 0x3F, 0x5F, 0x7F, 0x80, 0x10F, 0x11F)


class ForeignNode(RuleBasedStateMachine):
    """A client on the bus that writes anything."""

    drive: Drive

    @initialize(brushless=st.booleans())
    def power_on(self, *, brushless: bool) -> None:
        self.drive = make_drive()
        if brushless:
            self.drive.write(od.MOTOR_TYPE, 10)

    @rule(word=st.one_of(st.sampled_from(COMMANDS), st.integers(0, 0xFFFF)))
    def controlword(self, word: int) -> None:
        self.drive.write(od.CONTROLWORD, word)

    @rule()
    def enable(self) -> None:
        self.drive.command(0x80, 0x00, 0x06, 0x07, 0x0F)

    @rule(mode=st.sampled_from((1, 3, -1, -2, -3, 6, 7, -4)))
    def mode(self, mode: int) -> None:
        self.drive.write(od.MODE, mode)

    @rule(
        address=st.sampled_from(
            (
                od.TARGET_POSITION,
                od.TARGET_VELOCITY,
                at.POSITION_MODE_SETTING,
                at.VELOCITY_MODE_SETTING,
                at.CURRENT_MODE_SETTING,
            )
        ),
        value=st.one_of(st.integers(-20_000, 20_000), st.integers(-(2**31), 2**31 - 1)),
    )
    def target(self, address: Address, value: int) -> None:
        self.drive.write(address, value)

    @rule(address=st.sampled_from(WRITABLE), raw=st.binary(min_size=0, max_size=9))
    def any_object(self, address: Address, raw: bytes) -> None:
        size = EPOS2_70_10.objects[address].type.size
        with suppress(SdoAbort):
            self.drive.store.write(address, raw[:size].ljust(size, b"\0"))
        self.drive.control.refresh(self.drive.now)

    @rule(supply=st.sampled_from((0, 5_000, 24_000, 24_000, 24_000, 90_000)))
    def supply(self, supply: int) -> None:
        self.drive.axis.supply_mv = supply

    @rule(pins=st.integers(0, 0x1FF))
    def pins(self, pins: int) -> None:
        self.drive.axis.pins = pins

    @rule(
        address=st.sampled_from((*INPUT_PINS, *OUTPUT_PINS)),
        function=st.integers(0, 5),
        execution=st.integers(0, 0x3F),
        polarity=st.integers(0, 0x3F),
    )
    def wiring(self, address: Address, function: int, execution: int, polarity: int) -> None:
        self.drive.write(address, function)
        self.drive.write(INPUT_EXECUTION, execution)
        self.drive.write(INPUT_POLARITY, polarity)

    @rule(method=st.sampled_from(tuple(METHODS)), offset=st.integers(-5000, 5000))
    def homing(self, method: int, offset: int) -> None:
        self.drive.write(od.HOMING_METHOD, method)
        self.drive.write(od.HOME_OFFSET, offset)
        self.drive.write(od.MODE, 6)
        self.drive.command(0x80, 0x00, 0x06, 0x07, 0x0F, 0x1F)

    @rule(code=st.sampled_from((0x8210, 0x8120, 0x8150, 0x1000, 0x1234)))
    def communication(self, code: int) -> None:
        self.drive.control.communication_fault(code)

    @rule()
    def connection(self) -> None:
        self.drive.control.connection_lost()

    @rule(load=st.floats(-0.1, 0.1))
    def push(self, load: float) -> None:
        self.drive.plant.load[0] = load

    @rule(milliseconds=st.integers(1, 60))
    def time(self, milliseconds: int) -> None:
        self.drive.run(milliseconds)
        # No one moves the winding's current while its stage is open, but the back-EMF that is being learnt.
        if not self.drive.axis.powered:
            self.drive.run(1)
            assert self.drive.axis.current_demand_ma == 0

    @rule()
    def node_reset(self) -> None:
        self.drive.control.reset()

    @invariant()
    def power_only_where_the_state_allows_it(self) -> None:
        drive = self.drive
        assert bool(drive.axis.powered) == (drive.state in POWERED)
        assert bool(drive.statusword & 0x10) == (drive.state in POWERED)
        assert state_of(drive.statusword) is drive.state
        if not drive.axis.powered:
            assert drive.axis.current_demand_ma == 0
            assert not drive.read(OUTPUT_STATE) & 1 << 2, "the brake is closed"
            assert not drive.axis.index_watched
            assert not drive.axis.current_watched_ma
        assert abs(drive.axis.current_demand_ma) <= drive.axis.peak_ma

    @invariant()
    def what_can_be_read_can_be_read(self) -> None:
        for address in (od.POSITION_ACTUAL, at.FOLLOWING_ERROR, at.VELOCITY_AVERAGED, od.POSITION_DEMAND):
            self.drive.store.read(address)


ForeignNode.TestCase.settings = settings(max_examples=examples(60), stateful_step_count=40)
TestForeign = ForeignNode.TestCase
