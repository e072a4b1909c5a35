"""The control desk: every fault at its instant and taken off again, settings, and requests that are none."""

import struct
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from emulators.arduino_omni.board import Board
from emulators.bench.faults import kinds
from emulators.bench.faults.failures import failures_of
from firmware_bridge.canopen.cia301 import SDO_REQUEST, SDO_RESPONSE
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, to_seconds
from hil_tests.unit.control.live_bench import LiveBench, live

ROBOTS = ("rars", "rome", "ar2", "climber", "servo_axis")
BUS = "drives"
LEFT = 1
"""Node number of RARS's left drive."""


@pytest.fixture
def rars() -> Iterator[LiveBench]:
    with live("rars") as bench:
        yield bench


@pytest.fixture
def rome() -> Iterator[LiveBench]:
    with live("rome") as bench:
        yield bench


def upload(index: int, sub: int = 0) -> bytes:
    return struct.pack("<BHBI", 0x40, index, sub, 0)


def answers(bench: LiveBench, node: int, index: int = 0x1000, sub: int = 0) -> list[bytes]:
    """Return what a drive answers to the question for an object."""
    sent = bench.receives(BUS, SDO_REQUEST + node, upload(index, sub))
    return [packet.payload for packet in sent if packet.address == SDO_RESPONSE + node]


def number_in(payload: bytes) -> int:
    return int.from_bytes(payload[4:], "little")


@pytest.mark.parametrize("name", ROBOTS)
def test_every_fault_of_a_robot_begins_at_its_instant_and_ends(name: str) -> None:
    with live(name) as bench:
        for failure in failures_of(find(name)):
            kind = kinds()[failure.kind]
            fault = kind.fault.model_validate({"at_s": 0.0, **failure.keys})
            if problem := fault.real_bus_problem(find(name)):
                assert problem in bench.refuses("inject", fault=kind.name, keys=dict(failure.keys))
                continue
            begun = to_seconds(bench.now)
            number = bench.does("inject", fault=kind.name, keys=dict(failure.keys))["number"]
            standing = bench.does("state")["faults"]
            assert [one["number"] for one in standing] == ([number] if kind.lasts else [])
            assert all(one["began_s"] == begun for one in standing)
            bench.runs(3)
            assert bench.does("clear")["cleared"] == ([number] if kind.lasts else [])
            assert bench.does("state")["faults"] == []
            bench.runs(2)


def test_every_kind_is_possible_on_a_real_bus_or_states_why_not() -> None:
    possible = {failure.kind for name in ROBOTS for failure in failures_of(find(name))}
    variants = ("rars+imu", "rome+cameras")
    possible |= {failure.kind for name in variants for failure in failures_of(find(name))}
    refused = {kind.name for kind in kinds().values() if kind.bench_only}
    assert kinds().keys() == possible | refused


def test_a_drive_that_is_restarted_is_off_the_bus_and_boots_up_again(rars: LiveBench) -> None:
    assert answers(rars, LEFT)
    rars.does("restart", node="left")
    assert rars.does("state")["devices"]["left"] is False
    assert not answers(rars, LEFT)
    assert Packet(BUS, 0x700 + LEFT, b"\0") in rars.runs(800)
    assert answers(rars, LEFT)
    assert rars.reports[0].startswith("fault drive_restart begins at 0.4")


def test_frames_of_one_drive_are_lost_and_no_others(rars: LiveBench) -> None:
    number = rars.does("inject", fault="frame_loss", keys={"node": "left"})["number"]
    assert (answers(rars, LEFT), len(answers(rars, LEFT + 1))) == ([], 1)
    rars.does("clear", number=number)
    assert len(answers(rars, LEFT)) == 1


def test_a_drive_whose_controller_overruns_receives_nothing(rars: LiveBench) -> None:
    rars.does("inject", fault="receive_overrun", keys={"node": "left", "for_s": 0.02})
    assert (answers(rars, LEFT), len(answers(rars, LEFT + 1))) == ([], 1)
    rars.runs(20)
    assert len(answers(rars, LEFT)) == 1


