"""Each row's three outcomes from given facts, what listings say, and a look at this machine, no more."""

import socket
from dataclasses import replace
from typing import Any, Final, NoReturn

import pytest
import serial

from emulators.doctor.facts import CanInterface, Facts, Library, SerialPort, interfaces_of, version_of
from emulators.doctor.gather import gather
from emulators.doctor.rows import ROWS, Check, CheckResult, lacks
from firmware_bridge.units import MICROSECOND, MILLISECOND
from hil_tests.rows import every

CAN: Final = CanInterface("can0", up=True, bit_rate=1_000_000, state="ERROR-ACTIVE")
VIRTUAL: Final = CanInterface("vcan0", up=True, virtual=True)
LINE: Final = SerialPort("/dev/ttyUSB0", "FT232R", allowed=True, group="dialout")
WELL: Final = Facts(
    python=(3, 12, 1),
    system="Linux",
    release="6.1.0",
    socketcan=True,
    vcan=True,
    interfaces=(CAN, VIRTUAL),
    ports=(LINE,),
    user="ada",
    resolution=1,
    late=(60 * MICROSECOND, 80 * MICROSECOND, 900 * MICROSECOND),
    load=0.5,
    processors=2,
    compiler="/usr/bin/cc",
    headers=True,
    kernel_built=True,
    kernel_problem="",
    compiled={"packet": True, "world": True},
    plants={"rars": True, "rome_base": True},
    libraries=(Library("rich", (13, 7), (15, 0, 0)), Library("pyserial", (3, 5), (3, 5))),
    extras={"testing": (), "plots": ()},
    unwatched={},
)
"""A machine that has everything."""
OK, CAREFUL, MISSING = CheckResult

