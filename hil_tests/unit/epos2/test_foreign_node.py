"""A third party on the bus sends anything in any order: no exception, and the answers of the standard.

The drive is whole, with its own motion control above an axis that never moves.
"""

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from emulators.epos2.drive import Epos2
from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen import sdo
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE
from hil_tests.lanes import examples

NODE = 5
PAYLOADS = st.binary(max_size=8)
OBJECT = st.sampled_from(list(EPOS2_70_10.objects)) | st.builds(
    Address, st.integers(0, 0xFFFF), st.integers(0, 0xFF)
)
OWN = st.sampled_from(
    [base + NODE for base in (0x80, 0x180, 0x200, 0x280, 0x300, 0x400, 0x500, 0x580, 0x600, 0x700)]
    + [0x000, 0x080, 0x100, 0x764, 0x7E5]
)
FLAGS = st.sampled_from([0, 0, 0, REMOTE, EXTENDED, ERROR])
VALUES = st.sampled_from([0, 1, 2, 6, 7, 0xF, 0x1F, 0x80, 0xFD, 0xFF, 0x8000_0205, 0x6041_0010, 0x6064_0020])
SPEAKING = frozenset({NmtState.PRE_OPERATIONAL, NmtState.OPERATIONAL})


class ForeignNode(RuleBasedStateMachine):
    """Each rule is something that a third party may do."""

    @initialize()
    def plug_in(self) -> None:
        self.drive = Epos2(NODE, ServoAxis("foreign", 2000))
        self.now: Nanoseconds = 0
        self.due = self._checked(self.drive.wake(0)).wake_at

    @rule(wait=st.integers(0, 300 * MILLISECOND))
    def wait(self, wait: Nanoseconds) -> None:
        until = self.now + wait
        for _ in range(1000):
            if self.due > until:
                break
            self.now = max(self.now, self.due)
            self.due = self._checked(self.drive.wake(self.now)).wake_at
        self.now = until

    @rule(address=OWN | st.integers(0, 0x7FF), flags=FLAGS, payload=PAYLOADS)
    def send_anything(self, address: int, flags: int, payload: bytes) -> None:
        self._send(address | flags, payload)

    @rule(command=st.sampled_from([0x01, 0x02, 0x80, 0x81, 0x82, 0x03]), node=st.sampled_from([0, NODE, 6]))
    def command(self, command: int, node: int) -> None:
        self._send(0x000, bytes((command, node)))

    @rule(payload=PAYLOADS)
    def ask_anything(self, payload: bytes) -> None:
        self._ask(payload)

    @rule(address=OBJECT)
    def read(self, address: Address) -> None:
        answers = self._ask(sdo.encode_upload(address))
        if answers:
            row = EPOS2_70_10.objects.get(address)
            message = sdo.decode_response(answers[0])
            if row is None or not row.access.readable:
                assert isinstance(message, sdo.Abort)
            else:
                assert isinstance(message, sdo.UploadResponse)
                assert row.type.size in (0, message.size)

    @rule(address=OBJECT, raw=st.binary(min_size=1, max_size=8))
    def write_bytes(self, address: Address, raw: bytes) -> None:
        self._write(address, raw)

    @rule(address=OBJECT, value=VALUES | st.integers(0, 0xFFFF_FFFF))
    def write_number(self, address: Address, value: int) -> None:
        row = EPOS2_70_10.objects.get(address)
        size = row.type.size if row else 4
        self._write(address, (value & (1 << 8 * size) - 1).to_bytes(size, "little"))

    def _write(self, address: Address, raw: bytes) -> None:
        answers = self._ask(sdo.encode_download(address, raw))
        row = EPOS2_70_10.objects.get(address)
        if answers and (row is None or not row.access.writable):
            assert isinstance(sdo.decode_response(answers[0]), sdo.Abort)

    @rule(toggle=st.booleans())
    def ask_for_a_segment(self, toggle: bool) -> None:  # noqa: FBT001 - Hypothesis gives it by name
        self._ask(sdo.encode_upload_segment(toggle=toggle))

    @rule(toggle=st.booleans(), last=st.booleans(), raw=st.binary(max_size=7))
    def send_a_segment(self, toggle: bool, last: bool, raw: bytes) -> None:  # noqa: FBT001 - as above
        self._ask(sdo.encode_download_segment(raw, toggle=toggle, last=last))

    def _ask(self, payload: bytes) -> list[bytes]:
        """Send a request: one answer of eight bytes while SDO lives, silence to an abort and else."""
        state = self.drive.nmt_state
        reaction = self._send(0x600 + NODE, payload)
        answers = [packet.payload for packet in reaction.sent if packet.address == 0x580 + NODE]
        wanted = state in SPEAKING and not isinstance(sdo.decode_request(payload), sdo.Abort)
        assert len(answers) == wanted
        return answers

    def _send(self, address: int, payload: bytes) -> Reaction:
        reaction = self._checked(self.drive.receive(Packet(CAN, address, payload), self.now))
        self.due = reaction.wake_at
        return reaction

    def _checked(self, reaction: Reaction) -> Reaction:
        for packet in reaction.sent:
            assert packet.link == CAN
            assert 0 < packet.address <= 0x7FF
            assert len(packet.payload) <= 8
            if packet.address == 0x580 + NODE:
                assert not isinstance(sdo.decode_response(packet.payload), sdo.Unknown)
        return reaction

    @invariant()
    def every_stored_number_fits_its_object(self) -> None:
        for row, value in self.drive.store.numbers():
            assert row.type.lowest <= value <= row.type.highest, row.address

    @invariant()
    def the_drive_is_reachable(self) -> None:
        assert self.drive.nmt_state in (*SPEAKING, NmtState.STOPPED)


TestForeign = ForeignNode.TestCase
TestForeign.settings = settings(
    max_examples=examples(60), stateful_step_count=40, derandomize=True, database=None
)
