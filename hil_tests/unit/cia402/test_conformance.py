"""CiA 301 and CiA 402 as a sequence of frames, on every emulated drive alike: the EPOS2 and the plain servo.

Sources: CiA 301 for network, SDO, PDO, heartbeat and emergencies; CiA 402-2 for the state machine. What
is a product's own (its optional objects, its Statusword's other bits) is masked, or left to its own tests.
"""

from collections.abc import Callable

import pytest

from emulators.canopen.slave import CanopenSlave
from emulators.cia402.servo import Servo
from emulators.epos2.drive import Epos2
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import MOTOR, DcMotors
from emulators.servo.winding import set_winding
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.canopen.cia402 import STATES, PowerState
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds

DRIVES: dict[str, Callable[[ServoAxis], CanopenSlave]] = {
    "cia402": lambda axis: Servo(1, axis),
    "epos2": lambda axis: Epos2(1, axis),
}
OFF, READY, ON, ENABLED = (
    PowerState.SWITCH_ON_DISABLED,
    PowerState.READY_TO_SWITCH_ON,
    PowerState.SWITCHED_ON,
    PowerState.OPERATION_ENABLED,
)
STATE_BITS = 0x6F


class Bus:
    """One drive with a motor; frames as text, in and out."""

    def __init__(self, made: Callable[[ServoAxis], CanopenSlave]) -> None:
        self.axis = ServoAxis("a", 2000)
        set_winding(self.axis, MOTOR.torque_constant, MOTOR.resistance, MOTOR.inductance)
        self.bank = ServoBank(DcMotors((MOTOR,)), [self.axis])
        self.drive = made(self.axis)
        self.now: Nanoseconds = 0
        self.sent: list[str] = []
        self._wake_at: Nanoseconds = 0
        self._took(self.drive.wake(0))
        self.run(50)

    def run(self, milliseconds: float) -> list[str]:
        """Let time pass; return what it has sent."""
        before, end = len(self.sent), self.now + round(milliseconds * MILLISECOND)
        while self.now < end:
            self.now, woken = self.bank.advance(min(end, max(self.now + 1, self._wake_at)))
            if woken or self.now >= self._wake_at:
                self._took(self.drive.wake(self.now))
        return self.sent[before:]

    def send(self, text: str) -> list[str]:
        """Put a frame on the bus; return what comes at once."""
        head, _, tail = text.partition("#")
        before = len(self.sent)
        self._took(self.drive.receive(Packet(CAN, int(head, 16), bytes.fromhex(tail)), self.now))
        return self.sent[before:]

    def write(self, head: str, raw: str = "") -> str:
        """Write an object; return `ok`, or the abort code."""
        (answer,) = [it for it in self.send(f"601#{(head + raw).ljust(16, '0')}") if it.startswith("581#")]
        code = bytes.fromhex(answer[12:])[::-1].hex().upper()
        return code if answer[4:6] == "80" else "ok"

    def read(self, address: str) -> int:
        """Read an object of up to four bytes: index in the order of the wire, subindex."""
        (answer,) = [it for it in self.send(f"601#40{address}".ljust(20, "0")) if it.startswith("581#")]
        assert answer[4:6] != "80", answer
        size = 4 - (int(answer[4:6], 16) >> 2 & 0b11)
        return int.from_bytes(bytes.fromhex(answer[12 : 12 + 2 * size]), "little")

    @property
    def state(self) -> PowerState | None:
        """By its Statusword, of which the bits of the state alone are alike."""
        return STATES.state_of(self.read("416000") & STATE_BITS)

    def command(self, *words: int) -> PowerState | None:
        """Write Controlwords one after the other; return the state that follows."""
        for word in words:
            assert self.write("2B406000", word.to_bytes(2, "little").hex()) == "ok"
            self.run(60)
        return self.state

    def _took(self, reaction: Reaction) -> None:
        self._wake_at = reaction.wake_at
        self.sent += [f"{it.address:03X}#{it.payload.hex().upper()}" for it in reaction.sent]


@pytest.fixture(params=DRIVES)
def bus(request: pytest.FixtureRequest) -> Bus:
    return Bus(DRIVES[request.param])


def test_it_boots_to_pre_operational_with_a_message_and_nothing_else(bus: Bus) -> None:
    assert bus.sent == ["701#00"]
    assert bus.drive.nmt_state is NmtState.PRE_OPERATIONAL


@pytest.mark.parametrize("before", ["01", "02", "80"])
@pytest.mark.parametrize(
    ("command", "target"),
    [("01", NmtState.OPERATIONAL), ("02", NmtState.STOPPED), ("80", NmtState.PRE_OPERATIONAL)],
)
@pytest.mark.parametrize("node", ["00", "01"])
def test_network_commands_lead_from_every_state_to_theirs(
    bus: Bus, before: str, command: str, target: NmtState, node: str
) -> None:
    bus.send(f"000#{before}01")
    bus.send(f"000#{command}{node}")
    assert bus.drive.nmt_state is target


