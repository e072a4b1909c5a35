"""The types of EPOS2: their identity and limits on the bus, and that what is not known is marked."""

import pytest

from emulators.epos2.drive import Epos2
from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.device_profile import DeviceProfile
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen.object_row import Provenance
from hil_tests.unit.epos2.quiet_motion import Desk, powered

NAMES = list(PROFILES)
# Hardware versions from firmware file names and users' drivers; continuous currents from the types' names.
KNOWN = {
    "24/2": (0, 2_000),
    "24/5": (0x6220, 5_000),
    "36/2": (0x6120, 2_000),
    "50/5": (0x6322, 5_000),
    "50/5-6320": (0x6320, 5_000),
    "70/10": (0x6420, 10_000),
}


@pytest.fixture(params=NAMES)
def profile(request: pytest.FixtureRequest) -> DeviceProfile:
    return PROFILES[request.param]


@pytest.mark.parametrize("name", NAMES)
def test_a_type_states_who_it_is(name: str) -> None:
    desk = powered(PROFILES[name])
    hardware, continuous = KNOWN[name]
    assert desk.reads(0x1018, 1) == 0xFB
    assert desk.reads(0x1018, 2) == hardware << 16
    assert desk.reads(0x2003, 2) == hardware
    assert desk.reads(0x6410, 1) == continuous


def test_the_current_limits_are_the_types_own(profile: DeviceProfile) -> None:
    desk = powered(profile)
    for subindex, most in ((1, profile.continuous_current_ma), (2, profile.peak_current_ma)):
        assert desk.reads(0x6410, subindex) == most
        assert desk.writes(0x6410, subindex, most.to_bytes(2, "little")) == "ok"
        assert desk.writes(0x6410, subindex, (most + 1).to_bytes(2, "little")) == "06090031"
        assert desk.writes(0x6410, subindex, bytes(2)) == "ok"


def test_the_hardware_cuts_off_where_the_type_does(profile: DeviceProfile) -> None:
    axis = ServoAxis("desk", 2000)
    Epos2(1, axis, profile)
    assert axis.over_current_ma == profile.over_current_ma > profile.peak_current_ma
    assert axis.over_voltage_mv == profile.over_voltage_mv > profile.supply_v * 1000


@pytest.mark.parametrize(
    "name", ["hardware_version", "order_numbers", "continuous_current_ma", "peak_current_ma", "supply_v"]
)
def test_each_figure_states_how_far_it_is_known(name: str, profile: DeviceProfile) -> None:
    mark = profile.known(name)
    assert mark.source
    if not getattr(profile, name):
        assert mark.provenance is Provenance.ASSUMED


def test_a_peak_current_without_a_document_is_an_assumption() -> None:
    proven = {
        name for name in NAMES if PROFILES[name].known("peak_current_ma").provenance is Provenance.PROVEN
    }
    assert proven == {"50/5", "70/10"}


def test_what_the_50_5_has_otherwise_than_the_70_10() -> None:
    """maxon's EDS of the 50/5 (347717)."""
    desk, other = powered(PROFILES["50/5"]), powered(PROFILES["70/10"])
    for index, subindex, value, in_70_10 in (
        (0x2070, 0, 10, 9),
        (0x2070, 10, 6, "06090011"),
        (0x2071, 2, 0xE3C7, 0xE387),
        (0x202E, 0, 11, 12),
        (0x202E, 12, "06090011", 0),
        (0x207E, 0, 0, "06020000"),
    ):
        assert desk.reads(index, subindex) == value, f"{index:04X}:{subindex}"
        assert other.reads(index, subindex) == in_70_10, f"{index:04X}:{subindex}"
    assert desk.writes(0x207E, 0, b"\x34\x12") == "ok"
    assert desk.reads(0x207E) == 0x1234
    assert powered(PROFILES["50/5-6320"]).reads(0x207E) == "06020000"


def test_the_analog_output_of_the_50_5_is_carried_by_a_receive_pdo() -> None:
    mapping = ((0x1600, 0, b"\0"), (0x1600, 1, (0x207E_0010).to_bytes(4, "little")), (0x1600, 0, b"\x01"))
    desk, other = powered(PROFILES["50/5"]), powered(PROFILES["70/10"])
    assert [desk.writes(*write) for write in mapping] == ["ok"] * 3
    desk.receives("000#0101")
    desk.receives("201#CDAB")
    assert desk.reads(0x207E) == 0xABCD
    assert other.writes(*mapping[0]) == "ok"
    assert other.writes(*mapping[1]) == "06040041"


def test_the_70_10_is_as_before_the_others_came() -> None:
    desk = Desk()
    desk.powers()
    assert desk.reads(0x6410, 2) == 25_000
    assert desk.drive.profile.over_current_ma == 37_500
    assert desk.drive.profile.over_voltage_mv == 75_000
