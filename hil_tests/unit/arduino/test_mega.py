"""The Mega's own traits: rates, rings, a clock that skips, a second of deafness, the chip on its USB side."""

import pytest

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.mega.arithmetic import atoi, int16, int32, quotient
from emulators.arduino_omni.mega.clock import Clock
from emulators.arduino_omni.mega.jobs import Delay, OnBus, Say
from emulators.arduino_omni.mega.mega import Mega, MegaOnPins
from emulators.arduino_omni.mega.pins import Counter, Pins, Shafts
from emulators.arduino_omni.mega.uart import Uart, divider
from emulators.arduino_omni.shield.i2c import TransferResult, write
from emulators.arduino_omni.shield.motor_shield import PORTS
from emulators.arduino_omni.shield.tb6612 import COAST, BridgeDuty
from emulators.arduino_omni.usb_board import UsbBoard
from emulators.wires import SerialWire
from emulators.world import World
from firmware_bridge.node import DTR_DOWN, DTR_UP, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MICROSECOND, MILLISECOND, NEVER, SECOND, Nanoseconds

ADDRESS = 0x60
SETUP_AT = 1_100 * MILLISECOND


@pytest.mark.parametrize(
    ("baud", "ubrr", "double_speed", "rate"),
    [
        (9_600, 207, True, 9_615),
        (57_600, 16, False, 58_824),
        (115_200, 16, True, 117_647),
        (230_400, 8, True, 222_222),
        (250_000, 7, True, 250_000),
        (500_000, 3, True, 500_000),
        (1_000_000, 1, True, 1_000_000),
        (300, 3_332, False, 300),
    ],
)
def test_the_rate_is_what_the_divider_makes(baud: int, ubrr: int, double_speed: bool, rate: int) -> None:  # noqa: FBT001
    made = divider(baud)
    assert (made.ubrr, made.double_speed, made.rate) == (ubrr, double_speed, rate)


def test_the_receive_ring_holds_63_bytes_and_drops_the_newest() -> None:
    uart = Uart(115_200)
    for byte in range(70):
        uart.arrived(byte)
    assert (uart.available, uart.lost) == (63, 7)
    assert [uart.read() for _ in range(64)] == [*range(63), -1]


def test_bytes_leave_one_after_the_other_and_write_waits_for_room() -> None:
    uart = Uart(1_000_000)  # 10 us a byte
    assert uart.write(bytes(65), 100) == 100
    assert uart.write(b"x", 100) == 100 + 10 * MICROSECOND
    assert uart.leaves_at() == 100 + 10 * MICROSECOND
    assert len(uart.taken(100 + 20 * MICROSECOND)) == 2
    assert len(uart.taken(NEVER)) == 64


@pytest.mark.parametrize(
    ("at_us", "millis"),
    [
        (0, 0),
        (1_023, 0),
        (1_024, 1),
        (41 * 1_024, 41),
        (42 * 1_024, 43),
        (125 * 1_024, 128),
        (1_024_000_000, 1_024_000),
    ],
)
def test_millis_counts_overflows_and_skips_one_now_and_then(at_us: int, millis: int) -> None:
    assert Clock(7).millis(7 + at_us * MICROSECOND) == millis


def test_42_is_never_seen_and_waiting_for_it_ends_with_43() -> None:
    clock = Clock(0)
    seen = {clock.millis(n * 1_024 * MICROSECOND) for n in range(200)}
    assert set(range(200)) - seen == {42, 85, 127, 170}
    assert clock.shows(42, 0) == 42 * 1_024 * MICROSECOND
    for value in range(1, 400):
        at = clock.shows(value, 0)
        assert clock.millis(at) >= value > clock.millis(at - 1)
    assert clock.shows(5, SECOND) == SECOND


def test_the_clocks_wrap() -> None:
    clock = Clock(0)
    days = 2**32 * MILLISECOND
    assert clock.millis(days - 2 * MILLISECOND) > 2**32 - 5
    assert clock.millis(days + 2 * MILLISECOND) < 5
    at = clock.shows(3, days - 2 * MILLISECOND)
    assert clock.millis(at) == 3 != clock.millis(at - 1)
    assert clock.micros(2**32 * MICROSECOND + 7 * MICROSECOND) == 4


def test_numbers_are_as_wide_as_the_avrs() -> None:
    assert (int16(40_000), int16(32_767), int16(-32_769), int32(2**31)) == (-25_536, 32_767, 32_767, -(2**31))
    assert [quotient(*it) for it in ((7, 2), (-7, 2), (7, -2), (-7, -2), (5, 0), (-5, 0))] == [
        3,
        -3,
        -3,
        3,
        -1,
        1,
    ]
    assert [atoi(it) for it in (b"12x", b" -5", b"", b"x", b"40000", b"+7", b"--1")] == [
        12,
        -5,
        0,
        0,
        -25_536,
        7,
        0,
    ]


