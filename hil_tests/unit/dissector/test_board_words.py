"""Traffic of Arduino boards and cameras, decoded: golden lines, any cut, any bytes."""

from collections.abc import Callable, Iterator
from typing import Final, TypeAlias

import hypothesis.strategies as st
from hypothesis import given

from firmware_bridge.dissector import Carried, Dissector, kinds_of
from firmware_bridge.dissector.dissector import kinds
from firmware_bridge.families.ar2 import wire
from firmware_bridge.families.ar2.settings import Ar2Firmware
from firmware_bridge.families.motion_capture.settings import CaptureDriver
from firmware_bridge.families.motor_shield.dissector import RosLine
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.families.motor_shield.settings import ShieldProtocol
from firmware_bridge.families.motor_shield.wire import arduinoio, firmata, motor_shield, mw
from firmware_bridge.families.motor_shield.wire import mw_messages as messages
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from hil_tests.rows import every

REQUESTED, REPORTED = "bridge", "board"
Stated: TypeAlias = tuple[str, bytes, str]
"""Sender, bytes, and their decoded text."""

INFO: Final = messages.ServerInfo(17, 1, b"UNO", 0, (b"RotaryEncoder", b"I2C"))
SPEED: Final = bytes((motor_shield.LED0 + 4 * motor_shield.TERMINALS[1].pwm, 0, 0, 0x60, 0x04))

