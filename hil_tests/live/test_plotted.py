"""Values for PlotJuggler: JSON over UDP on loopback, at most 50 times a second, and no run waits for it."""

import json
import math
import socket
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import pytest
from typer.testing import CliRunner

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import find as mission_of
from emulators.bench.operator import ScriptedOperator
from emulators.live.plot_values import of_rig
from emulators.rig import Rig
from emulators.testing.process import Process
from firmware_bridge.cli import program
from firmware_bridge.cli.plot_option import Openers, plotted
from firmware_bridge.live.plotted import PLOTS, SENT_EVERY, Plotted, known, of_bridge, values_of
from firmware_bridge.node import CAN, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import find
from firmware_bridge.runtime.ports import Port, PortError, UdpPort
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds, from_seconds
from hil_tests.ports import free_port

PROGRAM: Final = str(Path(sys.executable).with_name("firmware-bridge"))
FRAME: Final = Packet(CAN, 0x80, b"")


class Echo:
    """A node that sends back what it receives, and wants to be woken every millisecond."""

    holding = True
    finished = False

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        return Reaction((packet,), now + MILLISECOND)

    def wake(self, now: Nanoseconds) -> Reaction:
        return Reaction((), now + MILLISECOND)

    def stop(self, now: Nanoseconds) -> Reaction:
        return Reaction((FRAME,), now)


def at(now: Nanoseconds) -> dict[str, Any]:
    return {"timestamp": now / SECOND}


def test_it_sends_fifty_times_a_second_and_leaves_the_node_as_it_is() -> None:
    plain, shown = Echo(), Plotted(Echo(), at)
    sent = []
    for now in range(0, SECOND, MILLISECOND):
        expected, reaction = plain.wake(now), shown.wake(now)
        assert reaction.wake_at == expected.wake_at
        sent += [packet for packet in reaction.sent if packet.link == PLOTS]
        assert [packet for packet in reaction.sent if packet.link != PLOTS] == []
    assert len(sent) == SECOND // SENT_EVERY == 50
    assert [json.loads(packet.payload)["timestamp"] for packet in sent[:3]] == [0.0, 0.02, 0.04]
    assert shown.receive(FRAME, SECOND).sent[0] == FRAME
    assert shown.stop(SECOND).sent == (FRAME,)
    assert shown.holding
    assert not shown.finished


def test_an_instant_is_sent_once_and_what_a_plotter_sends_reaches_no_device() -> None:
    shown = Plotted(Echo(), lambda _now: {"timestamp": 1.0})
    assert len(shown.wake(0).sent) == 1
    assert shown.wake(SECOND).sent == ()
    assert shown.receive(Packet(PLOTS, 0, b"x"), 2 * SECOND) == Reaction((), 2 * SECOND + MILLISECOND)


def test_what_is_no_number_is_left_out() -> None:
    table = {"a": 1, "b": math.nan, "c": math.inf, "d": None, "e": "text", "f": {"g": None}, "h": {"i": 2.0}}
    assert known(table) == {"a": 1, "h": {"i": 2.0}}
    assert values_of({"at_s": 2.0}) == {"timestamp": 2.0, "armed": 0.0, "interlocks": 0.0}


@pytest.fixture(scope="module")
def rig() -> Iterator[Rig]:
    robot = find("rars")
    setup = bench_setup_of(robot)
    script = mission_of("line", robot, setup)
    generator: Any = None
    rig = Rig(script.on(robot), setup, ScriptedOperator(robot, setup, script, generator))
    rig.run(from_seconds(6.0))
    yield rig
    rig.finish()


def test_a_bench_sends_drives_pose_plant_and_the_links_age(rig: Rig) -> None:
    values = of_rig(rig)(0)
    assert values["timestamp"] == 6.0
    assert set(values["drives"]) == {"left", "right", "steer", "lift"}
    assert values["drives"]["left"]["velocity"] > 0.1
    assert values["drives"]["left"]["target"] > 0.1
    assert values["pose"]["x_m"] == pytest.approx(values["measured"]["x_m"], abs=0.01)
    assert values["pose"]["x_m"] > 0.01
    assert 0.0 <= values["operator"]["age_s"] < 0.5
    assert values["buses"]["drives"]["load_percent"] > 1.0
    assert (values["armed"], values["interlocks"]) == (1.0, 0.0)


def test_a_bridge_on_a_real_robot_sends_what_it_knows(rig: Rig) -> None:
    values, bench = of_bridge(rig.robot, rig.bridge)(7 * SECOND), of_rig(rig)(0)
    assert values["timestamp"] == 7.0
    for group in ("drives", "pose", "command", "operator"):
        assert values[group] == bench[group]
    assert "measured" not in values


