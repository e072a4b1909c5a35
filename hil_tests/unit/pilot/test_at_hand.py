"""From a joystick's bytes to the station's messages: devices made of rows, no joystick."""

import struct

import pytest

from firmware_bridge.mavlink.frames import Codec, Message, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.pilot.cockpit import HAND, Cockpit
from firmware_bridge.pilot.driver import Extras, Stick
from firmware_bridge.pilot.hand import StickInput
from firmware_bridge.pilot.joystick import DEVICES, FULL, At, Controls, Device, is_gamepad
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.pilot.station import PilotStation
from firmware_bridge.units import MILLISECOND, NEVER, SECOND

ROW = Device(
    "fake", At(1, 0), At(4, FULL), At(5, FULL), At(6, 0), reverse=7, arm=8, stop=9, switches=(10, 11)
)


def event(kind: int, number: int, value: int) -> bytes:
    return struct.pack("<IhBB", 1234, value, kind, number)


AT_REST = event(0x82, 1, 0) + event(0x82, 4, FULL) + event(0x82, 5, FULL) + event(0x82, 6, 0)


class Desk:
    """A cockpit with a fake device, and the robot's end of its link."""

    def __init__(self, device: Device = ROW) -> None:
        self.hand = StickInput(Controls(device))
        self.lines: list[str] = []
        self.station = PilotStation(self.hand, (1, 1))
        self.cockpit = Cockpit(self.station, self.lines.append)
        self._robot = Codec(1, 1)
        self.now = 0

    def do(self, *events: bytes) -> None:
        self.cockpit.receive(Packet(HAND, 0, b"".join(events)), self.now)

    def receives(self, message: Message) -> None:
        self.cockpit.receive(Packet(OPERATOR, 77, self._robot.encode(message)), self.now)

    def armed(self) -> None:
        """Let it be armed while everything rests."""
        self.do(AT_REST)
        self.beats(armed=True)
        self.states()

    def beats(self, *, armed: bool) -> None:
        bits = dialect.MAV_MODE_FLAG_SAFETY_ARMED if armed else 0
        self.receives(dialect.MAVLink_heartbeat_message(10, 0, bits, 0, dialect.MAV_STATE_ACTIVE, 3))

    def states(self) -> list[Message]:
        self.now += 50 * MILLISECOND
        sent = self.cockpit.wake(self.now).sent
        return [message for packet in sent for message in self._robot.decode(packet.payload)]

    def stick(self) -> tuple[int, int]:
        x, _, r = self.motion()
        return x, r

    def motion(self) -> tuple[int, int, int]:
        (one,) = [message for message in self.states() if message.get_type() == "MANUAL_CONTROL"]
        return one.x, one.z, one.r


@pytest.mark.parametrize(
    ("helm", "pedal", "brake", "stick"),
    [
        (0, FULL, FULL, (0, 0)),
        (0, -FULL, FULL, (1000, 0)),
        (FULL, -FULL, FULL, (1000, 1000)),  # right is clockwise, as MAVLink counts
        (-32768, FULL, FULL, (0, -1000)),
        (0, 0, FULL, (500, 0)),
        (0, -FULL, 0, (500, 0)),
        (0, 0, -FULL, (0, 0)),
        (0, 30_000, FULL, (0, 0)),  # play
    ],
)
def test_helm_and_pedals_are_the_stick(helm: int, pedal: int, brake: int, stick: tuple[int, int]) -> None:
    desk = Desk()
    desk.armed()
    desk.do(event(0x82, 1, helm), event(0x82, 4, pedal), event(2, 5, brake))
    assert desk.stick() == stick


def test_before_the_robot_is_armed_the_true_place_is_stated_whatever_the_brake_takes_from_it() -> None:
    """So the bridge sees it, and refuses to arm."""
    desk = Desk()
    desk.do(AT_REST, event(2, 4, -FULL), event(2, 1, FULL))
    assert desk.stick() == (1000, 1000)
    desk.do(event(2, 5, -FULL))
    assert desk.stick() == (1000, 1000)