GOLDEN: Final[dict[str, tuple[Stated, ...]]] = {
    # The sketch's commands.h, and what its Python driver reads.
    ShieldProtocol.ROS_ARDUINO_BRIDGE: (
        (REQUESTED, b"b\r", "baud rate"),
        (REPORTED, b"57600\r\n", "answer to baud rate: 57600"),
        (REQUESTED, b"m 125 -43 -82\r", "motor speeds, in ticks a frame: 125 -43 -82"),
        (REPORTED, b"OK\r\n", "answer to motor speeds, in ticks a frame: OK"),
        (REQUESTED, b"e\r", "read encoders"),
        (REPORTED, b"1390 -606 -776\r\n", "answer to read encoders: 1390 -606 -776"),
        (REQUESTED, b"?!\r", "no command that is known: '?!'"),
        (REPORTED, b"Invalid Command\r\n", "answer: Invalid Command"),
        # A host that ends its lines with CR LF: the sketch takes the last character before the first space.
        (REQUESTED, b"\ne\r", "read encoders"),
        (REQUESTED, b"\nm 20 20\r", "motor speeds, in ticks a frame: 20 20"),
    ),
    # adioe.pde and adio.m: a letter, and bytes from '0' or 'a' on.
    ShieldProtocol.ARDUINOIO: (
        (REQUESTED, b"99", "9, who is it: second letter 9"),
        (REPORTED, b"4\r\n", "answer to who is it: 4"),
        (REQUESTED, arduinoio.encode("B", 3, ord("b")), "B, motor: f, b or r: motor 3, value b"),
        (REQUESTED, arduinoio.encode("A", 1, 200), "A, motor's speed: motor 1, value 200"),
        (REQUESTED, arduinoio.encode("G", 2), "G, read an encoder: encoder 2"),
        (REPORTED, b"-12\r\n", "answer to read an encoder: -12"),
        (REPORTED, b"what\r\n", "answer to read an encoder: 'what'"),
    ),
    # MWProtocolBase's frames; the libraries' numbers are those that the board has reported.
    ShieldProtocol.MW: (
        (REPORTED, mw.BANNER, "the board has begun"),
        (REQUESTED, mw.encode_request(messages.GetServerInfo(), 1), "#1 getServerInfo"),
        (
            REPORTED,
            mw.encode_answer(0x01, mw.COMMANDS[mw.CORE, 0x01].answer.encode(INFO)),
            "answer to getServerInfo: major 17, minor 1, board UNO, traces 0, libraries RotaryEncoder, I2C",
        ),
        (
            REQUESTED,
            mw.encode_request(messages.ReadCount(2, 0), 9, ("RotaryEncoder",)),
            "#9 readCount: encoder 2, reset 0",
        ),
        (
            REPORTED,
            mw.encode_answer(0x04, b"\xfe\xff\xff\xff\x10\0\0\0\x01"),
            "answer to readCount: count -2, millis 16, overflow 1",
        ),
        (REPORTED, mw.encode_answer(0x05, b"\x01"), "answer to command 0x05: 01"),
        (REPORTED, b"\xa5\x00\x00\x02\x04\x00", "a frame whose check sum is wrong"),
        (REPORTED, b"\xa5\x01\x02hi", "trace: hi"),
        (REQUESTED, mw.encode_frame(mw.RequestFrame(5, 7, 0x33, b"\x01\x02")), "#5 command 0x33: 01 02"),
    ),
    # firmata/protocol: protocol.md, i2c.md, encoder.md.
    ShieldProtocol.FIRMATA: (
        (REPORTED, bytes.fromhex("F90205"), "protocol version: 02 05"),
        (REQUESTED, firmata.exclusive(firmata.FIRMWARE), "firmware"),
        (
            REPORTED,
            firmata.exclusive(firmata.FIRMWARE, b"\x02\x05" + firmata.pairs(b"Std.ino")),
            "firmware: 2.5 Std.ino",
        ),
        (
            REQUESTED,
            firmata.i2c_write(motor_shield.ADDRESS, SPEED),
            f"I2C request: write 0x60: {SPEED.hex(' ').upper()}, pwm of M1 = 70",
        ),
        (
            REPORTED,
            firmata.exclusive(firmata.I2C_REPLY, firmata.pairs((0x60, 0xFE, 0x03))),
            "I2C reply: 0x60 from register 0xFE: 03",
        ),
        (REQUESTED, bytes.fromhex("F061000102 03F7"), "encoder, attach: 1 2 3"),
        (REQUESTED, bytes.fromhex("F0610101F7"), "encoder, report: 1"),
        (REPORTED, bytes.fromhex("F0614150080000F7"), "encoder: count -1104 of encoder 1"),
        (REQUESTED, b"\xe3\x7f\x01", "analog I/O 3: 7F 01"),
        (REQUESTED, firmata.exclusive(0x11, b"\x01"), "command 0x11: 01"),
    ),
    # AR2_2.0: letters and numbers; what comes back has no line's end but an echo's.
    Ar2Firmware.AR2_2_0: (
        (REQUESTED, wire.test("q1"), "TM, echo: q1"),
        (REPORTED, wire.echo("q1"), "sent 'q1\\n\\r\\n'"),
        (
            REQUESTED,
            wire.move((0, 1, -3, 0, 1, 0, 7), 2.5),
            "MJ, joint move: J2 +1, J3 -3, J5 +1, track +7, S 2.5, G 0, H 100, I 0, K 100",
        ),
        (REQUESTED, wire.move((0,), 1e-05), "MJ, joint move: no steps, S 1e-05, G 0, H 100, I 0, K 100"),
        (REQUESTED, b"WTS1.5\n", "WT, wait: S 1.5"),
        (
            REQUESTED,
            b"MJA170000B032768C132767S25G15\n",
            "MJ, joint move: J1 +70000 (in the board's 16 bits +4464), J2 -32768, J3 +32767, S 25, G 15",
        ),
        (REQUESTED, b"QQ\n", "no command that is known: 'QQ'"),
    ),
}  # fmt: skip


def words(kind: str, stated: Iterator[tuple[str, bytes]]) -> list[str]:
    """Return a dissector's texts for chunks, behind sender and bytes."""
    dissector = Dissector({"line": kind})
    texts = [dissector.read(Carried(0, "line", who, Packet("line", 0, chunk))) for who, chunk in stated]
    return [text.split("  ", 4)[4] for text in texts]


