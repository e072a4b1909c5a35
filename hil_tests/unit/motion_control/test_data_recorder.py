"""The data recorder: what is sampled when, around which trigger, and how it lies in the buffer."""

from typing import TYPE_CHECKING

import pytest

from emulators.epos2.io.data_recorder import RECORDABLE
from emulators.epos2.objects.axis_parameters import ACTUAL_VALUES
from emulators.rewind import Rewind
from emulators.servo.record import ServoRecord
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hil_tests.unit.motion_control.conftest import Drive

CONTROL, CONFIGURATION, PERIOD, PRECEDING, VARIABLES, STATUS, MOST, RECORDED, OFFSET, BUFFER = map(
    Address, (0x2010, 0x2011, 0x2012, 0x2013, 0x2014, 0x2017, 0x2018, 0x2019, 0x201A, 0x201B)
)
START, BY_HAND = 1, 2
MOVEMENT_START, ERROR, INPUT, MOVEMENT_END = 1, 2, 4, 8
RUNNING, TRIGGERED = 1, 2


def chosen(drive: "Drive", *addresses: Address, period: int = 10, preceding: int = 0, trigger: int) -> None:
    drive.write(VARIABLES, len(addresses))
    for place, address in enumerate(addresses, 1):
        drive.write(Address(0x2015, place), address.index)
        drive.write(Address(0x2016, place), address.subindex)
    drive.write(PERIOD, period)
    drive.write(PRECEDING, preceding)
    drive.write(CONFIGURATION, trigger)
    drive.write(CONTROL, START)


def vectors(drive: "Drive", sizes: "Sequence[int]") -> list[list[int]]:
    """Return each variable's samples, oldest first, as a client does (Application Notes, p. 185)."""
    raw, most = drive.store.read(BUFFER), drive.read(MOST)
    assert len(raw) == 1024
    begin, found = 0, []
    for size in sizes:
        ring = [
            int.from_bytes(raw[begin + k * size : begin + (k + 1) * size], "little", signed=True)
            for k in range(most)
        ]
        first, count = drive.read(OFFSET), drive.read(RECORDED)
        found.append([ring[(first + k) % most] for k in range(count)])
        begin += most * size
    return found


@pytest.mark.parametrize(
    ("addresses", "most"),
    [
        ((od.CURRENT_ACTUAL,), 512),
        ((od.POSITION_ACTUAL,), 256),
        ((od.CURRENT_ACTUAL, od.POSITION_ACTUAL), 170),
        ((od.POSITION_ACTUAL, od.POSITION_DEMAND, od.VELOCITY_ACTUAL, od.VELOCITY_DEMAND), 64),
    ],
    ids=["16 bit", "32 bit", "16 and 32 bit", "four of 32 bit"],
)
def test_the_memory_is_divided_as_in_the_application_notes(
    drive: "Drive", addresses: tuple[Address, ...], most: int
) -> None:
    # EPOS2 Application Notes, April 2013, p. 184: the four examples.
    chosen(drive, *addresses, trigger=0)
    assert drive.read(MOST) == most