@pytest.mark.parametrize(
    ("held", "rests", "then"),
    [
        (event(2, 4, -FULL), event(2, 4, FULL), event(2, 4, 0)),
        (event(2, 4, -FULL) + event(2, 5, -FULL), event(2, 4, FULL) + event(2, 5, FULL), event(2, 4, 0)),
        (event(2, 1, FULL), event(2, 1, 0), event(2, 4, 0)),
        (event(2, 6, -FULL), event(2, 6, 0), event(2, 4, 0)),
    ],
    ids=["accelerator", "accelerator and brake", "helm", "up"],
)
@pytest.mark.parametrize("own", [True, False])
def test_what_is_held_when_it_is_armed_counts_when_it_has_been_at_rest(
    held: bytes, rests: bytes, then: bytes, *, own: bool
) -> None:
    """Armed by its own button, or by someone else."""
    desk = Desk()
    desk.do(AT_REST, held)
    if own:
        desk.do(event(1, 8, 1))
    desk.states()
    desk.beats(armed=True)
    assert [desk.motion() for _ in range(20)] == [(0, 0, 0)] * 20
    desk.do(event(2, 5, FULL))
    assert desk.motion() == (0, 0, 0), "the brake alone is not let go"
    desk.do(rests)
    assert desk.motion() == (0, 0, 0)
    desk.do(then)
    assert desk.motion() == (500, 0, 0)
    desk.beats(armed=False)
    desk.states()
    desk.beats(armed=True)
    assert desk.motion() == (0, 0, 0), "armed again, it is to rest again"


def test_what_is_trodden_on_after_the_button_was_pressed_and_before_that_was_seen_drives_on() -> None:
    desk = Desk()
    desk.do(AT_REST, event(1, 8, 1))
    assert desk.motion() == (0, 0, 0)
    desk.do(event(2, 4, 0))
    assert desk.motion() == (500, 0, 0)
    desk.beats(armed=True)
    assert desk.motion() == (500, 0, 0)


def test_a_control_that_has_reported_nothing_yet_does_not_count() -> None:
    desk = Desk()
    desk.beats(armed=True)
    desk.do(event(2, 4, -FULL), event(2, 1, FULL), event(2, 6, FULL))
    assert desk.motion() == (0, 0, 0)


@pytest.mark.parametrize("controls", DEVICES)
def test_a_gamepad_that_no_one_touches_moves_nothing_whatever_it_is_taken_for(controls: str) -> None:
    """Its triggers rest at one end, as the other device's pedals are trodden down; xpad numbers them so."""
    desk = Desk(DEVICES[controls])
    desk.do(*(event(0x82, axis, -FULL if axis in {2, 5} else 0) for axis in range(8)))
    stated = desk.motion()
    assert (stated == (0, 0, 0)) is (controls == "gamepad"), "the bridge sees what is deflected"
    desk.beats(armed=True)
    assert [desk.motion() for _ in range(20)] == [(0, 0, 0)] * 20


@pytest.mark.parametrize(
    ("name", "codes", "states"),
    [
        ("Microsoft X-Box 360 pad", (), True),
        ("Logitech Gamepad F310", (), True),
        ("Sony Interactive Entertainment DualSense Wireless Controller", (), True),
        ("Nintendo Switch Pro Controller", (), True),
        ("Someone's device", (0, 1, 2, 3, 4, 5, 16, 17), True),
        ("Logitech G29 Driving Force Racing Wheel", (0, 1, 2, 5, 16, 17), False),
        ("", (), False),
    ],
)
def test_a_device_states_that_it_is_a_gamepad_by_its_name_or_its_second_stick(
    name: str, codes: tuple[int, ...], *, states: bool
) -> None:
    assert is_gamepad(name, codes) is states


def test_reverse_changes_only_while_no_one_drives() -> None:
    desk = Desk()
    desk.armed()
    desk.do(event(2, 4, -FULL), event(1, 7, 1), event(1, 7, 0))
    assert desk.stick() == (1000, 0)
    desk.do(event(2, 4, FULL), event(1, 7, 1), event(1, 7, 0), event(2, 4, -FULL))
    assert desk.stick() == (-1000, 0)