def test_pins_are_inputs_until_reported_otherwise() -> None:
    pins = Pins()
    pins.driven[7] = True
    assert [pins.read(it) for it in (7, 8, 99)] == [1, 0, 0]
    pins.configure(8, 2)
    assert pins.read(8) == 1
    pins.configure(13, 1)
    pins.write(13, 1)
    assert pins.read(13) == 1
    pins.write_analog(9, 100)
    assert pins.duties == {9: 100}
    pins.write_analog(9, 255)
    assert (pins.duties, pins.read(9)) == ({}, 1)
    pins.reset()
    assert [pins.read(it) for it in (7, 8, 9, 13)] == [1, 0, 0, 0]


def test_a_counter_counts_from_where_it_was_made_on_pins_with_interrupts() -> None:
    shafts = Shafts()
    shafts.edges[:] = [100, 200, 300]
    ahead, back, third = Counter(shafts, 2, 3, 16), Counter(shafts, 19, 18, 32), Counter(shafts, 10, 11, 16)
    changes = Counter(shafts, 10, 11, 16, any_pin=True)
    nothing = Counter(shafts, 20, 21, 16)
    shafts.edges[:] = [40_100, 205, 301]
    assert [it.count for it in (ahead, back, third, changes, nothing)] == [-25_536, -5, 0, 1, 0]
    ahead.set(7)
    shafts.edges[0] += 3
    assert ahead.count == 10


# The board as a whole


class Echo:
    """Sketch that sends its input back; `!` keeps it busy for 100 ms, `m` drives motor 1."""

    def __init__(self, mega: Mega) -> None:
        self.mega = mega
        self.read_at: list[tuple[int, Nanoseconds]] = []
        self.results: list[TransferResult] = []

    def setup(self) -> None:
        self.mega.do(Say(b"hello"))

    def loop(self, now: Nanoseconds) -> None:
        byte = self.mega.serial.read()
        self.read_at.append((byte, now))
        if byte == ord("!"):
            self.mega.do(Delay(100 * MILLISECOND))
        elif byte == ord("b"):
            self.mega.do_all(library.begin(ADDRESS))
        elif byte == ord("m"):
            self.mega.do_all(library.drive(ADDRESS, PORTS[0], 128, 1))
        elif byte == ord("?"):
            self.mega.do(OnBus(write(ADDRESS, b"\0"), self.answered), Say(b"after"))
        else:
            self.mega.do(Say(bytes((byte,))))

    def answered(self, result: TransferResult, _now: Nanoseconds) -> None:
        self.results.append(result)
        self.mega.do(Say(b"first "))

    def due(self, _now: Nanoseconds) -> Nanoseconds:
        return NEVER


class Host:
    """Host at the other end, in virtual time by hand."""

    def __init__(self, board: UsbBoard) -> None:
        self.board = board
        self.received: list[tuple[Nanoseconds, bytes]] = []
        self.take(board.wake(0), 0)

    def take(self, reaction: Reaction, now: Nanoseconds) -> None:
        self.received.extend((now, packet.payload) for packet in reaction.sent)
        self.wake_at = reaction.wake_at

    def run(self, until: Nanoseconds) -> "Host":
        while self.wake_at <= until:
            at = self.wake_at
            self.take(self.board.wake(at), at)
        self.now = until
        return self

    def say(self, data: bytes, address: int = 0) -> None:
        self.take(self.board.receive(Packet(SERIAL, address, data), self.now), self.now)

    @property
    def text(self) -> bytes:
        return b"".join(data for _, data in self.received)


def board() -> UsbBoard:
    return UsbBoard(Mega(Echo, 1_000_000))


def sketch_of(it: UsbBoard) -> Echo:
    assert isinstance(it.mega.sketch, Echo)
    return it.mega.sketch


def test_a_boot_loader_that_receives_a_byte_keeps_it_and_stays_until_none_has_come_for_9_s() -> None:
    """stk500v2: whatever byte comes within its second, frame of its own or not."""
    host = Host(board()).run(SETUP_AT - MILLISECOND)
    host.say(b"lost")
    host.run(5 * SECOND)
    host.say(b"and again")
    assert host.run(14 * SECOND).text == b""
    assert host.run(15 * SECOND).text == b"hello"
    host.say(b"x")
    assert host.run(16 * SECOND).text == b"hellox"


def test_a_reset_frees_a_board_from_its_loader() -> None:
    host = Host(board()).run(SECOND)
    host.say(b"lost")
    host.run(3 * SECOND)
    host.say(b"", DTR_DOWN)
    host.say(b"", DTR_UP)
    assert host.run(3 * SECOND + SETUP_AT + 5 * MILLISECOND).text == b"hello"


def test_the_usb_chip_hands_over_every_4096_us() -> None:
    host = Host(board()).run(2 * SECOND)
    ((at, data),) = host.received
    assert data == b"hello"
    assert at % (4_096 * MICROSECOND) == 0
    assert 0 < at - SETUP_AT <= 4_096 * MICROSECOND


