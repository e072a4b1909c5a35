"""Serial ports and pseudo-terminals of this machine, with pyserial as the third party at the other end."""

import errno
import fcntl
import os
import termios
from contextlib import closing
from pathlib import Path

import pytest
import serial

from emulators.epos2.serial.serial_drive import SerialEpos2
from emulators.gateway import Cluster
from emulators.servo.axis import ServoAxis
from firmware_bridge.cli.links import open_serial
from firmware_bridge.families.epos2.maxon.frame import Frame, Generation, encode_v2
from firmware_bridge.node import CAN, DTR_DOWN, DTR_UP, LINE_BACK, LINE_LOST, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import LostPort, Port, PortError, PseudoTerminal, SeenOpening, SerialLine
from firmware_bridge.runtime.runner import run
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds
from hil_tests.unit.epos2.quiet_motion import QuietMotion
from hil_tests.unit.world.players import Player

TIOCGEXCL = 0x80045440
"""Request that reads if a terminal is one client's alone (Linux, asm-generic/ioctls.h)."""
REQUESTED_V2 = encode_v2(Frame(0x10, bytes.fromhex("00100001")))
ANSWERED_V2 = bytes.fromhex("90 02 00 04 00 00 00 00 92 01 02 00 9A ED")


def received(port: Port, count: int, within: Nanoseconds = SECOND) -> bytes:
    clock, chunks = Clock(), b""
    while len(chunks) < count and clock.now() < within:
        if clock.wait([port.fileno()], within):
            chunks += b"".join(chunk for _, chunk in port.read(clock.now()))
    return chunks


def test_bytes_pass_a_pseudo_terminal_as_they_are_both_ways() -> None:
    raw = bytes(range(256))
    with closing(PseudoTerminal()) as port, serial.Serial(port.path, 115_200, timeout=1) as client:
        client.write(raw)
        assert received(port, 256) == raw
        port.write(0, raw, 0)
        assert client.read(256) == raw
        assert port.retry_at == NEVER


def test_nothing_comes_back_before_a_client_is_there() -> None:
    with closing(PseudoTerminal()) as port:
        port.write(0, b"\x90\x02\r\n", 0)
        assert received(port, 1, within=5 * MILLISECOND) == b""


def packets(port: Port, count: int = 1, within: Nanoseconds = SECOND) -> list[tuple[int, bytes]]:
    """Return so many packets, or what has come in that time; with none it looks for a tenth of it."""
    clock, found = Clock(), list[tuple[int, bytes]]()
    until = within if count else within // 10
    while (not count or len(found) < count) and clock.now() < until:
        if clock.wait([port.fileno()], until):
            found += port.read(clock.now())
    return found


def test_a_client_that_opens_raises_dtr_before_it_speaks_and_the_last_that_closes_drops_it() -> None:
    with closing(SeenOpening()) as port:
        assert port.read(0) == []
        for _ in range(2):
            with serial.Serial(port.path, timeout=1) as client:
                client.write(b"first word")
                assert packets(port, 2) == [(DTR_UP, b""), (0, b"first word")]
                with serial.Serial(port.path):
                    assert packets(port, 0) == []
                assert packets(port, 0) == []
            assert packets(port) == [(DTR_DOWN, b"")]
        port.write(0, b"and back", 0)


def test_a_client_that_keeps_dtr_up_drops_nothing() -> None:
    with closing(SeenOpening()) as port:
        for _ in range(2):
            with serial.Serial(port.path) as client:
                assert packets(port) == [(DTR_UP, b"")]
                modes = termios.tcgetattr(client.fileno())
                modes[2] &= ~termios.HUPCL
                termios.tcsetattr(client.fileno(), termios.TCSANOW, modes)
            assert packets(port, 0) == []


def test_clients_come_and_go() -> None:
    with closing(PseudoTerminal()) as port:
        for name in (b"one", b"two", b"three"):
            with serial.Serial(port.path, timeout=1) as client:
                client.write(name)
                assert received(port, len(name)) == name
            assert port.read(0) == []
            port.write(0, b"no one receives this", 0)