@every(("kind", "rows"), GOLDEN.items())
def test_what_is_stated_is_reported(kind: str, rows: tuple[Stated, ...]) -> None:
    assert words(kind, ((who, chunk) for who, chunk, _ in rows)) == [text for _, _, text in rows]


def byte_by_byte(chunk: bytes) -> list[bytes]:
    return [bytes((byte,)) for byte in chunk]


def in_halves(chunk: bytes) -> list[bytes]:
    return [part for part in (chunk[: len(chunk) // 2], chunk[len(chunk) // 2 :]) if part]


@every(("kind", "cut"), [(kind, cut) for kind in ShieldProtocol for cut in (byte_by_byte, in_halves)])
def test_however_a_line_is_cut_each_command_is_reported_once_with_its_end(
    kind: str, cut: Callable[[bytes], list[bytes]]
) -> None:
    rows = GOLDEN[kind]
    reported = words(kind, ((who, part) for who, chunk, _ in rows for part in cut(chunk)))
    assert [text for text in reported if not text.startswith("part of a ")] == [text for _, _, text in rows]


@given(
    st.sampled_from(sorted(kinds())),
    st.lists(
        st.tuples(st.sampled_from((REQUESTED, REPORTED)), st.integers(0, 0x1FF), st.binary(max_size=80))
    ),
)
def test_whatever_bytes_come_there_are_words(kind: str, sent: list[tuple[str, int, bytes]]) -> None:
    dissector = Dissector({"line": kind})
    for who, address, payload in sent:
        text = dissector.read(Carried(0, "line", who, Packet("line", address, payload)))
        assert text.isprintable()


@given(
    st.sampled_from(sorted(GOLDEN)),
    st.data(),
)
def test_neither_do_damaged_commands_stop_it(kind: str, data: st.DataObject) -> None:
    dissector = Dissector({"line": kind})
    for who, chunk, _ in GOLDEN[kind]:
        place = data.draw(st.integers(0, len(chunk) - 1))
        damaged = chunk[:place] + data.draw(st.binary(max_size=3)) + chunk[place + 1 :]
        assert dissector.read(Carried(0, "line", who, Packet("line", 0, damaged))).isprintable()


def test_a_robots_links_are_read_by_what_its_file_states_of_them() -> None:
    assert kinds_of(find("rome_arm")) == {
        "board": ShieldProtocol.ROS_ARDUINO_BRIDGE,
        "arm": Ar2Firmware.AR2_2_0,
    }
    seen = kinds_of(over_protocol(find("rome+cameras"), "firmata"))
    assert seen == {"board": ShieldProtocol.FIRMATA, "cameras": CaptureDriver.NATNET}
    assert set(seen.values()) < set(kinds())


@given(
    st.lists(st.integers(-wire.MOST_STEPS, wire.MOST_STEPS), min_size=1, max_size=7),
    st.floats(1e-3, 100.0),
)
def test_a_move_is_read_as_it_was_written(steps: list[int], speed: float) -> None:
    read = wire.decode(wire.move(steps, speed)[: -len(wire.END)])
    assert read is not None
    assert [read.steps[letter] for letter in wire.LETTERS[: len(steps)]] == steps
    assert read.fields["S"] == f"{speed:g}"


def test_a_host_that_ends_its_lines_with_a_line_feed_alone_is_reported_what_the_sketch_waits_for() -> None:
    line = RosLine()
    end = "part of a line: the sketch waits for a carriage return (CR), a line feed ends none"
    assert line.read(REQUESTED, Packet("board", 0, b"m 20 20\n")) == end
    assert line.read(REQUESTED, Packet("board", 0, b"e\n")) == end
    crlf = RosLine()
    assert crlf.read(REQUESTED, Packet("board", 0, b"e\r\n")) == "read encoders"
    assert crlf.read(REQUESTED, Packet("board", 0, b"m 1 2\r\n")) == "motor speeds, in ticks a frame: 1 2"
