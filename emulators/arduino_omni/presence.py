"""Requests to the firmwares of boards that change nothing, each with the begin of its answer."""

from collections.abc import Mapping
from typing import Final

from firmware_bridge.families.motor_shield.wire import arduinoio, firmata, mw, mw_messages, ros_arduino_bridge

QUESTIONS: Final[Mapping[str, tuple[bytes, bytes]]] = {
    "mw": (mw.encode_request(mw_messages.GetServerInfo(), 0), bytes((mw.BOARD_START, mw.ANSWER))),
    "ros-arduino-bridge": (b"b" + ros_arduino_bridge.END, str(ros_arduino_bridge.BAUD).encode()),
    "arduinoio": (arduinoio.encode("9", 9), str(arduinoio.MOTOR_V2).encode()),
    "firmata": (bytes((firmata.VERSION,)), bytes((firmata.VERSION,))),
}
