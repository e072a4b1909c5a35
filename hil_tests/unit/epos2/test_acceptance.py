"""The drive's acceptance filter: what it does not listen to would have changed nothing."""

import hypothesis.strategies as st
from hypothesis import given, settings

from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.wire.can import EXTENDED, REMOTE
from hil_tests.lanes import examples
from hil_tests.unit.epos2.foreign_node import NODE, ForeignNode

LISTENED = {
    "powered": {0x000, 0x600 + NODE, 0x700 + NODE | REMOTE},
    "operational": {0x000, 0x080, 0x600 + NODE, 0x200 + NODE, 0x700 + NODE | REMOTE},
}


def held(foreign_node: ForeignNode) -> object:
    return tuple(value for _, value in foreign_node.drive.store.numbers()), bytes(foreign_node.axis)


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
    foreign_node = ForeignNode()
    if operational:
        foreign_node.sends(0x000, bytes((0x01, NODE)))
    packet = Packet(CAN, address, payload)
    if foreign_node.drive.listens(packet):
        return
    before, wake_at = held(foreign_node), foreign_node.drive.wake(foreign_node.now).wake_at
    reaction = foreign_node.drive.receive(packet, foreign_node.now)
    assert (reaction.sent, reaction.wake_at) == ((), wake_at)
    assert held(foreign_node) == before


def test_it_listens_to_what_its_state_takes() -> None:
    foreign_node = ForeignNode()
    for state, addresses in LISTENED.items():
        if state == "operational":
            foreign_node.sends(0x000, bytes((0x01, NODE)))
        for address in addresses:
            assert foreign_node.drive.listens(Packet(CAN, address, b"")), (state, hex(address))
        assert not foreign_node.drive.listens(Packet(CAN, 0x600 + NODE + 1, b""))
