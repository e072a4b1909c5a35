"""The port of the control desk: who may connect, lines in pieces, clients that are too many or too slow."""

import json
import os
import socket
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest

from firmware_bridge.runtime.ports import PortError
from firmware_bridge.runtime.ports.control_socket import (
    LONGEST,
    MOST_CLIENTS,
    ControlSocket,
    runtime_folder,
)
from firmware_bridge.testing.control import Control, ControlError, control, of_process, running

NESTED = b"[" * 10_000


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return tmp_path / "firmware-bridge"


@pytest.fixture
def port() -> Iterator[ControlSocket]:
    made = ControlSocket("unix", "rars")
    yield made
    made.close()


def client_of(port: ControlSocket) -> socket.socket:
    made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    made.settimeout(10)
    made.connect(port.name)
    port.read(0)
    return made


def test_only_its_user_may_connect_and_it_leaves_no_file(folder: Path) -> None:
    port = ControlSocket("unix", "rars")
    (path,) = folder.iterdir()
    assert path.name == f"rars-{os.getpid()}.sock"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    port.close()
    assert not path.exists()


def test_lines_come_whole_and_with_the_number_of_their_client(port: ControlSocket) -> None:
    one, two = client_of(port), client_of(port)
    one.sendall(b'{"do":')
    assert port.read(0) == []
    two.sendall(b"a\nb\n")
    one.sendall(b'"state"}\n')
    assert sorted(port.read(0)) == [(1, b'{"do":"state"}'), (2, b"a"), (2, b"b")]
    port.write(2, b"answer\n", 0)
    assert two.recv(100) == b"answer\n"
    one.close()
    two.close()


def test_a_client_that_has_left_disturbs_no_one(port: ControlSocket) -> None:
    one, two = client_of(port), client_of(port)
    one.sendall(b"request\n")
    one.close()
    assert port.read(0) == [(1, b"request")]
    assert port.read(0) == []
    port.write(1, b"answer\n", 0)
    two.sendall(b"more\n")
    assert port.read(0) == [(2, b"more")]
    two.close()


def test_a_line_without_an_end_and_one_client_too_many_are_dropped(port: ControlSocket) -> None:
    clients = [client_of(port) for _ in range(MOST_CLIENTS)]
    clients.append(client_of(port))
    assert clients[-1].recv(10) == b""
    clients[0].settimeout(0)
    sent = 0
    while sent <= LONGEST:
        sent += clients[0].send(b"x" * 8192)
        port.read(0)
    clients[0].settimeout(10)
    assert clients[0].recv(10) == b""
    for one in clients:
        one.close()


def test_no_line_of_many_is_lost(port: ControlSocket) -> None:
    client = client_of(port)
    client.sendall(b"x\n" * 500)
    assert port.read(0) == [(1, b"x")] * 500
    client.close()


def test_over_tcp_the_token_comes_first() -> None:
    port = ControlSocket("tcp", "rars")
    host, _, number = port.name.rpartition(":")
    assert host == "127.0.0.1"
    for first, admitted in (
        ({"token": port.token}, True),
        ({"token": "no"}, False),
        (3, False),
        ({}, False),
        (NESTED, False),
    ):
        client = socket.create_connection((host, int(number)), timeout=10)
        port.read(0)
        line = first if isinstance(first, bytes) else json.dumps(first).encode()
        client.sendall(line + b'\n{"do":"state"}\n')
        lines: list[tuple[int, bytes]] = []
        for _ in range(3):
            lines += port.read(0)
        assert [line for _, line in lines] == ([b'{"do":"state"}'] if admitted else [])
        client.close()
    port.close()


@pytest.mark.parametrize("where", ["tcp:", "tcp:70000", "tcp:x", "unix:x", "udp", ""])
def test_a_place_that_is_none_is_refused(where: str) -> None:
    if where == "tcp:":
        ControlSocket(where, "rars").close()
        return
    with pytest.raises(PortError, match="give unix, tcp, tcp:PORT or none"):
        ControlSocket(where, "rars")


def test_a_folder_of_someone_else_is_not_used(folder: Path) -> None:
    folder.symlink_to(folder.parent)
    with pytest.raises(PortError, match="not this user's own folder"):
        ControlSocket("unix", "rars")


def test_without_a_runtime_folder_of_the_system_there_is_one_of_the_user(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", "/nowhere")
    assert runtime_folder().name == f"firmware-bridge-{os.getuid()}"


def test_running_programs_are_found_and_dead_ones_forgotten(port: ControlSocket, folder: Path) -> None:
    dead = folder / "rome-999999999.sock"
    dead.touch()
    assert running() == {f"rars-{os.getpid()}": Path(port.name)}
    assert not dead.exists()
    of_process(os.getpid()).close()
    control().close()
    control("rars").close()


def test_which_program_is_meant_must_be_clear(port: ControlSocket) -> None:
    second = ControlSocket("unix", "rome")
    for name, reason in (("", "2 programs run; name one: rars-"), ("r", "'r' fits 2"), ("x", "'x' fits 0")):
        with pytest.raises(ControlError, match=reason):
            control(name)
    control("rome").close()
    second.close()
    port.close()
    with pytest.raises(ControlError, match="0 programs run; name one: none; start one"):
        control()
    with pytest.raises(ControlError, match="has no control port"):
        of_process(os.getpid())


def test_an_address_at_which_no_one_listens_is_one_message() -> None:
    with pytest.raises(ControlError, match="no program answers at"):
        Control(Path("/nowhere.sock"))
