"""The live page's port: who is served, what is refused, and that it goes on whatever comes."""

import base64
import hashlib
import re
import selectors
import socket
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from importlib.resources import files

import pytest
from websockets.exceptions import ConnectionClosedError, InvalidStatus, WebSocketException
from websockets.sync.client import connect
from websockets.typing import Origin

from firmware_bridge.live.messages import CLOSED, OPENED
from firmware_bridge.live.socket import LARGEST, LOOPBACK, MOST_CLIENTS, LiveSocket
from firmware_bridge.runtime.ports import PortError
from hil_tests.live.served import HUNG_S, Served, served

EVIL = "http://evil.example"


@pytest.fixture
def port() -> Iterator[Served]:
    with served() as one:
        yield one
        # Whatever a test has sent: the next one is served as ever.
        assert one.get(one.page)[0] == 200


def echoed(port: Served, text: str) -> str:
    """Return what comes back of a message."""
    with connect(port.websocket, open_timeout=HUNG_S) as page:
        page.send(text)
        return str(page.recv(timeout=HUNG_S))


def test_the_page_is_served_under_its_token_and_may_reach_nothing_else(port: Served) -> None:
    status, headers, body = port.get(port.page)
    assert (status, headers["content-type"]) == (200, "text/html; charset=utf-8")
    policy = headers["content-security-policy"]
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "connect-src 'self'" in policy
    assert "unsafe" not in policy
    (script,) = re.findall(r"<script>(.*?)</script>", body.decode(), re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"'sha256-{digest}'" in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["cache-control"] == "no-store"


def test_the_page_has_no_outside_address_and_nothing_inline_that_its_policy_forbids(port: Served) -> None:
    text = port.get(port.page)[2].decode()
    outside = set(re.findall(r"https?://[\w.:/-]+", text)) - {"http://www.w3.org/2000/svg"}
    assert outside == set()
    markup = re.sub(r"<(script|style)>.*?</\1>", "", text, flags=re.DOTALL)
    assert re.findall(r"\s(?:style|on\w+)\s*=", markup) == []
    assert ".innerHTML" not in text


def test_what_draws_the_plots_is_served_beside_the_page_where_it_was_taken(port: Served) -> None:
    there = (files("firmware_bridge.live") / "uplot.js").is_file()
    status, headers, body = port.get(f"{port.page}uplot.js")
    assert status == (200 if there else 404)
    assert headers["content-type"].startswith("text/javascript" if there else "text/plain")
    assert (b"uPlot" in body) is there


def test_messages_go_both_ways(port: Served) -> None:
    assert echoed(port, '{"do":"state"}') == '{"do":"state"}'
    assert [payload for _, payload in port.received] == [OPENED, b'{"do":"state"}', CLOSED]


@pytest.mark.parametrize(
    ("path", "host", "origin", "status"),
    [
        ("/wrong-token/", "", "", 403),
        ("/", "", "", 403),
        ("", "", "", 400),
        ("/TOKEN/../page.html", "", "", 404),
        ("/TOKEN/..%2f..%2fetc%2fpasswd", "", "", 404),
        ("/TOKEN//etc/passwd", "", "", 404),
        ("/TOKEN/socket.py", "", "", 404),
        ("/TOKEN/", "evil.example", "", 421),
        ("/TOKEN/", "evil.example:PORT", "", 421),
        ("/TOKEN/", "127.0.0.1", "", 421),
        ("/TOKEN/", "", EVIL, 403),
        ("/TOKEN/", "", "null", 403),
        ("/TOKEN/ws", "", EVIL, 403),
    ],
)
def test_a_foreign_request_is_refused(port: Served, path: str, host: str, origin: str, status: int) -> None:
    path = path.replace("TOKEN", port.port.token)
    if not path:
        assert port.raw(b"GET http://[ HTTP/1.1\r\nHost: \r\n\r\n").split()[1] == b"421"
        return
    answer = port.get(path, host.replace("PORT", str(port.number)), origin)
    assert answer[0] == status
    assert port.port.token.encode() not in answer[2]


@pytest.mark.parametrize(
    ("origin", "path"), [(EVIL, ""), (None, "wrong"), ("http://127.0.0.1:1", ""), ("https://127.0.0.1", "")]
)
def test_a_foreign_page_opens_no_websocket(port: Served, origin: str | None, path: str) -> None:
    address = port.websocket.replace(port.port.token, path or port.port.token)
    with pytest.raises(InvalidStatus):
        connect(address, origin=None if origin is None else Origin(origin), open_timeout=HUNG_S).__enter__()
    assert port.received == []


def test_the_page_s_own_origin_opens_it(port: Served) -> None:
    own = Origin(f"http://127.0.0.1:{port.number}")
    with connect(port.websocket, origin=own, open_timeout=HUNG_S):
        pass
    assert port.received[0][1] == OPENED


def test_a_large_message_ends_its_connection_alone(port: Served) -> None:
    with connect(port.websocket, open_timeout=HUNG_S) as page:

        def send() -> None:
            page.send("x" * 10_000_000)
            page.recv(timeout=HUNG_S)

        with pytest.raises(ConnectionClosedError) as closed:
            send()
        assert closed.value.rcvd is None or closed.value.rcvd.code == 1009
    assert all(len(payload) <= LARGEST for _, payload in port.received)


@pytest.mark.parametrize(
    "garbage",
    [
        b"\0" * 100_000,
        b"GET / HTTP/1.1\r\n" + b"A: " + b"b" * 100_000,
        b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 10_000 + b"\r\n",
        b"POST / HTTP/1.1\r\nHost: x\r\n\r\n",
        b"\x16\x03\x01\x02\x00",
    ],
)
def test_garbage_ends_its_connection(port: Served, garbage: bytes) -> None:
    with (
        socket.create_connection((LOOPBACK, port.number), timeout=HUNG_S) as client,
        suppress(OSError),  # it has thrown the rest away
    ):
        client.sendall(garbage)
        client.shutdown(socket.SHUT_WR)
        while client.recv(1 << 16):
            pass
    assert port.received == []


def test_a_hundred_connections_are_too_many_and_a_page_is_served_all_the_same(port: Served) -> None:
    with connect(port.websocket, open_timeout=HUNG_S) as page:
        idle = [socket.create_connection((LOOPBACK, port.number), timeout=HUNG_S) for _ in range(100)]
        page.send("{}")
        assert page.recv(timeout=HUNG_S) == "{}"
        assert port.get(port.page)[0] == 200
        for one in idle:
            one.close()


def test_more_pages_than_there_is_room_for_are_refused(port: Served) -> None:
    with ExitStack() as stack:
        pages = [
            stack.enter_context(connect(port.websocket, open_timeout=HUNG_S)) for _ in range(MOST_CLIENTS)
        ]
        with (
            pytest.raises((OSError, EOFError, WebSocketException)),
            connect(port.websocket, open_timeout=HUNG_S),
        ):
            pytest.fail("it was served")
        for page in pages:
            page.send("{}")
            assert page.recv(timeout=HUNG_S) == "{}"


def test_a_page_that_does_not_read_is_dropped_and_memory_stays() -> None:
    port = LiveSocket()
    number = int(port.name.rpartition(":")[2].partition("/")[0])
    with socket.create_connection((LOOPBACK, number), timeout=HUNG_S) as page:
        host = f"Host: 127.0.0.1:{number}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        key = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
        page.sendall(f"GET /{port.token}/ws HTTP/1.1\r\n{host}{key}".encode())
        found: list[tuple[int, bytes]] = []
        while not found:
            found = port.read(0)
        for _ in range(2000):
            port.write(0, b"{}" * 8192, 0)
        while (found[0][0], CLOSED) not in found:
            found += port.read(0)
    port.close()


def test_a_port_that_is_taken_is_one_message() -> None:
    with (
        served() as one,
        pytest.raises(PortError, match=f"cannot open the live page at 127.0.0.1:{one.number}"),
    ):
        LiveSocket(one.number)


def test_a_connection_that_makes_room_for_another_may_have_had_something_to_send() -> None:
    port = LiveSocket()
    number = int(port.name.rpartition(":")[2].partition("/")[0])
    with ExitStack() as stack:
        for _ in range(MOST_CLIENTS):
            stack.enter_context(socket.create_connection((LOOPBACK, number), timeout=HUNG_S))
            port.read(0)
        oldest = next(iter(port._clients.values())).connection  # noqa: SLF001 - as with unsent bytes
        port._ready.modify(oldest, selectors.EVENT_READ | selectors.EVENT_WRITE, 1)  # noqa: SLF001 - as above
        stack.enter_context(socket.create_connection((LOOPBACK, number), timeout=HUNG_S))
        assert port.read(0) == []
        assert len(port._clients) == MOST_CLIENTS  # noqa: SLF001 - as above
    port.close()
