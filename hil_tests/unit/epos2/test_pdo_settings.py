"""Valid writes to the objects of a PDO, and the procedure by which its mapping changes."""

from dataclasses import replace

import pytest

from emulators.epos2.objects.device_profile import EPOS2_70_10
from hil_tests.unit.epos2.quiet_motion import powered, set_up, u32


@pytest.mark.parametrize(
    ("index", "raw", "answer"),
    [
        (0x1400, 0x0000_0181, "ok"),
        (0x1400, 0x0000_057F, "ok"),
        (0x1400, 0x0000_0180, "06090030"),
        (0x1400, 0x0000_0580, "06090030"),
        (0x1400, 0x8000_0000, "ok"),
        (0x1400, 0x0000_0000, "06090030"),
        (0x1400, 0x2000_0201, "06090030"),
        (0x1400, 0x0001_0201, "06090030"),
        (0x1800, 0xC000_0181, "ok"),
        (0x1800, 0x0000_0181, "ok"),
    ],
)
def test_which_identifiers_a_pdo_takes(index: int, raw: int, answer: str) -> None:
    assert powered().writes(index, 1, u32(raw)) == answer


@pytest.mark.parametrize("index", [0x1400, 0x1403, 0x1800, 0x1803])
def test_which_transmission_types_there_are(index: int) -> None:
    desk = powered()
    known = {1, 255} if index < 0x1800 else {1, 253, 255}
    for kind in range(256):
        assert desk.writes(index, 2, bytes((kind,))) == ("ok" if kind in known else "06090030")


STRICT = replace(EPOS2_70_10, mapping_needs_invalid_pdo=True)
MAPPING_REFUSALS = [
    # While the PDO is valid, while it has entries, outside Pre-Operational.
    ([], (0x1600, 0, b"\0"), "06010000"),
    ([], (0x1600, 1, u32(0x6040_0010)), "06010000"),
    ([(0x1400, 1, u32(0x8000_0201))], (0x1600, 1, u32(0x6040_0010)), "06010000"),
    ([(0x1400, 1, u32(0x8000_0201))], (0x1600, 0, b"\x09"), "06090031"),
    ([(0x1400, 1, u32(0x8000_0201))], (0x1600, 0, b"\x02"), "06040041"),
]


@pytest.mark.parametrize(("before", "write", "answer"), MAPPING_REFUSALS)
def test_a_mapping_changes_by_its_procedure_only(
    before: list[tuple[int, int, bytes]], write: tuple[int, int, bytes], answer: str
) -> None:
    desk = set_up(powered(STRICT), *before)
    assert desk.writes(*write) == answer
    desk.receives("000#0101")
    assert desk.writes(0x1600, 0, b"\0") == "0F00FFC0"
    assert desk.writes(0x1600, 1, u32(0x6040_0010)) == "0F00FFC0"


def test_by_default_only_the_number_of_entries_has_to_be_0() -> None:
    desk = powered()
    assert desk.writes(0x1600, 1, u32(0x6040_0010)) == "06010000"
    assert desk.writes(0x1600, 0, b"\0") == "ok"
    assert desk.writes(0x1600, 1, u32(0x6060_0008)) == "ok"


@pytest.mark.parametrize(
    "entry",
    [
        0x5555_0010,  # no object
        0x6040_0108,  # no sub-index
        0x6041_0010,  # read-only into a receive PDO
        0x6007_0010,  # not mappable
        0x6040_0008,  # half of it
        0x6040_0020,  # twice its length
        0x0005_0008,  # the EDS has no dummy objects
    ],
)
def test_what_cannot_be_mapped(entry: int) -> None:
    desk = set_up(powered(), (0x1400, 1, u32(0x8000_0201)), (0x1600, 0, b"\0"))
    assert desk.writes(0x1600, 1, u32(entry)) == "06040041"
    assert desk.reads(0x1600, 1) == 0x6040_0010


def test_more_than_eight_bytes_are_refused_at_the_count() -> None:
    desk = set_up(
        powered(),
        (0x1400, 1, u32(0x8000_0201)),
        (0x1600, 0, b"\0"),
        (0x1600, 1, u32(0x607A_0020)),
        (0x1600, 2, u32(0x60FF_0020)),
        (0x1600, 3, u32(0x6060_0008)),
    )
    assert desk.writes(0x1600, 0, b"\x03") == "06040042"
    assert desk.writes(0x1600, 0, b"\x02") == "ok"


def test_eight_entries_of_one_byte_are_possible() -> None:
    desk = set_up(
        powered(),
        (0x1800, 1, u32(0xC000_0181)),
        (0x1A00, 0, b"\0"),
        *((0x1A00, place, u32(0x6061_0008)) for place in range(1, 9)),
        (0x1A00, 0, b"\x08"),
        (0x1800, 1, u32(0x4000_0181)),
    )
    assert desk.receives("000#0101") == ["181#0101010101010101"]
