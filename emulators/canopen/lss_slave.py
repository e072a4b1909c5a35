"""Layer setting services of a device: node number and bit rate over the bus.

Source: CiA 305, all of it only while the network state is Stopped. Where it is silent: a frame that is not
eight bytes long is no request; a node number is accepted even where the hardware gives one, and counts where
it gives none, with the next reset of node or communication; without 'store' it is forgotten at the next reset
of the node. The device always has a number, so the request for slaves without one is never answered.
"""

from collections.abc import Callable
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.product import LayerSetting
from emulators.canopen.saved_parameters import SavedParameters
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import SdoAbort
from firmware_bridge.canopen.cia301 import FIRST_NODE, LAST_NODE
from firmware_bridge.canopen.lss import CONFIGURATION, LENGTH, LssCommand, LssError, encode_lss
from firmware_bridge.units import MILLISECOND, Nanoseconds

IDENTITY: Final = (od.VENDOR_ID, od.PRODUCT_CODE, od.REVISION, od.SERIAL_NUMBER)
_SELECT: Final = (
    LssCommand.SELECT_VENDOR,
    LssCommand.SELECT_PRODUCT,
    LssCommand.SELECT_REVISION,
    LssCommand.SELECT_SERIAL,
)
_INQUIRE: Final = {
    LssCommand.INQUIRE_VENDOR: od.VENDOR_ID,
    LssCommand.INQUIRE_PRODUCT: od.PRODUCT_CODE,
    LssCommand.INQUIRE_REVISION: od.REVISION,
    LssCommand.INQUIRE_SERIAL: od.SERIAL_NUMBER,
}
_STANDARD_TABLE: Final = 0
_Answer = bytes | None


class LssSlave:
    """One slave. `pending_node` is a number that was set and does not count yet."""

    def __init__(
        self,
        store: ObjectStore,
        memory: SavedParameters,
        objects: LayerSetting,
        node: Callable[[], int],
        switch: Callable[[int, Nanoseconds], None],
    ) -> None:
        """Keep the services' context: `node` returns the number in use, `switch` changes the bit rate.

        `switch` takes a bit rate's code, after and for a delay.
        """
        self._store = store
        self._memory = memory
        self._objects = objects
        self._node = node
        self._switch = switch
        self._configuring = False
        self._selected = 0
        self._identified = 0
        self.pending_node: int | None = None
        self._configuration: dict[LssCommand, Callable[[bytes], _Answer]] = {
            LssCommand.SET_NODE: self._set_node,
            LssCommand.SET_BIT_TIMING: self._set_bit_timing,
            LssCommand.ACTIVATE_BIT_TIMING: self._activate,
            LssCommand.STORE: self._keep,
            LssCommand.INQUIRE_NODE: lambda _: encode_lss(LssCommand.INQUIRE_NODE, self._node(), 1),
        }

    def rest(self) -> None:
        """Leave the configuration state, as at each boot."""
        self._configuring = False
        self._selected = self._identified = 0

    def answer(self, payload: bytes) -> bytes | None:
        """Return the answer to a master's frame; None where none is due."""
        if len(payload) != LENGTH:
            return None
        try:
            command = LssCommand(payload[0])
        except ValueError:
            return None
        if command is LssCommand.SWITCH_GLOBAL:
            # Not answered (CiA 305): it is for all slaves at once.
            self._configuring = payload[1] == CONFIGURATION
            return None
        value = int.from_bytes(payload[1:5], "little")
        if command in _SELECT:
            return self._select(_SELECT.index(command), value)
        if LssCommand.IDENTIFY_VENDOR <= command <= LssCommand.IDENTIFY_SERIAL_HIGH:
            return self._identify(command - LssCommand.IDENTIFY_VENDOR, value)
        return self._configure(command, payload) if self._configuring else None

    def _configure(self, command: LssCommand, payload: bytes) -> bytes | None:
        inquired = _INQUIRE.get(command)
        if inquired is not None:
            return encode_lss(command, self._store.get(inquired))
        service = self._configuration.get(command)
        return None if service is None else service(payload)

    def _select(self, place: int, value: int) -> bytes | None:
        """Follow the four questions, which must come in their order and all fit."""
        fits = value == self._store.get(IDENTITY[place])
        # A frame out of order spoils the sequence; the vendor, place 0, always begins a new one.
        self._selected = place + 1 if fits and place in (0, self._selected) else 0
        if self._selected < len(IDENTITY):
            return None
        self._selected = 0
        self._configuring = True
        return encode_lss(LssCommand.SELECTED)

    def _identify(self, place: int, value: int) -> bytes | None:
        revision, serial = self._store.get(od.REVISION), self._store.get(od.SERIAL_NUMBER)
        # CiA 305: vendor, product, then lower and upper bound of revision and of serial number.
        fits = (
            value == self._store.get(od.VENDOR_ID),
            value == self._store.get(od.PRODUCT_CODE),
            value <= revision,
            revision <= value,
            value <= serial,
            serial <= value,
        )
        self._identified = place + 1 if fits[place] and place in (0, self._identified) else 0
        if self._identified < len(fits):
            return None
        self._identified = 0
        return encode_lss(LssCommand.IDENTIFIED)

    def _set_node(self, payload: bytes) -> bytes:
        node = payload[1]
        if not FIRST_NODE <= node <= LAST_NODE:
            return encode_lss(LssCommand.SET_NODE, LssError.REFUSED)
        self.pending_node = node
        self._store.set(self._objects.node_number, node)
        return encode_lss(LssCommand.SET_NODE, LssError.NONE)

    def _set_bit_timing(self, payload: bytes) -> bytes:
        table, code = payload[1], payload[2]
        if table != _STANDARD_TABLE or code not in self._objects.bit_rates:
            return encode_lss(LssCommand.SET_BIT_TIMING, LssError.REFUSED)
        self._store.set(self._objects.bit_rate, code)
        return encode_lss(LssCommand.SET_BIT_TIMING, LssError.NONE)

    def _activate(self, payload: bytes) -> None:
        # Not answered (CiA 305): the rate at which an answer would be received is about to end.
        code = self._store.get(self._objects.bit_rate)
        self._switch(code, int.from_bytes(payload[1:3], "little") * MILLISECOND)

    def _keep(self, _payload: bytes) -> bytes:
        kept = (self._objects.node_number, self._objects.bit_rate)
        changes = {address: self._store.get(address) for address in kept}
        try:
            self._memory.save(changes)
        except SdoAbort:
            return encode_lss(LssCommand.STORE, LssError.STORE_FAILED)
        return encode_lss(LssCommand.STORE, LssError.NONE)
