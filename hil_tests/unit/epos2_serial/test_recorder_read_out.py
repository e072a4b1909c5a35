"""A recording is read out over the serial lines and the gateway as it lies in the drive."""

import pytest

from emulators.epos2.io.data_recorder import DataRecorder
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import DcMotor, DcMotors
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.maxon.messages import (
    Done,
    InitiateSegmentedRead,
    SegmentOut,
    SegmentRead,
    WriteObject,
    control,
)
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.epos2_serial.serial_desk import FAR, NEAR, SerialDesk

BUFFER = 0x201B
SET_UP = ((0x2014, 0, 1), (0x2015, 1, 0x2020), (0x2016, 1, 0), (0x2012, 0, 1), (0x2010, 0, 1))


@pytest.mark.parametrize(("node", "segments"), [(NEAR, 17), (FAR, 147)], ids=["own", "gateway"])
@pytest.mark.parametrize("generation", Generation)
def test_a_recording_comes_in_segments(generation: Generation, node: int, segments: int) -> None:
    # EPOS2 Application Notes, April 2013, p. 162-167: 1 kB takes 17 commands, and 147 through the gateway.
    desk = SerialDesk(generation)
    store = (desk.far if node == FAR else desk.drive).store
    plant = DcMotors((DcMotor(1.0, 1e-3, 0.04, 1e-5),))
    plant.outputs[2] = 100.0
    axis = ServoAxis("recorded", 2000)
    bank = ServoBank(plant, [axis])
    DataRecorder(store, axis)
    for index, subindex, value in SET_UP:
        assert desk.requests(WriteObject(index, subindex, node, value.to_bytes(4, "little"))) == Done(0)
    while bank.now < 40 * MILLISECOND:
        bank.advance(40 * MILLISECOND)
    assert desk.requests(InitiateSegmentedRead(BUFFER, 0, node)) == Done(0)
    chunks: list[bytes] = []
    more = True
    while more:
        answer = desk.requests(SegmentRead(control(0, toggle=len(chunks) % 2 == 1)))
        assert isinstance(answer, SegmentOut)
        assert answer.error == 0
        chunks.append(answer.raw[: answer.control & 0x3F])
        more = bool(answer.control & 0x80)
    assert len(chunks) == segments
    read = b"".join(chunks)
    assert read == store.read(Address(BUFFER))
    assert len(set(read)) > 20
