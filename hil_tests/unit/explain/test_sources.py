"""Recordings in every format give the same frames; what cannot be read gives one message."""

import gzip
import lzma
import struct
from collections.abc import Callable
from pathlib import Path

import can
import pytest

from firmware_bridge.explain.source import Frame, UnreadableError, frames
from firmware_bridge.recording import EPOCH
from firmware_bridge.units import MICROSECOND, SECOND

FRAMES: list[Frame] = [
    (1_000_000, "can0", 0x701, b"\0"),
    (2_000_000, "can0", 0x181, b"\x40\x07"),
    (3_000_000, "can0", 0x601, bytes.fromhex("4041600000000000")),
    (4_000_000, "can0", 0x080, b""),
]
START = EPOCH // SECOND


def candump() -> str:
    return "".join(
        f"({START}.{at // MICROSECOND:06d}) {bus} {address:03X}#{payload.hex().upper()}\n"
        for at, bus, address, payload in FRAMES
    )


def on_screen() -> str:
    return "".join(
        f" ({START}.{at // MICROSECOND:06d})  {bus}  {address:03X}"
        f"   [{len(payload)}]  {payload.hex(' ').upper()}\n"
        for at, bus, address, payload in FRAMES
    )


def record(address: int, payload: bytes) -> bytes:
    return struct.pack(">IBxxx", address, len(payload)) + payload


def pcap(order: str = "<", *, nano: bool = False, link_type: int = 227) -> bytes:
    ticks = 1 if nano else MICROSECOND
    made = struct.pack(f"{order}IHHiIII", 0xA1B23C4D if nano else 0xA1B2C3D4, 2, 4, 0, 0, 65535, link_type)
    for at, _, address, payload in FRAMES:
        one = record(address, payload)
        made += struct.pack(f"{order}IIII", START, at // ticks, len(one), len(one)) + one
    return made


def block(order: str, kind: int, body: bytes) -> bytes:
    body += bytes(-len(body) % 4)
    length = len(body) + 12
    return struct.pack(f"{order}II", kind, length) + body + struct.pack(f"{order}I", length)


def pcapng(order: str = "<", *, link_type: int = 227) -> bytes:
    made = block(order, 0x0A0D0D0A, struct.pack(f"{order}IHHq", 0x1A2B3C4D, 1, 0, -1))
    options = struct.pack(f"{order}HH", 2, 4) + b"can0" + struct.pack(f"{order}HHBxxx", 9, 1, 9)
    made += block(order, 1, struct.pack(f"{order}HHI", link_type, 0, 0) + options + bytes(4))
    for at, _, address, payload in FRAMES:
        one, instant = record(address, payload), EPOCH + at
        head = struct.pack(f"{order}IIIII", 0, instant >> 32, instant & 0xFFFF_FFFF, len(one), len(one))
        made += block(order, 6, head + one)
    return made


def read(path: Path) -> list[Frame]:
    notes: list[str] = []
    found = list(frames(path, notes.append))
    assert notes == []
    return found


def written_by(suffix: str, path: Path) -> None:
    """Write the frames as python-can does."""
    with can.Logger(str(path.with_suffix(suffix))) as logger:
        for at, _, address, payload in FRAMES:
            stamp = (EPOCH + at) / SECOND
            logger(can.Message(stamp, address, is_extended_id=False, data=payload, channel=0))


@pytest.mark.parametrize(
    ("name", "contents"),
    [
        ("can.log", lambda: candump().encode()),
        ("can.log.gz", lambda: gzip.compress(candump().encode())),
        ("can.log.xz", lambda: lzma.compress(candump().encode())),
        ("screen.txt", lambda: on_screen().encode()),
        ("direction.log", lambda: candump().replace("\n", " R\n").encode()),
        ("a.pcap", pcap),
        ("big.pcap", lambda: pcap(">")),
        ("nano.pcap", lambda: pcap(nano=True)),
        ("a.pcapng", pcapng),
        ("big.pcapng", lambda: pcapng(">")),
    ],
)
def test_each_format_gives_the_frames(name: str, contents: Callable[[], bytes], tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(contents())
    assert read(path) == FRAMES


@pytest.mark.parametrize("suffix", [".asc", ".blf", ".trc"])
def test_other_tools_formats_give_the_frames(suffix: str, tmp_path: Path) -> None:
    written_by(suffix, tmp_path / "one")
    found = read(tmp_path / f"one{suffix}")
    assert [(address, payload) for _, _, address, payload in found] == [frame[2:] for frame in FRAMES]


def test_a_run_s_folder_has_its_recording(tmp_path: Path) -> None:
    (tmp_path / "can.log").write_text(candump())
    (tmp_path / "serial.log").touch()
    assert read(tmp_path) == FRAMES


def test_29_bits_and_errors_keep_their_flags(tmp_path: Path) -> None:
    path = tmp_path / "can.log"
    lines = ("18DAF110#00", "20000040#00", "181#R2")
    path.write_text("".join(f"({START}.00000{at}) can0 {line}\n" for at, line in enumerate(lines)))
    assert [address for _, _, address, _ in read(path)] == [0x98DA_F110, 0x2000_0040, 0x4000_0181]


@pytest.mark.parametrize(
    ("name", "contents", "why"),
    [
        ("empty.log", b"", "the file is empty"),
        ("garbage.log", bytes(range(1, 256)) * 4, "no line of a candump log"),
        ("garbage.pcapng", b"\xde\xad\xbe\xef" * 20, "no pcap and no pcapng"),
        ("short.pcapng", b"\x0a\x0d", "no pcap and no pcapng"),
        ("cut.pcapng", pcapng()[:70], "cut off before the first frame"),
        ("ethernet.pcap", pcap(link_type=1), "link type is 1, not 227"),
        ("ethernet.pcapng", pcapng(link_type=1), "link type is 1, not 227"),
        ("garbage.log.gz", b"no gzip", "cannot be read"),
        ("garbage.log.xz", b"no xz", "cannot be read"),
        ("garbage.blf", b"no blf" * 50, "no recording of the format .blf"),
        ("screen.log", b"  can0  181   [2]  40 07\n", "what candump shows has no times"),
        ("serial.log", b"(1577836803.000000000) board T 65 0D\n", "a line of bytes of a serial line"),
    ],
)
def test_what_cannot_be_read_gives_one_message(name: str, contents: bytes, why: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(contents)
    with pytest.raises(UnreadableError, match=why) as caught:
        list(frames(path, lambda _: None))
    assert str(path) in str(caught.value)


def test_a_folder_without_a_recording_gives_one_message(tmp_path: Path) -> None:
    with pytest.raises(UnreadableError, match=r"holds no can\.log"):
        list(frames(tmp_path, lambda _: None))


@pytest.mark.parametrize(
    ("name", "contents"),
    [
        ("can.log", candump().encode()[:-8]),
        ("a.pcap", pcap()[:-3]),
        ("a.pcapng", pcapng()[:-3]),
    ],
)
def test_an_end_that_is_cut_off_is_remarked_and_the_rest_is_read(
    name: str, contents: bytes, tmp_path: Path
) -> None:
    path = tmp_path / name
    path.write_bytes(contents)
    notes: list[str] = []
    assert list(frames(path, notes.append)) == FRAMES[:3]
    assert len(notes) == 1
    assert "its end is cut off" in notes[0]


def test_frames_of_can_fd_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "can.log"
    path.write_text(candump() + f"({START}.000009) can0 123##1" + "00" * 12 + "\n")
    notes: list[str] = []
    assert list(frames(path, notes.append)) == FRAMES
    assert "CAN FD" in notes[0]