def test_the_cable_is_cut_behind_a_drive(rars: LiveBench) -> None:
    nodes = [axis.settings.number for axis in find("rars").axes]
    rars.does("inject", fault="can_cut", keys={"between": ["left", "right"]})
    assert [len(answers(rars, node)) for node in nodes] == [1, 0, 0, 0]
    rars.does("clear")
    assert [len(answers(rars, node)) for node in nodes] == [1, 1, 1, 1]


def test_a_foreign_node_sends_until_it_is_cleared(rars: LiveBench) -> None:
    rars.does("inject", fault="stray_frames", keys={"identifier": 0x123, "data": "BEEF", "every_ms": 10})
    rars.runs(35)
    at = [now for now, packet in rars.sent if packet.address == 0x123]
    assert [later - at[0] for later in at] == [0, 10 * MILLISECOND, 20 * MILLISECOND, 30 * MILLISECOND]
    rars.does("clear")
    assert not [packet for packet in rars.runs(100) if packet.address == 0x123]


def test_a_foreign_network_command_reaches_the_drives(rars: LiveBench) -> None:
    rars.does("inject", fault="nmt_foreign_node", keys={"command": "reset_node", "node": "left"})
    sent = [packet for at, packet in rars.sent if at == rars.now]
    assert sent == [Packet(BUS, 0x000, b"\x81\x01"), Packet(BUS, 0x700 + LEFT, b"\0")]


def test_an_input_is_read_by_the_drive(rars: LiveBench) -> None:
    before = number_in(answers(rars, LEFT, 0x2071, 1)[0])
    rars.does("set", values={"left.input2": 1})
    rars.runs(5)
    after = number_in(answers(rars, LEFT, 0x2071, 1)[0])
    assert before != after
    rars.does("set", values={"left.input2": 0})
    rars.runs(5)
    assert number_in(answers(rars, LEFT, 0x2071, 1)[0]) == before


def test_a_supply_that_is_set_too_low_is_an_error_of_the_drive(rars: LiveBench) -> None:
    rars.does("set", values={"left.supply_v": 8})
    rars.runs(20)
    assert number_in(answers(rars, LEFT, 0x1003, 1)[0]) & 0xFFFF == 0x3220
    assert answers(rars, LEFT + 1, 0x1003, 0)[0][4] == 0


def test_what_the_plant_declares_tunable_is_set_while_it_runs(rars: LiveBench) -> None:
    plant = rars.devices.plant
    assert plant.read("lift_payload") == 0.0
    rars.does("set", values={"lift_payload": 20.0})
    rars.runs(10)
    assert plant.read("lift_payload") == 20.0


def test_bytes_of_neither_end_are_on_the_line_to_a_board(rome: LiveBench) -> None:
    begun = rome.now
    rome.does("inject", fault="line_garbage", keys={"every_ms": 5, "for_s": 0.012})
    rome.runs(50)
    bursts = [now - begun for now, packet in rome.sent if now >= begun and len(packet.payload) == 8]
    assert bursts == [0, 5 * MILLISECOND, 10 * MILLISECOND]


def test_a_board_is_reset_by_its_link(rome: LiveBench) -> None:
    rome.does("restart", node="board")
    assert "fault board_reset begins" in rome.reports[0]


