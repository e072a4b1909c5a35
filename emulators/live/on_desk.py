"""Requests of the live page that the control desk carries out."""

import json
from typing import Any, Final

from emulators.control.desk import CONTROL
from firmware_bridge.live.messages import encoded
from firmware_bridge.live.state import Json
from firmware_bridge.node import Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import Nanoseconds

OF_DESK: Final = ("inject", "clear", "set", "restart", "shutdown")


def desk_does(desk: Node, request: Json, now: Nanoseconds) -> tuple[Reaction, Json]:
    """Let the desk carry out a request; return what leaves, and its answer."""
    reaction = desk.receive(Packet(CONTROL, 0, encoded(request)), now)
    answers: list[dict[str, Any]] = [json.loads(one.payload) for one in reaction.sent if one.link == CONTROL]
    others = tuple(one for one in reaction.sent if one.link != CONTROL)
    return Reaction(others, reaction.wake_at), answers[0]