def test_more_than_96_bytes_do_not_wait_for_the_timer() -> None:
    host = Host(UsbBoard(Mega(Echo, 1_000_000), flush=SECOND)).run(SETUP_AT)
    host.run(2 * SECOND)
    host.received.clear()
    host.say(bytes(200))
    host.run(3 * SECOND - 1)
    assert [len(data) for _, data in host.received] == [97, 97]
    assert [at - 2 * SECOND for at, _ in host.received] == [980 * MICROSECOND, 1_950 * MICROSECOND]


def test_bytes_pass_the_usb_chip_at_the_lines_rate_and_the_ring_overflows() -> None:
    it = UsbBoard(Mega(Echo, 1_000_000))
    host = Host(it).run(2 * SECOND)
    host.say(b"!" + bytes(range(100)))
    host.run(3 * SECOND)
    read = sketch_of(it).read_at
    assert read[0] == (ord("!"), 2 * SECOND + 10 * MICROSECOND)
    assert [byte for byte, _ in read[1:]] == list(range(63))
    assert it.mega.serial.lost == 37
    assert read[1][1] == 2 * SECOND + 10 * MICROSECOND + 100 * MILLISECOND


def test_what_follows_a_transfer_comes_before_what_waits() -> None:
    it = board()
    host = Host(it).run(2 * SECOND)
    host.say(b"?")
    host.run(3 * SECOND)
    assert host.text == b"hellofirst after"
    assert sketch_of(it).results == [TransferResult(acknowledged=True, read=b"")]


RUNS = BridgeDuty(cw=2048, brake=2048)


def moving() -> tuple[Host, Mega]:
    it = board()
    host = Host(it).run(2 * SECOND)
    host.say(b"bm")
    host.run(3 * SECOND)
    assert it.mega.shield.outputs(host.now)[0] == RUNS
    return host, it.mega


def test_the_shield_runs_on_while_the_board_starts_again() -> None:
    host, mega = moving()
    host.say(b"", DTR_UP)
    assert mega.sketch is None
    host.run(3 * SECOND + SETUP_AT - 1)
    assert mega.shield.outputs(host.now)[0] == RUNS
    host.run(5 * SECOND)
    assert mega.resets == 2
    assert mega.shield.outputs(host.now)[0] == RUNS  # this sketch calls no begin()
    host.say(b"b")
    host.run(6 * SECOND)
    assert mega.shield.outputs(host.now)[0] == COAST


def test_dtr_resets_when_it_rises_and_only_then() -> None:
    host, mega = moving()
    host.say(b"", DTR_DOWN)
    host.say(b"", DTR_UP)
    host.say(b"", DTR_UP)
    assert mega.resets == 2
    host.say(b"", DTR_DOWN)
    assert mega.resets == 2
    host.say(b"", DTR_UP)
    assert mega.resets == 3


def test_a_reset_cuts_a_transfer_where_it_is() -> None:
    host, mega = moving()
    host.say(b"b")
    host.run(3 * SECOND + 10 * MICROSECOND + 200 * MICROSECOND)  # MODE1's new value has not passed
    host.say(b"", DTR_UP)
    host.run(5 * SECOND)
    assert mega.shield.chip.register(0) == 0x21
    assert mega.bus.due == NEVER


def test_late_wakes_change_nothing() -> None:
    """A pty's loop comes late; what is then done has its own instants all the same."""
    exact, late = board(), board()
    early = Host(exact).run(2 * SECOND)
    early.say(b"bm")
    early.run(3 * SECOND)
    late.wake(0)
    late.receive(Packet(SERIAL, 0, b"bm"), 2 * SECOND)
    late.wake(3 * SECOND)
    assert sketch_of(late).read_at == sketch_of(exact).read_at
    assert late.mega.bus.busy == exact.mega.bus.busy > 0
    assert late.mega.shield.outputs(3 * SECOND)[0] == RUNS


def test_on_its_pins_it_is_a_node_on_a_serial_wire_at_its_true_rate() -> None:
    class Listener:
        def __init__(self) -> None:
            self.received: list[tuple[Nanoseconds, bytes]] = []

        def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
            self.received.append((now, packet.payload))
            return Reaction((), 2 * SECOND if now < 2 * SECOND else NEVER)

        def wake(self, now: Nanoseconds) -> Reaction:
            return Reaction((Packet(SERIAL, 0, b"x"),) if now else (), 2 * SECOND if now == 0 else NEVER)

    world = World()
    line = SerialWire(117_647)
    host = Listener()
    world.attach("host", host, {SERIAL: line})
    world.attach("board", MegaOnPins(Mega(Echo, 115_200)), {SERIAL: line})
    world.run(3 * SECOND)
    assert b"".join(data for _, data in host.received) == b"hellox"
    byte = 10 * SECOND // 117_647
    assert [at for at, _ in host.received[:2]] == [SETUP_AT + byte, SETUP_AT + 2 * 10 * SECOND // 117_647]
    assert host.received[5][0] == 2 * SECOND + 2 * byte