OUTCOMES: Final[list[tuple[str, dict[str, Any], CheckResult, str, str]]] = [
    ("Python", {}, OK, "3.12.1", ""),
    ("Python", {"python": (3, 11, 0)}, OK, "3.11.0", ""),
    ("Python", {"python": (3, 15, 0)}, CAREFUL, "3.15.0", "3.11 to 3.14"),
    ("Python", {"python": (3, 10, 9)}, MISSING, "3.10.9", "install Python 3.11"),
    ("libraries", {}, OK, "rich 15.0.0, pyserial 3.5", ""),
    ("libraries", {"libraries": (Library("rich", (13, 7), (13, 6)),)}, CAREFUL, "too old: rich", "upgrade"),
    ("libraries", {"libraries": (Library("rich", (13,), None),)}, MISSING, "not installed: rich", "pip"),
    ("extras", {}, OK, "complete: testing, plots", ""),
    ("extras", {"extras": {}}, OK, "there are none", ""),
    (
        "extras",
        {"extras": {"testing": ("pytest",), "plots": ()}},
        CAREFUL,
        "without testing, the plugin of pytest (pytest)",
        "firmware-bridge[testing]",
    ),
    ("extras", {"extras": {"plots": ("matplotlib",)}}, MISSING, "pictures of runs (matplotlib)", "[plots]"),
    ("C compiler", {}, OK, "/usr/bin/cc", ""),
    ("C compiler", {"headers": False}, CAREFUL, "without Python's headers", "python3-dev"),
    ("C compiler", {"compiler": None, "plants": {"x": False}}, MISSING, "none", "apt-get install gcc"),
    ("C compiler", {"compiler": None}, CAREFUL, "built already", "for a plant of your own"),
    ("plants", {}, OK, "rars, rome_base: built", ""),
    ("plants", {"plants": {"rars": True, "x": False}}, CAREFUL, "not built yet: x", "fmu build"),
    ("plants", {"plants": {"rars": False}}, MISSING, "none is built", "10 s each"),
    ("plants", {"plants": {"x": False}, "extras": {"plants": ("sympy",)}}, MISSING, "none", "[plants]"),
    ("plants", {"plants": {"rars": None}}, MISSING, "it is unknown", "install a C compiler"),
    ("servo kernel", {}, OK, "loaded", ""),
    (
        "servo kernel",
        {"kernel_problem": "built from other sources (again)"},
        CAREFUL,
        "built from other sources; the loops run in Python",
        "install this package again",
    ),
    (
        "servo kernel",
        {"kernel_problem": "not built", "kernel_built": False},
        MISSING,
        "not built; the loops run in Python",
        "C compiler",
    ),
    ("compiled core", {}, OK, "translated to C", ""),
    ("compiled core", {"compiled": {"packet": True, "world": False}}, CAREFUL, "others in C: world", "again"),
    ("compiled core", {"compiled": {"packet": False}}, MISSING, "in Python", "make compiled"),
    ("SocketCAN", {}, OK, "Linux 6.1.0, with SocketCAN", ""),
    ("SocketCAN", {"socketcan": False, "system": "Darwin"}, CAREFUL, "Darwin", "-i pcan"),
    ("SocketCAN", {"socketcan": False}, MISSING, "without SocketCAN", "modprobe can-raw"),
    ("virtual CAN", {}, OK, "vcan0 up", ""),
    ("virtual CAN", {"interfaces": (CAN,)}, CAREFUL, "no interface is up", "ip link add dev vcan0"),
    ("virtual CAN", {"interfaces": (replace(VIRTUAL, up=False),)}, CAREFUL, "no interface is up", "modprobe"),
    ("virtual CAN", {"interfaces": (), "vcan": False}, MISSING, "no vcan", "loopback_multicast"),
    ("CAN interfaces", {}, OK, "can0 up, 1000 kbit/s, ERROR-ACTIVE", ""),
    (
        "CAN interfaces",
        {"interfaces": (replace(CAN, up=False, state="STOPPED"),)},
        CAREFUL,
        "can0 down",
        "sudo ip link set can0 up type can bitrate",
    ),
    ("CAN interfaces", {"interfaces": (replace(CAN, state="BUS-OFF"),)}, CAREFUL, "BUS-OFF", "can0 down &&"),
    (
        "CAN interfaces",
        {"interfaces": (CAN, replace(CAN, name="can1", state="ERROR-PASSIVE"))},
        CAREFUL,
        "can0 up, 1000 kbit/s, ERROR-ACTIVE; can1 up",
        "can1 sees errors",
    ),
    ("CAN interfaces", {"interfaces": (VIRTUAL,)}, MISSING, "none", "-i slcan"),
    ("serial ports", {}, OK, "/dev/ttyUSB0 (FT232R)", ""),
    (
        "serial ports",
        {"ports": (LINE, replace(LINE, device="/dev/ttyACM0", allowed=False, group="uucp"))},
        CAREFUL,
        "ada may not open /dev/ttyACM0",
        "sudo usermod -aG uucp ada",
    ),
    ("serial ports", {"ports": ()}, MISSING, "none", "plug"),
    ("watchdogs", {}, OK, "stop by themselves", ""),
    (
        "watchdogs",
        {"unwatched": {"cart:board": False}},
        CAREFUL,
        "run on when the bridge ends: cart:board",
        "flash",
    ),
    ("watchdogs", {"unwatched": {"a:b": False, "c:d": True}}, MISSING, "accepts it: c:d", "within reach"),
    ("clock", {}, OK, "the median woke 80 us late, the worst 0.90 ms: cycles of 50 ms are kept", ""),
    ("clock", {"late": (0, 5 * MILLISECOND - 1)}, OK, "kept", ""),
    ("clock", {"late": (0, 5 * MILLISECOND)}, CAREFUL, "may be late by so much, none is lost", "end what"),
    ("clock", {"resolution": 15_625_000}, CAREFUL, "steps of 15625000 ns", "end what"),
    ("clock", {"late": (0, 50 * MILLISECOND - 1)}, CAREFUL, "none is lost", "end what"),
    ("clock", {"late": (0, 50 * MILLISECOND)}, MISSING, "whole cycles of 50 ms are lost", "chrt"),
    ("load", {}, OK, "0.5 processes want to run, on 2 processors", ""),
    ("load", {"load": 2.0}, OK, "2.0 processes", ""),
    ("load", {"load": 2.1}, CAREFUL, "2.1 processes", "end what else runs"),
    ("load", {"load": None}, CAREFUL, "2 processors; this system reports no load", "by yourself"),
    ("load", {"load": 4.1}, MISSING, "none is free", "end what else runs"),
]
"""Title, difference from a machine that has everything, and the resulting finding."""

