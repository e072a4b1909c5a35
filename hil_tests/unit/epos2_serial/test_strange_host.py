"""A third party on the serial line sends anything at any time: no exception, no hang, and then a good answer.

The drive is whole, with its own motion control above an axis that never moves. After the documented silence
it must have forgotten everything and answer a good command in full.
"""

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule

from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.epos2.serial.serial_drive import SerialEpos2
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.maxon import messages
from firmware_bridge.families.epos2.maxon.frame import Frame, Generation, encode_v1, encode_v2
from firmware_bridge.families.epos2.maxon.opcodes import COMMANDS, encode_request
from firmware_bridge.families.epos2.maxon.v2 import FrameReader
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import REMOTE, frame_bits
from hil_tests.lanes import examples

NODE = 5
LONGEST = 500
"""The largest time-out in ms that the third party knows how to set."""

OBJECT = st.sampled_from(list(EPOS2_70_10.objects)) | st.builds(
    Address, st.integers(0, 0xFFFF), st.integers(0, 0xFF)
)
NODES = st.sampled_from([0, NODE, NODE, 7, 128, 255])
FOUR = st.binary(min_size=4, max_size=4) | st.sampled_from([b"save", b"load", bytes(4), b"\x06\0\0\0"])
WORD = st.integers(0, 0xFFFF)
CONTROL = st.integers(0, 0xFF)
REQUESTED = st.one_of(
    st.builds(messages.SendNmtService, NODES, st.sampled_from([1, 2, 128, 129, 130, 77])),
    st.builds(lambda a, n: messages.ReadObject(a.index, a.subindex, n), OBJECT, NODES),
    st.builds(lambda a, n, raw: messages.WriteObject(a.index, a.subindex, n, raw), OBJECT, NODES, FOUR),
    st.builds(lambda a, n: messages.InitiateSegmentedRead(a.index, a.subindex, n), OBJECT, NODES),
    st.builds(
        lambda a, n, size: messages.InitiateSegmentedWrite(a.index, a.subindex, n, size),
        OBJECT,
        NODES,
        st.integers(0, 200),
    ),
    st.builds(messages.SegmentRead, st.sampled_from([0, 0x40]) | CONTROL),
    st.builds(messages.SegmentWrite, CONTROL, st.binary(max_size=63)),
    st.builds(messages.SendCanFrame, WORD, st.integers(0, 9), st.binary(min_size=8, max_size=8)),
    st.builds(messages.RequestCanFrame, st.sampled_from([0x185, 0x181, 0x800]) | WORD, st.integers(0, 9)),
    st.builds(messages.SendLssFrame, st.binary(min_size=8, max_size=8)),
    st.builds(messages.ReadLssFrame, st.integers(0, LONGEST)),
)


class StrangeHost(RuleBasedStateMachine):
    """Each rule is something that a third party may do."""

    generation = Generation.V1

    @initialize()
    def plug_in(self) -> None:
        self.drive = SerialEpos2(NODE, ServoAxis("foreign", 2000), EPOS2_70_10, generation=self.generation)
        self.now: Nanoseconds = 0
        self.commands = 0
        self.due = self._checked(self.drive.wake(0)).wake_at

    @rule(chunk=st.binary(max_size=40))
    def say_anything(self, chunk: bytes) -> None:
        self._say(chunk)

    @rule(chunk=st.lists(st.sampled_from([0x4F, 0x46, 0x90, 0x02, 0x10, 0x00]), max_size=8))
    def say_what_hurts(self, chunk: list[int]) -> None:
        self._say(bytes(chunk))

    @rule(request=REQUESTED, cut=st.integers(0, 80), agrees=st.booleans())
    def ask(self, request: messages.Request, cut: int, agrees: bool) -> None:  # noqa: FBT001 - by name
        if isinstance(request, messages.WriteObject) and request.index in {0x2005, 0x2006}:
            return  # the silence that ends everything must have a known length
        raw = self._encoded(encode_request(request))
        self._say(raw[:cut] if cut < 40 else raw)
        if agrees:
            self._say(b"O")
            self._say(b"O")

    @rule(opcode=st.sampled_from(sorted(set(COMMANDS) - {0x31})), body=st.binary(max_size=20))
    def ask_nonsense_in_good_frames(self, opcode: int, body: bytes) -> None:
        self._say(self._encoded(Frame(opcode, body + bytes(2 - len(body) % 2))))

    @rule(address=st.sampled_from([0x587, 0x7E4, 0x181, 0x605, 0x000, 0x185]), raw=st.binary(max_size=8))
    def receive_the_bus(self, address: int, raw: bytes) -> None:
        self._take(self.drive.receive(Packet(CAN, address, raw), self.now))

    @rule(wait=st.integers(0, 700 * MILLISECOND))
    def wait(self, wait: Nanoseconds) -> None:
        self._wait(wait)

    @rule()
    def fall_silent_and_ask_well(self) -> None:
        """After the time-out of each command that may still wait, a good one is answered."""
        self._wait((self.commands + 1) * (2 * LONGEST + 10) * MILLISECOND)
        self.commands = 0
        self._wait(SECOND)
        received = self._say(self._encoded(Frame(0x10, bytes.fromhex("00100000"))))
        answer = Frame(0x00, bytes.fromhex("0000000092010200"))
        if self.generation is Generation.V2:
            assert received == encode_v2(answer)
            return
        assert received == b"OO\0"
        assert self._say(b"O") == encode_v1(answer)[1:]
        assert self._say(b"O") == b""

    def _encoded(self, frame: Frame) -> bytes:
        return encode_v1(frame) if self.generation is Generation.V1 else encode_v2(frame)

    def _say(self, chunk: bytes) -> bytes:
        self.commands += 1 + len(chunk) // 6
        return self._take(self.drive.receive(Packet(SERIAL, 0, chunk), self.now))

    def _wait(self, duration: Nanoseconds) -> None:
        until = self.now + duration
        for _ in range(100_000):
            if self.due > until:
                break
            assert self.due > self.now or self.due == 0 or self.drive.wake(self.now).wake_at > self.now
            self.now = max(self.now, self.due)
            self._take(self.drive.wake(self.now))
        else:
            raise AssertionError("it never rests")
        self.now = until

    def _take(self, reaction: Reaction) -> bytes:
        self.due = self._checked(reaction).wake_at
        return b"".join(packet.payload for packet in reaction.sent if packet.link == SERIAL)

    def _checked(self, reaction: Reaction) -> Reaction:
        for packet in reaction.sent:
            if packet.link == CAN:
                assert frame_bits(packet.address & ~REMOTE, packet.payload) > 0
                assert packet.address & ~REMOTE <= 0x7FF
            else:
                assert (packet.link, packet.address) == (SERIAL, 0)
                assert packet.payload
                self._check_words(packet.payload)
        return reaction

    def _check_words(self, sent: bytes) -> None:
        """Check that the drive's bytes on USB are made of whole good frames."""
        if self.generation is Generation.V2:
            reader = FrameReader()
            found = [frame for byte in sent if (frame := reader.take(byte)) is not None]
            assert all(isinstance(frame, Frame) and frame.opcode == 0 for frame in found)
            assert b"".join(encode_v2(frame) for frame in found if isinstance(frame, Frame)) == sent


class StrangeUsbHost(StrangeHost):
    generation = Generation.V2


STEPS = settings(max_examples=examples(40), stateful_step_count=30, derandomize=True, database=None)
TestStrangeHost = StrangeHost.TestCase
TestStrangeHost.settings = STEPS
TestStrangeUsbHost = StrangeUsbHost.TestCase
TestStrangeUsbHost.settings = STEPS