@pytest.mark.parametrize("frame", ["000#0102", "000#01", "000#", "000#0301", "000#0001"])
def test_commands_for_others_and_odd_frames_change_nothing(bus: Bus, frame: str) -> None:
    assert bus.send(frame) == []
    assert bus.drive.nmt_state is NmtState.PRE_OPERATIONAL


@pytest.mark.parametrize("before", ["01", "02", "80"])
@pytest.mark.parametrize("command", ["81", "82"])
def test_both_resets_boot_again(bus: Bus, before: str, command: str) -> None:
    bus.send(f"000#{before}01")
    bus.send(f"000#{command}01")
    bus.run(50)
    assert bus.sent[-1] == "701#00"
    assert bus.drive.nmt_state is NmtState.PRE_OPERATIONAL


def test_a_stopped_drive_answers_no_sdo(bus: Bus) -> None:
    bus.send("000#0201")
    assert bus.send("601#4000100000000000") == []
    bus.send("000#8001")
    assert bus.send("601#4000100000000000") == ["581#4300100092010200"]


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        ("400050AA", "06020000"),
        ("40181009", "06090011"),
        ("2300100000000000", "06010002"),
        ("2B17100000", "ok"),
        ("2F17100000", "06070013"),
        ("E000000000000000", "05040001"),
    ],
)
def test_what_cannot_be_granted_is_refused_with_the_standards_code(
    bus: Bus, request_: str, code: str
) -> None:
    assert bus.write(request_) == code


def test_a_mapping_changes_while_its_pdo_is_off(bus: Bus) -> None:
    assert bus.write("23001401", "01020080") == "ok"
    assert bus.write("2F001600", "00") == "ok"
    assert bus.write("23001601", "10004060") == "ok"
    assert bus.write("23001602", "2000FF60") == "ok"
    assert bus.write("2F001600", "02") == "ok"
    assert bus.write("23001401", "01020000") == "ok"
    bus.send("000#0101")
    bus.send("201#0600E8030000")
    assert bus.read("FF6000") == 1000
    assert bus.state is READY


def test_a_shorter_pdo_writes_nothing_and_is_an_emergency(bus: Bus) -> None:
    bus.send("000#0101")
    bus.sent.clear()
    bus.send("201#06")
    bus.run(5)
    # For an EPOS2 it is a fault, too.
    assert bus.state in {OFF, PowerState.FAULT}
    assert any(it.startswith("081#1082") for it in bus.sent)


def test_outside_operational_no_pdo_is_received(bus: Bus) -> None:
    bus.send("201#0600")
    assert bus.state is OFF
    bus.send("000#0101")
    bus.send("201#0600")
    assert bus.state is READY


def test_a_heartbeat_is_produced_with_its_period_and_the_state(bus: Bus) -> None:
    assert bus.write("2B171000", "6400") == "ok"
    assert [it for it in bus.run(350) if it.startswith("701#")].count("701#7F") in {3, 4}
    bus.send("000#0101")
    assert set(bus.run(250)) >= {"701#05"}


def test_silence_of_the_watched_node_is_an_emergency_once(bus: Bus) -> None:
    assert bus.write("23161001", "C8000A00") == "ok"
    assert not [it for it in bus.run(500) if it.startswith("081#")]
    bus.send("70A#05")
    bus.run(150)
    bus.send("70A#05")
    assert not [it for it in bus.run(190) if it.startswith("081#")]
    assert [it[:8] for it in bus.run(500) if it.startswith("081#3081")] == ["081#3081"]


def test_the_state_machine_goes_its_ways(bus: Bus) -> None:
    assert bus.write("2F606000", "03") == "ok"
    assert bus.state is OFF
    assert bus.command(0x07) is OFF, "not from here"
    assert bus.command(0x06) is READY
    assert bus.command(0x07) is ON
    assert bus.command(0x0F) is ENABLED
    assert bus.command(0x07) is ON
    assert bus.command(0x06) is READY
    assert bus.command(0x00) is OFF
    assert bus.command(0x06, 0x07, 0x0F) is ENABLED
    assert bus.command(0x06) is READY
    assert bus.command(0x07, 0x0F) is ENABLED
    assert bus.command(0x00) is OFF


@pytest.mark.parametrize("word", [0x02, 0x0B])
def test_a_quick_stop_leaves_operation_enabled_and_stands(bus: Bus, word: int) -> None:
    bus.write("2F606000", "03")
    bus.command(0x06, 0x07, 0x0F)
    bus.write("23FF6000", (300).to_bytes(4, "little").hex())
    bus.run(300)
    assert bus.axis.step > 0
    assert bus.command(word) in {PowerState.QUICK_STOP_ACTIVE, OFF}
    bus.run(1500)
    assert bus.axis.step == 0


@pytest.mark.parametrize("mode", [1, 3, 6])
def test_a_mode_is_shown_once_it_is_in_force(bus: Bus, mode: int) -> None:
    assert bus.write("2F606000", f"{mode:02X}") == "ok"
    bus.run(5)
    assert bus.read("616000") == mode


def test_a_mode_that_there_is_not_is_refused(bus: Bus) -> None:
    assert bus.write("2F606000", "63") in {"06090030", "06090031"}