def test_bytes_may_be_cut_anywhere_and_states_at_opening_press_nothing() -> None:
    controls = Controls(ROW)
    whole = event(0x81, 9, 1) + event(2, 1, -FULL) + event(1, 8, 1)
    cuts = (whole[place : place + 1] for place in range(len(whole)))
    pressed = [button for cut in cuts for button in controls.received(cut)]
    assert (controls.helm, pressed) == (1.0, [8])


@pytest.mark.parametrize(("button", "command", "param"), [(8, 400, 1.0), (9, 5300, 0.0)])
def test_buttons_arm_and_stop(button: int, command: int, param: float) -> None:
    desk = Desk()
    desk.do(event(1, button, 1))
    orders = [(one.command, one.param1) for one in desk.states() if one.get_type() == "COMMAND_LONG"]
    assert orders == [(command, param)]


def test_an_order_is_repeated_until_it_is_answered() -> None:
    desk = Desk()
    desk.do(event(1, 8, 1))
    requested = [sum(one.get_type() == "COMMAND_LONG" for one in desk.states()) for _ in range(45)]
    assert sum(requested) == 3
    desk.receives(dialect.MAVLink_command_ack_message(400, 0))
    assert not any(one.get_type() == "COMMAND_LONG" for _ in range(45) for one in desk.states())


def test_what_it_shows_is_what_the_link_brought() -> None:
    desk = Desk()
    desk.receives(dialect.MAVLink_named_value_float_message(0, b"AGE", 0.25))
    desk.receives(dialect.MAVLink_statustext_message(4, b"the lift is up"))
    desk.now = SECOND
    desk.states()
    assert any("AGE 0.25" in line and "disarmed" in line for line in desk.lines)
    assert any(line.endswith("the lift is up") for line in desk.lines)


def test_at_the_end_it_lets_go_and_disarms() -> None:
    desk = Desk()
    desk.armed()
    last = desk.cockpit.stop(SECOND)
    assert last.wake_at == NEVER
    orders = [
        one for packet in last.sent for one in Codec(1, 1).decode(packet.payload) if one.get_msgId() == 76
    ]
    assert [(one.command, one.param1) for one in orders] == [(400, 0.0)]


def test_every_device_has_its_own_number_for_each_thing() -> None:
    for device in DEVICES.values():
        assert len({at.number for at in (device.helm, device.accelerator, device.brake, device.rise)}) == 4
        assert len({device.reverse, device.arm, device.stop}) == 3


def test_switches_and_the_lift_are_buttons_of_the_stick() -> None:
    hand = StickInput(Controls(ROW), Extras(switches=(4, 1), up_button=3))
    link = PilotLink()
    assert list(hand.handle(AT_REST + event(1, 10, 1), 0)) == []
    hand.command(link, 0, armed=True)
    list(hand.handle(event(2, 6, -FULL), 0))
    assert hand.command(link, 0, armed=True) == Stick(up=1.0, buttons=1 << 4 | 1 << 3)
    list(hand.handle(event(1, 10, 0) + event(1, 11, 1) + event(2, 6, 0), 0))
    assert hand.command(link, 0, armed=True) == Stick(buttons=1 << 1)


def test_a_switch_that_was_down_when_the_device_was_opened_is_not_pressed() -> None:
    hand = StickInput(Controls(ROW), Extras(switches=(4,)))
    list(hand.handle(event(0x81, 10, 1), 0))
    assert hand.command(PilotLink(), 0, armed=True).buttons == 0


def test_the_button_that_arms_takes_nothing_from_who_drives() -> None:
    desk = Desk()
    desk.armed()
    desk.do(event(2, 4, 0))
    assert desk.motion() == (500, 0, 0)
    desk.do(event(1, 8, 1))
    assert desk.motion() == (500, 0, 0)