@pytest.mark.parametrize("kind", [PseudoTerminal, SeenOpening])
def test_a_client_at_another_bit_rate_and_the_device_do_not_receive_each_other_which_is_stated_once(
    kind: type[PseudoTerminal],
) -> None:
    stated: list[str] = []
    with (
        closing(kind(None, 57_600, stated.append)) as port,
        serial.Serial(port.path, 9_600, timeout=0) as client,
    ):
        for _ in range(2):
            client.write(b"e\r")
            assert not received(port, 2, SECOND // 10)
            port.write(0, b"0 0\r\n", 0)
            assert client.read(9) == b""
        assert stated == [f"{port.name}: its client has not set the device's 57600 Bd; nothing is received"]
        client.baudrate = 57_600
        client.write(b"e\r")
        assert received(port, 2) == b"e\r"
        port.write(0, b"0 0\r\n", 0)
        client.timeout = 1
        assert client.read(5) == b"0 0\r\n"
    assert len(stated) == 1


def test_a_client_that_takes_the_line_for_itself_and_leaves_can_come_again() -> None:
    with closing(SeenOpening(reports_dtr=False)) as port:
        for _ in range(3):
            with serial.Serial(port.path, exclusive=True) as client:
                # The superuser may open it all the same: the system reports if it is taken.
                fcntl.ioctl(client.fileno(), termios.TIOCEXCL)
                assert _taken(client.fileno())
                client.write(b"e\r")
                assert received(port, 2) == b"e\r"
            assert packets(port, 0) == []
            with serial.Serial(port.path) as looking:
                assert not _taken(looking.fileno())


def test_where_the_system_reports_no_one_who_opens_a_line_there_is_one_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def exhausted(_path: str) -> int:
        raise OSError(errno.EMFILE, "too many open files")

    monkeypatch.setattr("firmware_bridge.runtime.ports.seen_opening._watch", exhausted)
    with closing(open_serial("pty", 57_600)) as port:
        assert isinstance(port, PseudoTerminal)
        with serial.Serial(port.path, 57_600) as client:
            client.write(b"e\r")
            assert received(port, 2) == b"e\r"
    with pytest.raises(PortError, match="omit --reset-on-open"):
        open_serial("pty", 57_600, reports_dtr=True)


def _taken(line: int) -> bool:
    return bool(int.from_bytes(fcntl.ioctl(line, TIOCGEXCL, bytes(4)), "little"))


def test_what_no_one_fetches_is_thrown_away_in_the_end() -> None:
    with closing(PseudoTerminal()) as port:
        for now in range(100):
            port.write(0, bytes(1000), now)
            port.flush(now + MILLISECOND)
        with serial.Serial(port.path, timeout=1) as client:
            client.reset_input_buffer()
            port.flush(SECOND)
            client.reset_input_buffer()
            port.write(0, b"after", SECOND)
            assert client.read_until(b"after").endswith(b"after")


def test_a_link_leads_to_the_terminal_and_is_gone_with_it(tmp_path: Path) -> None:
    link = tmp_path / "rars.tty"
    link.symlink_to("/nowhere/at/all")  # left behind by a run that was killed
    port = PseudoTerminal(link)
    assert os.path.realpath(link) == os.path.realpath(port.path)
    assert str(link) in port.name
    with serial.Serial(str(link), timeout=1) as client:
        client.write(b"x")
        assert received(port, 1) == b"x"
    port.close()
    port.close()
    assert not link.is_symlink()


def test_a_link_of_someone_else_s_is_left_alone(tmp_path: Path) -> None:
    link, taken = tmp_path / "link", tmp_path / "taken"
    port = PseudoTerminal(link)
    link.unlink()
    link.symlink_to("/dev/null")
    port.close()
    assert link.is_symlink()
    taken.write_text("a file")
    with pytest.raises(PortError, match=r"cannot make the link .*taken"):
        PseudoTerminal(taken)
    assert taken.read_text() == "a file"


def test_a_serial_line_through_pyserial() -> None:
    with closing(PseudoTerminal()) as other, closing(SerialLine(other.path, 115_200)) as line:
        line.write(0, REQUESTED_V2, 0)
        assert received(other, len(REQUESTED_V2)) == REQUESTED_V2
        other.write(0, ANSWERED_V2, 0)
        assert received(line, len(ANSWERED_V2)) == ANSWERED_V2
        line.close()


def test_a_serial_line_whose_other_end_is_gone_is_lost() -> None:
    other = PseudoTerminal()
    with closing(SerialLine(other.path, 115_200)) as line:
        other.close()
        with pytest.raises(LostPort, match="lost serial port"):
            line.read(0)
        with pytest.raises(LostPort, match="lost serial port"):
            line.write(0, b"x", 0)


def test_a_serial_port_that_cannot_be_opened_is_reported_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(PortError, match=r"no-such at 115200 Bd: there is no such device"):
        SerialLine(str(tmp_path / "no-such"), 115_200)
    with pytest.raises(PortError, match=r"/dev/null at 115200 Bd: it is no serial line"):
        SerialLine("/dev/null", 115_200)
    with (
        closing(PseudoTerminal()) as other,
        closing(SerialLine(other.path, 9600)),
        pytest.raises(PortError, match="in use"),
    ):
        SerialLine(other.path, 9600)


def test_a_link_of_one_member_reaches_that_one_only() -> None:
    one, two = Player((10, Packet(SERIAL, 0, b"hello")), (10, Packet("can", 1, b""))), Player()
    cluster = Cluster({"one": one, "two": two}, links={"one": {CAN: CAN, SERIAL: SERIAL}})
    cluster.wake(0)
    assert cluster.wake(10).sent == (Packet(SERIAL, 0, b"hello"), Packet("can", 1, b""))
    cluster.receive(Packet(SERIAL, 0, b"you"), 20)
    assert [packet.payload for _, packet in one.received] == [b"you"]
    assert [packet.link for _, packet in two.received] == ["can"]


class Client:
    """Client that opens the line again and again, and leaves in the middle of the last dialogue."""

    def __init__(self, drive: SerialEpos2, path: str) -> None:
        self.answers: list[bytes] = []
        self._drive = drive
        self._path = path
        self._serial: serial.Serial | None = None

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        return self._beside(self._drive.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        return self._beside(self._drive.wake(now), now)

    def _beside(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        """Do the client's next step, at most one in ten milliseconds."""
        if self._serial is None:
            self._serial = serial.Serial(self._path, 115_200, timeout=0)
            stated, self._awaited = (
                (b"\x90\x02half", b"") if len(self.answers) % 2 else (REQUESTED_V2, ANSWERED_V2)
            )
            self._serial.write(stated)
            self._received, self._since = b"", now
        self._received += self._serial.read(100)
        if now - self._since >= 30 * MILLISECOND and len(self._received) >= len(self._awaited):
            self.answers.append(self._received)
            self._serial.close()
            self._serial = None
        return Reaction(reaction.sent, min(reaction.wake_at, now + 5 * MILLISECOND))


def test_a_drive_on_a_pseudo_terminal_outlives_its_clients_in_real_time() -> None:
    drive = SerialEpos2(1, ServoAxis("near", 2000), motion=QuietMotion, generation=Generation.V2)
    with closing(PseudoTerminal()) as port:
        client = Client(drive, port.path)
        ending = run(client, {SERIAL: port}, Clock(), until=500 * MILLISECOND)
    assert ending.reason == "the time is over"
    assert len(client.answers) > 6
    assert set(client.answers[0::2]) == {ANSWERED_V2}
    assert set(client.answers[1::2]) == {b""}


def test_a_cable_that_is_pulled_takes_the_port_away_and_a_new_one_comes_back_under_its_link(
    tmp_path: Path,
) -> None:
    link = tmp_path / "board"
    with closing(SeenOpening(link)) as port:
        waits_at = port.fileno()
        with serial.Serial(str(link), timeout=1) as client:
            assert packets(port) == [(DTR_UP, b"")]
            port.write(LINE_LOST, b"", 0)
            with pytest.raises(serial.SerialException):
                client.read(1)
        assert not link.is_symlink()
        port.write(0, b"no one receives it", 0)
        assert (port.read(0), port.fileno()) == ([], waits_at)
        port.write(LINE_BACK, b"", 0)
        with serial.Serial(str(link), timeout=1) as client:
            assert packets(port) == [(DTR_UP, b"")]
            client.write(b"again")
            assert received(port, 5) == b"again"
            port.write(0, b"here", 0)
            assert client.read(4) == b"here"
    assert not link.is_symlink()
