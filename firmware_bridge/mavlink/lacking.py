"""Protocols that the bridge does not have, refused at once by their own means: a row for each message.

Silence would cost a station its time-outs and tries. Sources: mavlink.io, "File Transfer Protocol", "Mission
Protocol"; common.xml, LOG_ENTRY, LOG_DATA; ardupilotmega.xml, FENCE_POINT, RALLY_POINT.
"""

from collections.abc import Callable
from functools import partial
from typing import Final, TypeAlias

from firmware_bridge.mavlink.frames import Message, dialect

Address: TypeAlias = tuple[int, int]
Refusal: TypeAlias = Callable[[Message, Address], Message | None]
"""Return the answer for an address; None for a message that has none."""

ACK, NAK = 128, 129
FAIL, INVALID_SESSION, UNKNOWN_COMMAND, FILE_NOT_FOUND = 1, 4, 7, 10
"""Of the file transfer protocol, MAV_FTP_OPCODE and MAV_FTP_ERR."""
_FTP: Final = {
    **dict.fromkeys((0, 1, 2), None),
    **dict.fromkeys((3, 4, 8, 10, 12, 13, 14), FILE_NOT_FOUND),
    **dict.fromkeys((5, 7, 15), INVALID_SESSION),
    **dict.fromkeys((6, 9, 11), FAIL),
}
"""The reason, by opcode.

Nothing, and the end and reset of sessions are granted: there is none. There is no file to list, open, remove,
truncate or check, and no session to read, write or burst; nothing can be made here.
"""
_SESSION, _OPCODE, _SIZE, _REQUESTED, _ERROR = 2, 3, 4, 5, 12
_FTP_PAYLOAD: Final = 251


def _file_transfer(message: Message, address: Address) -> Message | None:
    requested = bytes(message.payload)
    opcode = requested[_OPCODE]
    if opcode in (ACK, NAK):
        return None
    error = _FTP.get(opcode, UNKNOWN_COMMAND)
    answer = bytearray(_FTP_PAYLOAD)
    # An answer has the request's sequence number plus 1 (MAVLink FTP).
    answer[:_SESSION] = ((int.from_bytes(requested[:_SESSION], "little") + 1) & 0xFFFF).to_bytes(2, "little")
    answer[_SESSION] = requested[_SESSION]
    answer[_OPCODE] = ACK if error is None else NAK
    answer[_REQUESTED] = opcode
    if error is not None:
        # A NAK carries one byte: the error code.
        answer[_SIZE], answer[_ERROR] = 1, error
    return dialect.MAVLink_file_transfer_protocol_message(0, *address, bytes(answer))


def _no_logs(_message: Message, _address: Address) -> Message:
    return dialect.MAVLink_log_entry_message(0, 0, 0, 0, 0)


def _no_log_data(message: Message, _address: Address) -> Message:
    return dialect.MAVLink_log_data_message(message.id, message.ofs, 0, bytes(90))


def _no_items(message: Message, address: Address) -> Message:
    return dialect.MAVLink_mission_count_message(*address, 0, message.mission_type)


def _mission(kind: int, message: Message, address: Address) -> Message:
    return dialect.MAVLink_mission_ack_message(*address, kind, message.mission_type)


def _no_current(_message: Message, address: Address) -> Message:
    return dialect.MAVLink_mission_ack_message(*address, dialect.MAV_MISSION_UNSUPPORTED, 0)


def _no_fence(message: Message, address: Address) -> Message:
    return dialect.MAVLink_fence_point_message(*address, message.idx, 0, 0.0, 0.0)


def _no_rally(message: Message, address: Address) -> Message:
    return dialect.MAVLink_rally_point_message(*address, message.idx, 0, 0, 0, 0, 0, 0, 0)


_unsupported: Final = partial(_mission, dialect.MAV_MISSION_UNSUPPORTED)
_no_such_item: Final = partial(_mission, dialect.MAV_MISSION_INVALID_SEQUENCE)

LACKING: Final[dict[int, Refusal]] = {
    dialect.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL: _file_transfer,
    dialect.MAVLINK_MSG_ID_LOG_REQUEST_LIST: _no_logs,
    dialect.MAVLINK_MSG_ID_LOG_REQUEST_DATA: _no_log_data,
    dialect.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: _no_items,
    dialect.MAVLINK_MSG_ID_MISSION_COUNT: _unsupported,
    dialect.MAVLINK_MSG_ID_MISSION_WRITE_PARTIAL_LIST: _unsupported,
    dialect.MAVLINK_MSG_ID_MISSION_REQUEST_PARTIAL_LIST: _unsupported,
    dialect.MAVLINK_MSG_ID_MISSION_SET_CURRENT: _no_current,
    dialect.MAVLINK_MSG_ID_MISSION_REQUEST: _no_such_item,
    dialect.MAVLINK_MSG_ID_MISSION_REQUEST_INT: _no_such_item,
    dialect.MAVLINK_MSG_ID_MISSION_ITEM: _no_such_item,
    dialect.MAVLINK_MSG_ID_MISSION_ITEM_INT: _no_such_item,
    dialect.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: partial(_mission, dialect.MAV_MISSION_ACCEPTED),
    dialect.MAVLINK_MSG_ID_FENCE_FETCH_POINT: _no_fence,
    dialect.MAVLINK_MSG_ID_RALLY_FETCH_POINT: _no_rally,
}