@pytest.fixture
def receiver() -> Iterator[socket.socket]:
    """Return a socket of loopback, as the plotter has it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
        found.bind(("127.0.0.1", 0))
        found.settimeout(5.0)
        yield found


def opened(node: Node, place: str) -> tuple[Node, Port]:
    openers: Openers = {}
    shown = plotted(node, place, openers, at)
    return shown, openers[PLOTS]()


def test_a_port_alone_is_one_of_this_machine(
    receiver: socket.socket, capsys: pytest.CaptureFixture[str]
) -> None:
    number = receiver.getsockname()[1]
    for place in (str(number), f"127.0.0.1:{number}"):
        node, port = opened(Echo(), place)
        for packet in node.wake(3 * SECOND).sent:
            port.write(packet.address, packet.payload, 0)
        datagram, sender = receiver.recvfrom(65_535)
        assert json.loads(datagram) == {"timestamp": 3.0}
        assert sender[0] == "127.0.0.1"
        port.close()
        assert capsys.readouterr().out == f"values for PlotJuggler go to 127.0.0.1:{number}\n"


def test_another_host_is_called_only_where_it_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    links: list[str] = []

    def note(link: str) -> UdpPort:
        links.append(link)
        return UdpPort("udpout:127.0.0.1:9")

    monkeypatch.setattr("firmware_bridge.runtime.ports.UdpPort", note)
    for place in ("9870", "192.0.2.1:9870", "[::1]:9870"):
        opened(Echo(), place)[1].close()
    assert links == ["udpout:127.0.0.1:9870", "udpout:192.0.2.1:9870", "udpout:[::1]:9870"]


def test_a_receiver_that_is_gone_is_ignored_and_nothing_waits(receiver: socket.socket) -> None:
    node, port = opened(Echo(), str(receiver.getsockname()[1]))
    receiver.close()
    for number in range(1000):
        for packet in node.wake(number * SENT_EVERY).sent:
            port.write(packet.address, packet.payload, 0)
        assert port.read(0) == []
    assert port.retry_at == NEVER
    port.close()


@pytest.mark.parametrize("place", ["", "nowhere", "1.2.3.4", "1.2.3.4:99999", "99999", ":x"])
def test_a_place_that_is_none_is_one_message(place: str) -> None:
    with pytest.raises(PortError, match=r"--plotjuggler .*; give a port, as 9870, or HOST:PORT") as refused:
        opened(Echo(), place)
    assert "\n" not in str(refused.value)


def test_without_the_option_nothing_is_put_around() -> None:
    openers: Openers = {}
    node = Echo()
    assert plotted(node, None, openers, at) is node
    assert openers == {}


def test_a_bench_in_virtual_time_refuses_it() -> None:
    done = CliRunner().invoke(program, ["bench", "rars", "--plotjuggler", "9870"])
    assert done.exit_code == 2
    assert "--plotjuggler needs --realtime" in done.stderr


@pytest.mark.parametrize(
    ("words", "drives", "group"),
    [
        (["bench", "rars", "--mission", "line", "--realtime", "--out", "results"], 4, "measured"),
        (["emulate", "rars", "--serial", "pty"], 4, "plant"),
        (["emulate", "epos2", "--node", "1-2", "--serial", "pty"], 2, "drives"),
        (["emulate", "cia402", "--node", "1-2", "-i", "virtual", "-c", "plots"], 2, "drives"),
        (["emulate", "rome", "--serial", "pty"], 0, "plant"),
    ],
)
def test_a_program_sends_while_it_runs(
    words: list[str], drives: int, group: str, receiver: socket.socket, tmp_path: Path
) -> None:
    words = [str(tmp_path / "results") if word == "results" else word for word in words]
    place = ("--control", "none", "--plotjuggler", str(receiver.getsockname()[1]))
    program_of_it = Process((PROGRAM, *words, *place), tmp_path / "log")
    try:
        receiver.settimeout(20.0)
        values = [json.loads(receiver.recv(65_535)) for _ in range(5)]
    finally:
        program_of_it.stop()
    stamps = [one["timestamp"] for one in values]
    assert stamps == sorted(set(stamps))
    assert len(values[-1].get("drives", ())) == drives
    assert values[-1][group]


def test_a_bridge_on_a_line_sends_what_it_knows(receiver: socket.socket, tmp_path: Path) -> None:
    line, robot = tmp_path / "line", (PROGRAM, "emulate", "rars", "--control", "none", "--serial", "pty")
    devices = Process((*robot, "--serial-link", str(line)), tmp_path / "devices")
    bridge: Process | None = None
    try:
        devices.waits(line.exists, "its line", 20.0)
        words = ("drive", "rars", "--serial", str(line), "--mavlink", f"udpout:127.0.0.1:{free_port()}")
        state = ("--state", str(tmp_path / "state.json"))
        place = ("--plotjuggler", str(receiver.getsockname()[1]))
        bridge = Process((PROGRAM, *words, *state, *place), tmp_path / "bridge")
        receiver.settimeout(20.0)
        values = [json.loads(receiver.recv(65_535)) for _ in range(10)]
    finally:
        if bridge is not None:
            bridge.stop()
        devices.stop()
    assert "pose" in values[-1]
    assert values[-1]["armed"] == 0.0
