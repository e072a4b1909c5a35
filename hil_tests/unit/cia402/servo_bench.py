"""One servo with a motor on a bus, advanced by hand: objects by SDO, process data as frames."""

from typing import Final

from emulators.cia402.servo import Servo
from emulators.cia402.variations import traits_of
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import MOTOR, DcMotors
from emulators.servo.winding import set_winding
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import STATES, Mode, PowerState
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds

NODE: Final = 5
COUNTS: Final = 2000
SHUTDOWN, SWITCH_ON, ENABLE, QUICK_STOP, DISABLE, RESET = 0x06, 0x07, 0x0F, 0x02, 0x00, 0x80


class ServoBench:
    """The servo, its motor, and every frame that it has sent."""

    def __init__(self, *variations: str) -> None:
        self.axis = ServoAxis("a", COUNTS)
        self.plant = DcMotors((MOTOR,))
        set_winding(self.axis, MOTOR.torque_constant, MOTOR.resistance, MOTOR.inductance)
        self.bank = ServoBank(self.plant, [self.axis])
        self.servo = Servo(NODE, self.axis, traits_of(variations))
        self.now: Nanoseconds = 0
        self.frames: list[str] = []
        self.states: list[PowerState | None] = []
        """Each state that the Statusword has shown, once where it lasts."""
        self._wake_at: Nanoseconds = 0
        self._took(self.servo.wake(0))
        self.run(10)

    def _took(self, reaction: Reaction) -> None:
        self._wake_at = reaction.wake_at
        self.frames += [f"{it.address:03X}#{it.payload.hex().upper()}" for it in reaction.sent]
        state = self.state
        if not self.states or self.states[-1] is not state:
            self.states.append(state)

    def run(self, milliseconds: float) -> None:
        end = self.now + round(milliseconds * MILLISECOND)
        while self.now < end:
            self.now, woken = self.bank.advance(max(self.now + 1, min(end, self._wake_at)))
            if woken or self.now >= self._wake_at:
                self._took(self.servo.wake(self.now))

    def send(self, frame: str) -> list[str]:
        """Put a frame on the bus; return what it is answered with."""
        head, _, tail = frame.partition("#")
        before = len(self.frames)
        self._took(self.servo.receive(Packet(CAN, int(head, 16), bytes.fromhex(tail)), self.now))
        return self.frames[before:]

    def write(self, address: Address, value: int) -> int:
        """Write an object by SDO; return the abort code, 0 for none."""
        size = self.servo.store.objects[address].type.size
        command = {1: 0x2F, 2: 0x2B, 4: 0x23}[size]
        raw = (value & (1 << 8 * size) - 1).to_bytes(4, "little")
        head = bytes((command, address.index & 0xFF, address.index >> 8, address.subindex))
        answers = self.send(f"{0x600 + NODE:03X}#{(head + raw).hex()}")
        (answer,) = [bytes.fromhex(it[4:]) for it in answers if it.startswith("585#")]
        return int.from_bytes(answer[4:], "little") if answer[0] == 0x80 else 0

    def read(self, address: Address) -> int:
        return self.servo.store.live(address)

    def command(self, *words: int) -> None:
        for word in words:
            assert self.write(od.CONTROLWORD, word) == 0
            self.run(2)

    def enable(self, mode: Mode) -> "ServoBench":
        assert self.write(od.MODE, mode) == 0
        self.command(SHUTDOWN, SWITCH_ON, ENABLE)
        assert self.state is PowerState.OPERATION_ENABLED
        return self

    @property
    def statusword(self) -> int:
        return self.read(od.STATUSWORD)

    @property
    def state(self) -> PowerState | None:
        return STATES.state_of(self.statusword)

    def has(self, bit: int) -> bool:
        return bool(self.statusword >> bit & 1)

    @property
    def position(self) -> int:
        return self.read(od.POSITION_ACTUAL)

    @property
    def emergencies(self) -> list[int]:
        """Codes of the emergencies so far."""
        sent = [bytes.fromhex(it[4:]) for it in self.frames if it.startswith(f"{0x80 + NODE:03X}#")]
        return [int.from_bytes(it[:2], "little") for it in sent]