@pytest.mark.parametrize(
    ("do", "keys", "reason"),
    [
        ("injekt", {}, "no such request as 'injekt'; perhaps 'inject'"),
        ("inject", {}, 'give "fault"'),
        ("inject", {"fault": "shaft_block"}, "no such fault as 'shaft_block'"),
        ("inject", {"fault": "drive_restart"}, "node"),
        ("inject", {"fault": "drive_restart", "keys": {"node": "arm"}}, "rars has no node 'arm'"),
        ("inject", {"fault": "drive_restart", "keys": {"node": "left", "for_s": -1}}, "for_s"),
        ("inject", {"fault": "supply_sag", "keys": {"to_v": 90}}, "no sag"),
        ("inject", {"fault": "shaft_blocked", "keys": {"node": "left"}}, "rars has not"),
        ("inject", {"fault": "bus_off", "keys": {"node": "left"}}, "not on a real bus"),
        ("inject", {"fault": "drive_restart", "keys": [1]}, '"keys"'),
        ("clear", {"number": 7}, "no fault 7 is on; numbers of those that are: none"),
        ("set", {}, '"values"'),
        ("set", {"values": {"left.input2": "on"}}, "must be a number"),
        ("set", {"values": {"left.input2": 3}}, "give 0 to 1"),
        ("set", {"values": {"left.inputs": 1}}, "no such setting as 'left.inputs'; perhaps 'left.input"),
        ("set", {"values": {"wheel_radius": 1.0}}, "no such setting as 'wheel_radius'"),
        ("set", {"values": {"left.input2": 10**400}}, "must be a number up to 1e+12"),
        ("set", {"values": {"lift_payload": float("nan")}}, "give a number, not nan"),
        ("restart", {}, '"node"'),
        ("restart", {"node": "arm"}, "rars has no node 'arm'"),
    ],
)  # fmt: skip
def test_a_request_that_cannot_be_carried_out_is_answered_in_one_line(
    rars: LiveBench, do: str, keys: dict[str, Any], reason: str
) -> None:
    assert reason in rars.refuses(do, **keys)
    assert rars.does("state")["faults"] == []


@pytest.mark.parametrize(
    "line",
    [
        *(b"", b"inject", b"[]", b'{"do": 3}', b"\xff\xfe", b'{"do": "state"'),
        b"[" * 60_000,
        b'{"do": ' + b"9" * 5_000 + b"}",
    ],
    ids=range(8),
)
def test_a_line_that_is_no_request_is_answered(rars: LiveBench, line: bytes) -> None:
    answer = rars.line(line)
    assert (answer["ok"], answer["id"]) == (False, None)


def test_two_faults_of_one_part_are_not_on_at_once(rars: LiveBench) -> None:
    rars.does("inject", fault="supply_sag", keys={"node": "left", "to_v": 15})
    again = rars.refuses("inject", fault="supply_sag", keys={"node": "left", "to_v": 12})
    assert "let one end before the other begins" in again
    rars.does("inject", fault="supply_sag", keys={"node": "right", "to_v": 12})
    assert len(rars.does("state")["faults"]) == 2


def test_shutdown_finishes_the_node(rars: LiveBench) -> None:
    assert not rars.desk.finished
    rars.does("shutdown")
    assert rars.desk.finished


def test_a_line_to_a_board_keeps_its_link(rome: LiveBench) -> None:
    assert rome.devices.stations["board"].on.keys() == {SERIAL}


def test_what_the_plant_cannot_have_is_an_answer_and_the_devices_live_on(
    rome: LiveBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    motors = rome.devices.nodes(Board)["board"].motors
    monkeypatch.setattr(motors, "_load", replace(motors._load, holds=None))  # noqa: SLF001 - another plant
    refused = rome.refuses("inject", fault="shaft_blocked", keys={"node": "one"})
    assert "the plant has no input held_one" in refused
    assert rome.does("state")["faults"] == []
    assert rome.does("clear")["cleared"] == []
    number = rome.does("inject", fault="motor_cable_off", keys={"node": "one"})["number"]
    assert rome.does("clear")["cleared"] == [number]


def test_of_several_values_all_are_set_or_none(rars: LiveBench) -> None:
    before = number_in(answers(rars, LEFT, 0x2071, 1)[0])
    assert "no such setting" in rars.refuses("set", values={"left.input2": 1, "left.inputs": 1})
    rars.runs(5)
    assert number_in(answers(rars, LEFT, 0x2071, 1)[0]) == before