LISTING: Final = """[
 {"ifname": "lo", "link_type": "loopback", "flags": ["UP"]},
 {"ifname": "can0", "link_type": "can", "flags": ["NOARP", "UP", "LOWER_UP"], "linkinfo":
  {"info_kind": "can", "info_data": {"state": "ERROR-ACTIVE", "restart_ms": 0,
   "bittiming": {"bitrate": 500000, "sample_point": "0.875"}}}},
 {"ifname": "can1", "link_type": "can", "flags": ["NOARP"], "linkinfo":
  {"info_kind": "can", "info_data": {"state": "STOPPED"}}},
 {"ifname": "vcan0", "link_type": "can", "flags": ["NOARP", "UP"], "linkinfo": {"info_kind": "vcan"}}
]"""
"""As iproute2 prints it."""


def row(title: str) -> Check:
    (found,) = [one for one in ROWS if one.title == title]
    return found


@every(("title", "changes", "verdict", "found", "remedy"), OUTCOMES, ids=str)
def test_a_row_states_what_was_found_and_how_to_repair_it(
    title: str, changes: dict[str, Any], verdict: CheckResult, found: str, remedy: str
) -> None:
    stated = row(title).judge(replace(WELL, **changes))
    assert stated.verdict is verdict
    assert found in stated.found
    assert remedy in stated.remedy
    assert bool(stated.remedy) is (verdict is not OK)
    assert "\n" not in stated.remedy


def test_every_row_has_its_three_outcomes_in_the_table() -> None:
    shown = {(title, verdict) for title, _, verdict, _, _ in OUTCOMES}
    assert shown == {(one.title, verdict) for one in ROWS for verdict in CheckResult}


@every(
    ("changes", "missing"),
    [
        ({}, ()),
        ({"python": (3, 9, 0)}, ("Python",)),
        (
            {"libraries": (Library("rich", (13,), None),), "compiler": None, "plants": {"x": None}},
            ("libraries", "C compiler"),
        ),
        ({"socketcan": False, "vcan": False, "interfaces": (), "ports": (), "load": 99.0}, ()),
        ({"headers": False, "libraries": (Library("rich", (13, 7), (13, 6)),)}, ()),
    ],
)
def test_only_what_nothing_works_without_is_needed(changes: dict[str, Any], missing: tuple[str, ...]) -> None:
    assert lacks(replace(WELL, **changes)) == missing


def test_interfaces_with_rate_and_state_are_read_from_a_listing() -> None:
    assert interfaces_of(LISTING) == (
        CanInterface("can0", up=True, bit_rate=500_000, state="ERROR-ACTIVE"),
        CanInterface("can1", up=False, state="STOPPED"),
        VIRTUAL,
    )
    assert interfaces_of("no listing") == ()


@every(
    ("text", "version"),
    [("4.6.1", (4, 6, 1)), ("3.5", (3, 5)), ("2.0rc1", (2, 0)), ("1.0.post3", (1, 0)), ("dev", ())],
)
def test_the_numbers_of_a_version(text: str, version: tuple[int, ...]) -> None:
    assert version_of(text) == version


def test_this_machine_is_looked_at_and_no_bus_or_port_is_touched(monkeypatch: pytest.MonkeyPatch) -> None:
    def touched(*_: object, **__: object) -> NoReturn:
        raise AssertionError("a bus or a port was opened")

    monkeypatch.setattr(serial.Serial, "open", touched)
    for way in ("bind", "connect", "send", "sendto"):
        monkeypatch.setattr(socket.socket, way, touched)
    facts = gather(sleeps=2)
    assert len(facts.late) == 2
    assert min(facts.late) >= 0
    assert "python-can" in {one.name for one in facts.libraries}
    for one in facts.libraries:
        assert one.installed is not None
        assert one.installed >= one.least > ()
    assert {"rars", "single_axis"} <= set(facts.plants)
    assert {one.judge(facts).verdict for one in ROWS} <= set(CheckResult)
