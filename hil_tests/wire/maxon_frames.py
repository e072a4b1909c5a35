"""Complete exchanges of the serial protocols, as bytes on the line and with their meaning.

Recorded: maxon's EPOS2 Application Notes Collection, April 2013, p. 11-164 and 11-166; EPOS Communication
Guide, October 2006; a driver for an EPOS2 on USB; EPOS4 Communication Guide, p. 2-17 to 2-19. The others are
computed by the rules of those documents with values that no device has sent.
"""

from dataclasses import dataclass

from firmware_bridge.families.epos2.maxon.messages import (
    Answer,
    Done,
    FrameRead,
    InitiateSegmentedRead,
    ObjectRead,
    ReadLssFrame,
    ReadObject,
    Request,
    RequestCanFrame,
    SegmentOut,
    SegmentRead,
    SendLssFrame,
    SendNmtService,
    WriteObject,
)


@dataclass(frozen=True)
class Exchange:
    name: str
    request: Request
    answer: Answer
    v1: tuple[str, str] | None = None
    """Request and answer; the answer is empty where V1 has none."""
    v2: tuple[str, str] | None = None
    recorded: bool = False

    def __str__(self) -> str:
        return self.name


OKAY = Done(0)


def _control(value: int, request: str) -> Exchange:
    write = WriteObject(0x6040, 0, 0, value.to_bytes(4, "little"))
    # The answer is computed: only the requests were found.
    answer = "90 02 00 02 00 00 00 00 40 8B"
    return Exchange(f"controlword {value:04X}, driver", write, OKAY, v2=(request, answer), recorded=True)


def _profile(index: int, value: int, request: str) -> Exchange:
    write = WriteObject(index, 0, 0, value.to_bytes(4, "little"))
    answer = "90 02 00 02 00 00 00 00 40 8B"
    return Exchange(f"{index:04X} = {value}, driver", write, OKAY, v2=(request, answer), recorded=True)


RECORDED = (
    Exchange(
        "device type of node 2, application notes",
        ReadObject(0x1000, 0, 2),
        ObjectRead(0, bytes.fromhex("92010200")),
        ("10 01 00 10 00 02 10 CD", "00 03 00 00 00 00 92 01 02 00 EB 6D"),
        ("90 02 10 02 00 10 00 02 DF F2", "90 02 00 04 00 00 00 00 92 01 02 00 9A ED"),
        recorded=True,
    ),
    Exchange(
        "version of node 2, communication guide",
        ReadObject(0x2003, 1, 2),
        ObjectRead(0, bytes.fromhex("10201062")),
        ("10 01 03 20 01 02 88 A8", "00 03 00 00 00 00 10 20 10 62 10 26"),
        recorded=True,
    ),
    _control(0x0006, "90 02 11 04 40 60 00 00 06 00 00 00 1C F7"),
    _control(0x000F, "90 02 11 04 40 60 00 00 0F 00 00 00 8D 69"),
    _control(0x010F, "90 02 11 04 40 60 00 00 0F 01 00 00 39 1F"),
    _control(0x0000, "90 02 11 04 40 60 00 00 00 00 00 00 BC 45"),
    _control(0x003F, "90 02 11 04 40 60 00 00 3F 00 00 00 28 AC"),
    _control(0x007F, "90 02 11 04 40 60 00 00 7F 00 00 00 85 B1"),
    _profile(0x6081, 2500, "90 02 11 04 81 60 00 00 C4 09 00 00 88 82"),
    _profile(0x6083, 40000, "90 02 11 04 83 60 00 00 40 9C 00 00 2B 7F"),
    _profile(0x6084, 40000, "90 02 11 04 84 60 00 00 40 9C 00 00 6F 66"),
)

