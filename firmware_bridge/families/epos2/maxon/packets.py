"""Commands of the serial protocols as packets, as CAN frames are: the opcode is the address.

The carrier to a line adds check sum, stuffing and handshake, as a CAN controller does for a frame. A received
packet has the opcode of the command that it belongs to, and a flag where there is no answer.
"""

from typing import Final

from firmware_bridge.families.epos2.maxon.frame import Failure, Frame, MaxonAnswer, Outcome
from firmware_bridge.families.epos2.maxon.messages import Request
from firmware_bridge.families.epos2.maxon.opcodes import COMMANDS, decode_request, encode_request
from firmware_bridge.packet import Packet

FAILED: Final = 0x100
"""Flag in a received packet's address: no answer; the payload is the reason as text."""
_OPCODE: Final = 0xFF
_FAILURES: Final = {failure.value.encode(): failure for failure in Failure}


MAXON: Final = "maxon"
"""Link of the bridge before its end of a line: whole commands."""


def command(request: Request, link: str = MAXON) -> Packet:
    """Return a request as a packet on a link."""
    frame = encode_request(request)
    return Packet(link, frame.opcode, frame.body)


def request_of(packet: Packet) -> Request | None:
    """Return the request in a packet; None for an unknown command, or one of another length."""
    row = COMMANDS.get(packet.address)
    if row is None or row.request is None or len(packet.payload) % 2:
        return None
    request = decode_request(Frame(packet.address, packet.payload))
    # Encoded again and compared, so that one command has one form: surplus bytes are none.
    return request if request is not None and encode_request(request).body == packet.payload else None


def outcome_packet(opcode: int, outcome: Outcome, link: str = MAXON) -> Packet:
    """Return how a command ended as a packet on a link."""
    if isinstance(outcome, MaxonAnswer):
        return Packet(link, opcode, outcome.body)
    return Packet(link, opcode | FAILED, outcome.value.encode())


def outcome_of(packet: Packet) -> tuple[int, Outcome]:
    """Return the opcode of the command that has ended, and how."""
    if packet.address & FAILED:
        return packet.address & _OPCODE, _FAILURES.get(packet.payload, Failure.SILENCE)
    return packet.address & _OPCODE, MaxonAnswer(packet.payload)
