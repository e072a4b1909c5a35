"""Network management of one device: where a command leads, and which services live in which state.

Source: CiA 301 v4.02, NMT state machine, table of states and services.
"""

from collections.abc import Mapping
from enum import Enum
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.cia301 import ALL_NODES, NmtCommand, NmtState, decode_nmt


class NodeService(Enum):
    """Services that a node has in some states only; network commands are taken in all of them."""

    SDO = "service data"
    PDO = "process data"
    SYNC = "synchronisation"
    TIME = "time of day"
    EMERGENCY = "emergency"
    ERROR_CONTROL = "heartbeat and node guarding"
    LAYER_SETTING = "layer setting"


SERVICES: Final[Mapping[NmtState, frozenset[NodeService]]] = MappingProxyType(
    {
        NmtState.BOOT_UP: frozenset(),
        NmtState.PRE_OPERATIONAL: frozenset(NodeService) - {NodeService.PDO, NodeService.LAYER_SETTING},
        NmtState.OPERATIONAL: frozenset(NodeService) - {NodeService.LAYER_SETTING},
        NmtState.STOPPED: frozenset({NodeService.ERROR_CONTROL, NodeService.LAYER_SETTING}),
    }
)

TARGETS: Final[Mapping[NmtCommand, NmtState]] = MappingProxyType(
    {
        NmtCommand.START: NmtState.OPERATIONAL,
        NmtCommand.STOP: NmtState.STOPPED,
        NmtCommand.ENTER_PRE_OPERATIONAL: NmtState.PRE_OPERATIONAL,
    }
)
"""Commands that lead to a state at once; the two resets boot instead."""


def command_for(node_id: int, payload: bytes) -> NmtCommand | None:
    """Return the command in a frame if it is for this node or for all; surplus bytes do not count."""
    decoded = decode_nmt(payload)
    # Node-ID 0 addresses all nodes (CiA 301).
    if decoded is None or decoded[1] not in (ALL_NODES, node_id):
        return None
    return decoded[0]
