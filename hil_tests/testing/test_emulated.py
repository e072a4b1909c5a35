"""Devices in real time, before they are started: which bus, whose turn, and what cannot be."""

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from emulators.testing import buses, emulated
from emulators.testing.buses import GROUPS, Bus, Turns
from emulators.testing.errors import RigError
from emulators.testing.process import Process
from hil_tests.rows import every


def never(words: Sequence[str]) -> Process:
    raise AssertionError(f"nothing is to be started: {words}")


@pytest.fixture
def interfaces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(buses, "INTERFACES", tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def test_vcan_is_taken_where_it_is_and_else_datagrams(interfaces: Path) -> None:
    assert buses.buses(None)[0] == Bus("loopback_multicast", GROUPS[0])
    assert buses.buses("vcan") == (Bus("socketcan", "vcan0"),), "so that its absence is reported by its name"
    for name in ("vcan1", "can0", "vcan0"):
        (interfaces / name).touch()
    assert buses.buses(None) == (Bus("socketcan", "vcan0"), Bus("socketcan", "vcan1"))
    for kind in ("loopback_multicast", "udp_multicast"):
        assert buses.buses(kind)[0].interface == kind
    assert buses.buses("pcan:PCAN_USBBUS1") == (Bus("pcan", "PCAN_USBBUS1"),)


@pytest.mark.usefixtures("interfaces")
def test_two_tests_at_once_are_on_two_buses_and_one_that_is_given_back_is_taken_again() -> None:
    several = (Bus("one", "a/b"), Bus("two", "c"))
    first, second = Turns(), Turns()
    assert first.takes(several) == several[0]
    assert second.takes(several) == several[1]
    first.finish()
    third = Turns()
    assert third.takes(several) == several[0]
    for one in (second, third):
        one.finish()


@every(
    ("wrong", "stated"),
    [
        (lambda _: buses.buses("virtual:x"), "inside one process"),
        (
            lambda _: buses.buses("can0"),
            "there is no bus 'can0'; use vcan, loopback_multicast or INTERFACE:CHANNEL",
        ),
        (lambda folder: emulated.Boards(never, folder)("mw", protocol="firmata"), "mw speaks one protocol"),
        (lambda folder: emulated.Boards(never, folder)("ar2", protocol="mw"), "ar2 speaks one protocol"),
        (lambda folder: emulated.Boards(never, folder)("rars"), "rars has not one board"),
        (lambda folder: emulated.Boards(never, folder)("rome_arm"), "rome_arm has not one board"),
        (
            lambda folder: emulated.Boards(never, folder)("rome", protocol="rs232"),
            "no protocol 'rs232'; there are mw",
        ),
        (lambda folder: emulated.Drives(never, folder).lose_power("2"), "no drives '2' .*: none yet"),
        (lambda folder: emulated.Drives(never, folder).fault("drive_restart"), "which drives?.*: none"),
        (lambda folder: emulated.Boards(never, folder).fault("board_reset"), "no board was started"),
    ],
)
def test_what_cannot_be_is_stated_in_one_line(
    tmp_path: Path, wrong: Callable[[Path], object], stated: str
) -> None:
    with pytest.raises(RigError, match=stated) as error:
        wrong(tmp_path)
    assert "\n" not in str(error.value)
