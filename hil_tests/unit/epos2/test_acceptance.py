"""The drive's acceptance filter: what it does not listen to would have changed nothing."""

import hypothesis.strategies as st
from hypothesis import given, settings

from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.wire.can import EXTENDED, REMOTE
from hil_tests.lanes import examples
from hil_tests.unit.epos2.stranger import NODE, Stranger

LISTENED = {
    "powered": {0x000, 0x600 + NODE, 0x700 + NODE | REMOTE},
    "operational": {0x000, 0x080, 0x600 + NODE, 0x200 + NODE, 0x700 + NODE | REMOTE},
}


def held(stranger: Stranger) -> object:
    return tuple(value for _, value in stranger.drive.store.numbers()), bytes(stranger.axis)


@settings(max_examples=examples(100))
@given(
    address=st.integers(0, 0x7FF)
    | st.integers(0, 0x7FF).map(lambda low: low | REMOTE)
    | st.just(EXTENDED | 5),
    payload=st.binary(max_size=8),
    operational=st.booleans(),
)
def test_a_frame_that_the_drive_does_not_listen_to_changes_nothing(
    *, address: int, payload: bytes, operational: bool
) -> None:
    stranger = Stranger()
    if operational:
        stranger.sends(0x000, bytes((0x01, NODE)))
    packet = Packet(CAN, address, payload)
    if stranger.drive.listens(packet):
        return
    before, wake_at = held(stranger), stranger.drive.wake(stranger.now).wake_at
    reaction = stranger.drive.receive(packet, stranger.now)
    assert (reaction.sent, reaction.wake_at) == ((), wake_at)
    assert held(stranger) == before


def test_it_listens_to_what_its_state_takes() -> None:
    stranger = Stranger()
    for state, addresses in LISTENED.items():
        if state == "operational":
            stranger.sends(0x000, bytes((0x01, NODE)))
        for address in addresses:
            assert stranger.drive.listens(Packet(CAN, address, b"")), (state, hex(address))
        assert not stranger.drive.listens(Packet(CAN, 0x600 + NODE + 1, b""))
