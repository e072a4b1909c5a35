"""One drive used on CAN and on its serial line at once, on the same objects: nothing lost or mixed."""

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.client import Ask, JobClient, Script, need
from firmware_bridge.families.epos2.commissioning.job import ReadJob, WriteJob
from firmware_bridge.families.epos2.commissioning.power import PowerCommand, Wanted
from firmware_bridge.families.epos2.commissioning.reading import Reading
from firmware_bridge.families.epos2.commissioning.serial_access import SerialAccess
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.wire.power_states import state_of
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.commissioning.rig import NEAR, Rig

SHARED = Address(0x200C, 1)
ROUNDS = 60


class Writer:
    """Client that writes ever higher numbers with a mark of its own, and reads the object back."""

    def __init__(self, mark: int) -> None:
        self.mark = mark
        self.seen: list[tuple[int, int]] = []
        """Pairs of its own last number and the value read after it."""

    def script(self, number: int = 1) -> Script:
        if number > ROUNDS:
            return ()
        value = (self.mark << 24 | number).to_bytes(4, "little")
        return (
            Ask(WriteJob(SHARED, value), need(lambda _raw: ())),
            Ask(ReadJob(SHARED), need(lambda raw: self._note(number, raw))),
        )

    def _note(self, number: int, raw: bytes) -> Script:
        self.seen.append((number, int.from_bytes(raw, "little")))
        return self.script(number + 1)


def together(generation: Generation, on_can: Script, on_line: Script) -> tuple[Rig, list[int]]:
    """Let two clients do their scripts at once; return the rig, and what was written to the shared object."""
    rig = Rig(generation)
    clients = (
        JobClient(CanAccess(NEAR), on_can),
        JobClient(SerialAccess(generation), on_line),
    )
    rig.world.attach("on can", clients[0], {CAN: rig.bus})
    rig.world.attach("on line", clients[1], {SERIAL: rig.line})
    values: list[int] = []
    rig.drives[NEAR].store.on_write(SHARED, values.append)
    end = rig.world.now + 20 * SECOND
    while not all(client.finished for client in clients) and rig.world.now < end:
        rig.waits(MILLISECOND)
    for client in clients:
        assert client.finished
        assert client.failure is None
    rig.waits(2 * MILLISECOND)
    return rig, values


@pytest.mark.parametrize("generation", Generation)
def test_no_update_is_lost_and_no_answer_is_the_other_s(generation: Generation) -> None:
    can, line = Writer(0x0C), Writer(0x05)
    _, values = together(generation, can.script(), line.script())
    for writer, other in ((can, line), (line, can)):
        own = [value & 0xFFFFFF for value in values if value >> 24 == writer.mark]
        assert own == list(range(1, ROUNDS + 1)), "each write took effect, once, in order"
        theirs = [value & 0xFFFFFF for _, value in writer.seen if value >> 24 == other.mark]
        assert theirs == sorted(theirs), "nothing that was overwritten comes back"
        for number, value in writer.seen:
            assert value in values
            assert value >> 24 == other.mark or value & 0xFFFFFF == number


@pytest.mark.parametrize("generation", Generation)
def test_both_may_read_by_segments_at_once(generation: Generation) -> None:
    def again(reading: Reading, rounds: int) -> Script:
        return tuple(step for _ in range(rounds) for step in reading.once())

    can, line = Reading([od.DEVICE_NAME, Address(0x2004)]), Reading([Address(0x2004), od.DEVICE_NAME])
    rig, _ = together(generation, again(can, 20), again(line, 20))
    serial_number = rig.value(NEAR, Address(0x2004))
    for reading in (can, line):
        assert reading.value(od.DEVICE_NAME) == "EPOS2"
        assert reading.value(Address(0x2004)) == serial_number


@pytest.mark.parametrize("generation", Generation)
def test_what_one_enables_the_other_stops(generation: Generation) -> None:
    rig = Rig(generation)
    for link, wanted, state in (
        (CanAccess(NEAR), Wanted.ENABLE, PowerState.OPERATION_ENABLED),
        (SerialAccess(generation), Wanted.QUICK_STOP, PowerState.QUICK_STOP_ACTIVE),
        (CanAccess(NEAR), Wanted.DISABLE, PowerState.SWITCH_ON_DISABLED),
        (SerialAccess(generation), Wanted.ENABLE, PowerState.OPERATION_ENABLED),
        (CanAccess(NEAR), Wanted.QUICK_STOP, PowerState.QUICK_STOP_ACTIVE),
    ):
        rig.does(link, PowerCommand(wanted).script())
        word = rig.value(NEAR, od.STATUSWORD)
        assert isinstance(word, int)
        assert state_of(word) is state