COMPUTED = (
    Exchange(
        "statusword",
        ReadObject(0x6041, 0, 1),
        ObjectRead(0, bytes.fromhex("40010000")),
        ("10 01 41 60 00 01 AB F0", "00 03 00 00 00 00 40 01 00 00 5D 46"),
        ("90 02 10 02 41 60 00 01 64 CF", "90 02 00 04 00 00 00 00 40 01 00 00 2C C6"),
    ),
    Exchange(
        "product code of node 0",
        ReadObject(0x1018, 2, 0),
        ObjectRead(0, bytes.fromhex("00002064")),
        ("10 01 18 10 02 00 F2 61", "00 03 00 00 00 00 00 00 20 64 C8 CE"),
        ("90 02 10 02 18 10 02 00 3D 5E", "90 02 00 04 00 00 00 00 00 00 20 64 B9 4E"),
    ),
    Exchange(
        "software version",
        ReadObject(0x2003, 1, 1),
        ObjectRead(0, bytes.fromhex("26210000")),
        ("10 01 03 20 01 01 DB FD", "00 03 00 00 00 00 26 21 00 00 D8 58"),
        ("90 02 10 02 03 20 01 01 14 C2", "90 02 00 04 00 00 00 00 26 21 00 00 A9 D8"),
    ),
    Exchange(
        "position 0x9090, stuffed",
        ReadObject(0x6064, 0, 1),
        ObjectRead(0, bytes.fromhex("90900000")),
        ("10 01 64 60 00 01 9D 9D", "00 03 00 00 00 00 90 90 00 00 E2 93"),
        ("90 02 10 02 64 60 00 01 52 A2", "90 02 00 04 00 00 00 00 90 90 90 90 00 00 93 13"),
    ),
    Exchange(
        "no such object",
        ReadObject(0x5555, 0, 1),
        ObjectRead(0x0602_0000, bytes(4)),
        ("10 01 55 55 00 01 A4 FF", "00 03 00 00 02 06 00 00 00 00 26 E4"),
        ("90 02 10 02 55 55 00 01 6B C0", "90 02 00 04 00 00 02 06 00 00 00 00 57 64"),
    ),
    Exchange(
        "no such sub-index",
        ReadObject(0x6040, 99, 1),
        ObjectRead(0x0609_0011, bytes(4)),
        ("10 01 40 60 63 01 5E 9B", "00 03 11 00 09 06 00 00 00 00 C3 87"),
        ("90 02 10 02 40 60 63 01 91 A4", "90 02 00 04 11 00 09 06 00 00 00 00 B2 07"),
    ),
    Exchange(
        "shutdown",
        WriteObject(0x6040, 0, 1, bytes.fromhex("06000000")),
        OKAY,
        ("11 03 40 60 00 01 06 00 00 00 C3 71", "00 01 00 00 00 00 51 AA"),
        ("90 02 11 04 40 60 00 01 06 00 00 00 BC B2", "90 02 00 02 00 00 00 00 40 8B"),
    ),
    Exchange(
        "write a read-only object",
        WriteObject(0x6041, 0, 1, bytes.fromhex("01000000")),
        Done(0x0601_0002),
        ("11 03 41 60 00 01 01 00 00 00 32 4C", "00 01 02 00 01 06 B6 7E"),
        ("90 02 11 04 41 60 00 01 01 00 00 00 4D 8F", "90 02 00 02 02 00 01 06 A7 5F"),
    ),
    Exchange(
        "save",
        WriteObject(0x1010, 1, 1, b"save"),
        OKAY,
        ("11 03 10 10 01 01 73 61 76 65 19 77", "00 01 00 00 00 00 51 AA"),
        ("90 02 11 04 10 10 01 01 73 61 76 65 66 B4", "90 02 00 02 00 00 00 00 40 8B"),
    ),
    Exchange(
        "begin to read the name",
        InitiateSegmentedRead(0x1008, 0, 1),
        OKAY,
        ("12 01 08 10 00 01 A2 BA", "00 01 00 00 00 00 51 AA"),
        ("90 02 12 02 08 10 00 01 AE 4A", "90 02 00 02 00 00 00 00 40 8B"),
    ),
    Exchange(
        "the name",
        SegmentRead(0),
        SegmentOut(0, 5, b"EPOS2"),
        ("14 00 00 00 56 D1", "00 04 00 00 00 00 05 45 50 4F 53 32 DC B6"),
        ("90 02 14 01 00 00 17 E9", "90 02 00 05 00 00 00 00 05 45 50 4F 53 32 3A E9"),
    ),
    Exchange(
        "start all nodes",
        SendNmtService(0, 1),
        OKAY,
        ("0E 01 00 00 01 00 D3 3A", ""),
        ("90 02 0E 02 00 00 01 00 C9 54", "90 02 00 02 00 00 00 00 40 8B"),
    ),
    Exchange(
        "request a frame",
        RequestCanFrame(0x181, 2),
        FrameRead(0, bytes.fromhex("4007000000000000")),
        ("21 01 81 01 02 00 65 80", "00 05 00 00 00 00 40 07 00 00 00 00 00 00 3A 5A"),
        ("90 02 21 02 81 01 02 00 39 73", "90 02 00 06 00 00 00 00 40 07 00 00 00 00 00 00 93 11"),
    ),
    Exchange(
        "all slaves to configuration",
        SendLssFrame(bytes.fromhex("0401000000000000")),
        OKAY,
        ("30 03 04 01 00 00 00 00 00 00 CA 06", "00 01 00 00 00 00 51 AA"),
        ("90 02 30 04 04 01 00 00 00 00 00 00 22 DF", "90 02 00 02 00 00 00 00 40 8B"),
    ),
    Exchange(
        "a slave's answer",
        ReadLssFrame(500),
        FrameRead(0, bytes.fromhex("4400000000000000")),
        ("31 00 F4 01 F7 C6", "00 05 00 00 00 00 44 00 00 00 00 00 00 00 E4 5C"),
        ("90 02 31 01 F4 01 8B 18", "90 02 00 06 00 00 00 00 44 00 00 00 00 00 00 00 4D 17"),
    ),
)
EXCHANGES = (*RECORDED, *COMPUTED)
EPOS4_STUFFED = (
    (0x60, "01B03000", "90 02 60 02 01 B0 30 00 2E 62"),
    (0x00, "0000000001900000", "90 02 00 04 00 00 00 00 01 90 90 00 00 9A 5C"),
)
"""Opcode, data and bytes of an EPOS4 (EPOS4 Communication Guide, p. 2-17 to 2-19): the same link layer."""