def test_a_movement_is_recorded_from_its_first_millisecond_with_samples_from_before(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.run(20)
    chosen(drive, od.VELOCITY_DEMAND, od.CURRENT_ACTUAL, preceding=5, trigger=MOVEMENT_START)
    drive.run(30)
    assert drive.read(STATUS) == RUNNING
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.run(1)
    assert drive.read(STATUS) == RUNNING | TRIGGERED
    drive.run(200)
    assert drive.read(STATUS) == TRIGGERED
    demand, current = vectors(drive, (4, 2))
    # 30 000 rpm/s are 30 rpm in each ms.
    assert demand == [0] * 5 + [30 * min(k, 100) for k in range(1, 166)]
    assert max(current[:5]) < 20 < max(current[5:])


def test_every_tenth_of_a_millisecond_can_be_seen(drive: "Drive") -> None:
    drive.enable(mode=-3)
    drive.run(10)
    chosen(drive, od.CURRENT_ACTUAL, at.CURRENT_DEMAND, period=1, trigger=0)
    drive.run(5)
    drive.write(at.CURRENT_MODE_SETTING, 500)
    drive.run(5)
    drive.write(CONTROL, 0)
    assert drive.read(STATUS) == 0
    current, demand = vectors(drive, (2, 2))
    assert demand == [0] * 50 + [500] * 50
    rising = current[50:60]
    assert rising == sorted(rising)
    assert len(set(rising)) > 5


def test_the_end_of_a_movement_an_edge_and_a_hand_trigger_too(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 300)
    drive.run(50)
    chosen(drive, od.VELOCITY_DEMAND, period=10, preceding=255, trigger=MOVEMENT_END)
    drive.write(od.TARGET_VELOCITY, 0)
    drive.run(400)
    assert drive.read(STATUS) == TRIGGERED
    assert vectors(drive, (4,))[0][-2:] == [15, 0]
    chosen(drive, od.POSITION_ACTUAL, trigger=INPUT)
    drive.run(10)
    assert drive.read(STATUS) == RUNNING
    drive.axis.pins ^= 4
    drive.run(2)
    assert drive.read(STATUS) == RUNNING | TRIGGERED
    chosen(drive, od.POSITION_ACTUAL, trigger=0)
    drive.write(CONTROL, BY_HAND)
    assert drive.read(STATUS) == RUNNING | TRIGGERED
    drive.run(256)
    assert drive.read(RECORDED) == 256


def test_what_led_to_an_error_is_there_to_be_read(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.run(300)
    chosen(drive, at.VELOCITY_AVERAGED, at.CURRENT_DEMAND, preceding=169, trigger=ERROR)
    drive.run(400)
    drive.axis.supply_mv = 5_000
    drive.run(5)
    assert drive.stands_in(PowerState.FAULT)
    assert drive.read(STATUS) == TRIGGERED
    speed, _ = vectors(drive, (4, 2))
    assert len(speed) == 170
    assert all(value == pytest.approx(3000, abs=60) for value in speed)


@pytest.mark.parametrize("addresses", [(), (Address(0x6041),), (Address(0x5555),)])
def test_what_cannot_be_recorded_is_refused_at_the_start(
    drive: "Drive", addresses: tuple[Address, ...]
) -> None:
    with pytest.raises(SdoAbort) as refusal:
        chosen(drive, *addresses, trigger=1)
    assert refusal.value.code == AbortCode.PARAMETER_CLASH
    assert drive.read(STATUS) == 0
    assert drive.read(MOST) == 0


def test_every_value_is_made_from_the_fields_that_the_table_names(drive: "Drive") -> None:
    values = dict(ACTUAL_VALUES)
    drive.enable(mode=1)
    drive.write(od.TARGET_POSITION, 20_000)
    drive.command(0x1F)
    drive.run(50)
    for address, fields in RECORDABLE.items():
        shadow = ServoRecord()
        for field in (*fields, "resolution", "fraction"):
            setattr(shadow, field, getattr(drive.axis, field))
        assert values[address](shadow) == drive.read(address), address


def test_a_recording_is_rewound_with_everything_else(drive: "Drive") -> None:
    drive.enable(mode=3)
    rewind = Rewind(drive)
    before = rewind.snapshot()
    chosen(drive, od.POSITION_ACTUAL, trigger=MOVEMENT_START)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.run(100)
    during = rewind.snapshot()
    drive.run(500)
    first = vectors(drive, (4,))
    rewind.restore(during)
    assert drive.read(STATUS) == RUNNING | TRIGGERED
    drive.run(500)
    assert vectors(drive, (4,)) == first
    rewind.restore(before)
    assert drive.read(STATUS) == 0
    assert drive.store.read(BUFFER) == b""


def test_a_reset_forgets_the_recording(drive: "Drive") -> None:
    chosen(drive, od.POSITION_ACTUAL, trigger=0)
    drive.run(20)
    drive.control.reset()
    drive.run(20)
    assert (drive.read(STATUS), drive.read(RECORDED), drive.store.read(BUFFER)) == (0, 0, b"")
