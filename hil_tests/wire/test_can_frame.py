"""The length of a CAN frame against a second computation that shares nothing with the first."""

import hypothesis.strategies as st
import pytest
from hypothesis import given, settings

from firmware_bridge.wire.can import (
    ERROR,
    EXTENDED,
    EXTENDED_MASK,
    INTERFRAME_BITS,
    REMOTE,
    STANDARD_MASK,
    arbitration_rank,
    crc15,
    frame_bits,
    identifier,
)
from hil_tests.lanes import examples

GENERATOR = [int(bit) for bit in "1100010110011001"]
"""x15 + x14 + x10 + x8 + x7 + x4 + x3 + 1 (Bosch CAN 2.0, part B, section 3.1.1)."""


def fields(address: int, payload: bytes) -> str:
    remote = "1" if address & REMOTE else "0"
    content = "" if address & REMOTE else "".join(f"{byte:08b}" for byte in payload)
    control = "00" + f"{len(payload):04b}"
    if address & EXTENDED:
        digits = f"{identifier(address):029b}"
        return "0" + digits[:11] + "11" + digits[11:] + remote + control + content
    return "0" + f"{identifier(address):011b}" + remote + control + content


def remainder(bits: str) -> str:
    """Long division by the generator polynomial, on paper."""
    work = [int(bit) for bit in bits] + [0] * 15
    for place in range(len(bits)):
        if work[place]:
            for offset, coefficient in enumerate(GENERATOR):
                work[place + offset] ^= coefficient
    return "".join(str(bit) for bit in work[-15:])


def stuffed(bits: str) -> str:
    on_bus = ""
    for bit in bits:
        on_bus += bit
        tail = on_bus[-5:]
        # A stuff bit belongs to the next run, and never makes a run of six.
        if tail in {"00000", "11111"}:
            on_bus += "1" if tail == "00000" else "0"
    return on_bus


def expected_bits(address: int, payload: bytes) -> int:
    bits = fields(address, payload)
    return len(stuffed(bits + remainder(bits)) + "1" + "01" + "1111111")


addresses = st.one_of(
    st.integers(0, STANDARD_MASK),
    st.integers(0, EXTENDED_MASK).map(lambda number: number | EXTENDED),
)
remotes = st.sampled_from([0, REMOTE])
few_edges = st.sampled_from([0x00, 0xFF, 0xF0, 0x0F, 0x07, 0x83])
payloads = st.lists(st.one_of(few_edges, st.integers(0, 255)), max_size=8).map(bytes)


@pytest.mark.long(beside="test_known_frames")
@settings(max_examples=examples(2000))
@given(addresses, remotes, payloads)
def test_every_frame_is_as_long_as_the_second_computation_states(
    address: int, remote: int, payload: bytes
) -> None:
    address |= remote
    assert frame_bits(address, payload) == expected_bits(address, payload)


@settings(max_examples=examples(300))
@given(addresses, payloads)
def test_a_frame_stays_between_the_bounds_of_the_literature(address: int, payload: bytes) -> None:
    # Davis, Burns, Bril, Lukkien, "Controller Area Network (CAN) schedulability analysis", 2007, eq. (1),
    # less the interframe space of 3 bits: g = 34 or 54 bits are open to stuffing beside the data.
    open_bits = (54 if address & EXTENDED else 34) + 8 * len(payload)
    shortest = open_bits + 10
    assert shortest <= frame_bits(address, payload) <= shortest + (open_bits - 1) // 4


@pytest.mark.parametrize(
    ("address", "payload", "with_space"),
    [
        pytest.param(0x080, "", 51, id="SYNC"),
        pytest.param(0x555, "", 48, id="alternating identifier"),
        pytest.param(0x701, "00", 59, id="boot-up of node 1"),
        pytest.param(
            0x602, "4000100000000000", 124, id="SDO read of 0x1000, EPOS2 Application Notes p. 11-164"
        ),
        pytest.param(0x582, "4300100092010200", 121, id="its answer 0x00020192, same page"),
        pytest.param(0x000, "8101", 69, id="NMT reset node 1"),
        pytest.param(0x000 | EXTENDED, "0000000000000000", 150, id="29 bits of zero, 8 bytes of zero"),
        pytest.param(0x000 | EXTENDED | REMOTE, "", 73, id="remote frame with 29 bits of zero"),
        pytest.param(0x100, "FFFFFFFFFFFFFFFF", 126, id="8 bytes of ones"),
        pytest.param(0x07F, "0000000000000000", 127, id="8 bytes of zeros"),
    ],
)
def test_known_frames(address: int, payload: str, with_space: int) -> None:
    # Lengths as measured by `canbusload -e` of can-utils 2020.11 on vcan, interframe space included.
    assert frame_bits(address, bytes.fromhex(payload)) + INTERFRAME_BITS == with_space


def test_a_remote_frame_has_a_length_code_but_no_bytes() -> None:
    assert frame_bits(0x123 | REMOTE, bytes(8)) == frame_bits(0x123 | REMOTE, b"\xff" * 8)
    assert frame_bits(0x123 | REMOTE, bytes(8)) < frame_bits(0x123, bytes(1))


def test_the_check_sequence_has_the_published_check_value() -> None:
    # CRC-15/CAN of the ASCII digits 123456789: 059E (G. Cook, catalog of parametrized CRC algorithms).
    assert crc15(int.from_bytes(b"123456789", "big"), 72) == 0x059E


@pytest.mark.parametrize(("address", "length"), [(0x123, 9), (ERROR | 0x40, 8)])
def test_what_is_no_frame_has_no_length(address: int, length: int) -> None:
    with pytest.raises(ValueError, match="not a frame"):
        frame_bits(address, bytes(length))


@given(addresses, remotes, addresses, remotes)
def test_arbitration_is_won_by_the_first_dominant_bit(one: int, remote: int, two: int, other: int) -> None:
    one |= remote
    two |= other
    # To the end of the arbitration field, and for a standard frame its extension bit, too.
    one_bits, two_bits = (fields(address, b"")[: 33 if address & EXTENDED else 14] for address in (one, two))
    for first, second in zip(one_bits, two_bits, strict=False):
        if first != second:
            assert (arbitration_rank(one) < arbitration_rank(two)) == (first == "0")
            return
    assert arbitration_rank(one) == arbitration_rank(two)


@pytest.mark.parametrize(
    ("winner", "loser"),
    [
        (0x080, 0x081),
        (0x123, 0x123 | REMOTE),
        (0x123, 0x123 << 18 | EXTENDED),
        (0x123 | REMOTE, 0x123 << 18 | EXTENDED),
        (0x123 << 18 | EXTENDED, 0x124),
        (0x123 << 18 | EXTENDED, 0x123 << 18 | EXTENDED | REMOTE),
    ],
)
def test_who_wins(winner: int, loser: int) -> None:
    assert arbitration_rank(winner) < arbitration_rank(loser)
