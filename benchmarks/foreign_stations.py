# ruff: noqa: PLC0415 - a library that may be missing is imported where it is used
"""The same device by the libraries `canopen` and `durand`: their servers alone, and on a virtual bus.

Each has the requested objects, as the drive has them, and no others.
"""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any, Final, TypeAlias

import can

NODE: Final = 1
INDEXES: Final = (0x607F, 0x6081, 0x6083, 0x6084)
"""Unsigned numbers of 32 bits that may be read and written."""
VALUE: Final = 1000
REQUEST: Final = 0x600 + NODE
ANSWER: Final = 0x580 + NODE
CHANNEL: Final = "benchmark"
PATIENCE_S: Final = 1.0

NodeOn: TypeAlias = Callable[[can.BusABC], AbstractContextManager[None]]


class _Taken:
    """Receiver of a server's frames, in place of a bus."""

    def __init__(self) -> None:
        self.received: dict[int, Callable[..., None]] = {}
        self.answer: bytes | None = None

    # durand
    def add_subscription(self, cob_id: int, callback: Callable[..., None]) -> None:
        self.received[cob_id] = callback

    def remove_subscription(self, cob_id: int) -> None:
        del self.received[cob_id]

    def send(self, _cob_id: int, payload: bytes) -> None:
        self.answer = payload

    # canopen
    def send_message(self, _can_id: int, payload: bytes, *_: Any) -> None:
        self.answer = payload


def _canopen_node() -> Any:
    from canopen import LocalNode
    from canopen.objectdictionary import UNSIGNED32, ObjectDictionary, ODVariable

    dictionary = ObjectDictionary()
    for index in INDEXES:
        variable = ODVariable(f"0x{index:04X}", index)
        variable.data_type, variable.access_type, variable.default = UNSIGNED32, "rw", VALUE
        dictionary.add_object(variable)
    return LocalNode(NODE, dictionary)


def _canopen_server() -> Callable[[bytes], bytes | None]:
    node, taken = _canopen_node(), _Taken()
    node.sdo.network = taken

    def served(request: bytes) -> bytes | None:
        node.sdo.on_request(REQUEST, request, 0.0)
        return taken.answer

    return served


def _canopen_whole() -> Callable[[bytes], bytes | None]:
    from canopen import Network

    network, taken = Network(), _Taken()
    network.send_message = taken.send_message
    network[NODE] = _canopen_node()

    def served(request: bytes) -> bytes | None:
        network.notify(REQUEST, request, 0.0)
        return taken.answer

    return served


def _durand_node(network: Any) -> Any:
    from durand import MinimalNode, Variable
    from durand.datatypes import DatatypeEnum

    node = MinimalNode(network, NODE)
    for index in INDEXES:
        node.object_dictionary[index] = Variable(DatatypeEnum.UNSIGNED32, "rw", VALUE)
    return node


def _durand_server() -> Callable[[bytes], bytes | None]:
    taken = _Taken()
    _durand_node(taken)
    received = taken.received[REQUEST]

    def served(request: bytes) -> bytes | None:
        received(REQUEST, request)
        return taken.answer

    return served


@contextmanager
def _canopen_on(bus: can.BusABC) -> Iterator[None]:
    from canopen import Network

    network = Network(bus)
    network.connect()
    network[NODE] = _canopen_node()
    yield
    network.disconnect()


@contextmanager
def _durand_on(bus: can.BusABC) -> Iterator[None]:
    from durand import CANBusNetwork

    network = CANBusNetwork(bus)
    _durand_node(network)
    yield
    network.stop()
    bus.shutdown()


SERVERS: Final = {"canopen": _canopen_server, "durand": _durand_server}
"""Factories of a server alone, by the library's name."""
WHOLE: Final = {"canopen": _canopen_whole, "durand": _durand_server}
"""Factories of a node that is handed frames, by the library's name; durand's bus hands them to the server."""
NODES: Final = {"canopen": _canopen_on, "durand": _durand_on}
"""Factories of a node on a bus, by the library's name."""


def _bus() -> can.BusABC:
    return can.Bus(interface="virtual", channel=CHANNEL)


def round_trips(node_on: NodeOn, request: bytes, count: int) -> Callable[[], None]:
    """Return a run of so many requests by a client on the bus; it raises TimeoutError without an answer."""
    message = can.Message(arbitration_id=REQUEST, data=request, is_extended_id=False)

    def run() -> None:
        with _bus() as client, node_on(_bus()):
            for _ in range(count):
                client.send(message)
                answer = client.recv(PATIENCE_S)
                while answer is not None and answer.arbitration_id != ANSWER:
                    answer = client.recv(PATIENCE_S)
                if answer is None:
                    raise TimeoutError("the third-party client does not answer")

    return run


def frames(count: int) -> None:
    """Carry so many frames from one end of the virtual bus to the other."""
    message = can.Message(arbitration_id=ANSWER, data=bytes(8), is_extended_id=False)
    with _bus() as sender, _bus() as receiver:
        for _ in range(count):
            sender.send(message)
            receiver.recv(PATIENCE_S)
