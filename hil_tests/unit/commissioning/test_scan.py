"""Answering nodes: emulated drives on a bus and behind a line, and a third party's; nothing is written."""

from collections.abc import Mapping

import pytest

from emulators.epos2.objects.catalogue import PROFILES
from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.client import Ask, JobClient, Script, need
from firmware_bridge.families.epos2.commissioning.job import SilentError, WriteJob
from firmware_bridge.families.epos2.commissioning.network_command import NetworkCommand
from firmware_bridge.families.epos2.commissioning.scan import (
    SERIAL_NUMBER,
    SOFTWARE,
    TIMEOUT,
    Scan,
    ScannedNode,
)
from firmware_bridge.families.epos2.commissioning.serial_access import SerialAccess
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.wire.hardware import type_of
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.unit.commissioning.rig import FAR, NEAR, Rig

FOREIGN_NODE = 5
OBJECTS = {
    od.DEVICE_TYPE: (0x0003_0191).to_bytes(4, "little"),
    od.VENDOR_ID: (0x1234).to_bytes(4, "little"),
    od.PRODUCT_CODE: (0x6420_0000).to_bytes(4, "little"),
    od.REVISION: (0x0001_0002).to_bytes(4, "little"),
    od.DEVICE_NAME: b"IO",
}
"""Inputs and outputs of another maker, which happens to have a product code that maxon has, too."""


class ForeignNode:
    """A node of another maker: it answers to what it has, and refuses all else."""

    def __init__(self, objects: Mapping[Address, bytes], *, refuses: bool = True) -> None:
        self._objects = objects
        self._refuses = refuses

    def receive(self, packet: Packet, _now: Nanoseconds) -> Reaction:
        request = sdo.decode_request(packet.payload)
        if packet.address != cia301.SDO_REQUEST + FOREIGN_NODE or not isinstance(request, sdo.UploadRequest):
            return Reaction()
        raw = self._objects.get(request.address)
        if raw is None and not self._refuses:
            return Reaction()
        answer = (
            sdo.encode_abort(request.address, sdo.AbortCode.NO_OBJECT)
            if raw is None
            else sdo.encode_upload_response(request.address, raw)
        )
        return Reaction((Packet(CAN, cia301.SDO_RESPONSE + FOREIGN_NODE, answer),))

    def wake(self, _now: Nanoseconds) -> Reaction:
        return Reaction()


def scanned(rig: Rig, scan: Scan, link: CanAccess | SerialAccess) -> dict[int, ScannedNode]:
    """Carry a scan out on whatever the link is on, in virtual time."""
    script: Script = scan.script()
    client = JobClient(link, script, scan.overhear)
    wire = {CAN: rig.bus} if isinstance(link, CanAccess) else {"serial": rig.line}
    rig.world.attach("client", client, wire)
    end = rig.world.now + 300 * SECOND
    while not client.finished and rig.world.now < end:
        rig.waits(MILLISECOND)
    rig.world.detach("client")
    if client.failure is not None:
        raise client.failure
    assert client.finished
    return {found.node: found for found in scan.found}


def on_the_bus(rig: Rig, nodes: range, listen: Nanoseconds = 0) -> tuple[Scan, dict[int, ScannedNode]]:
    link = CanAccess(NEAR)
    link.requests_once(TIMEOUT)
    scan = Scan(link, nodes, listen)
    return scan, scanned(rig, scan, link)


def test_a_bus_is_requested_from_1_to_127_and_only_read() -> None:
    rig = Rig()
    rig.world.attach("foreign", ForeignNode(OBJECTS), {CAN: rig.bus})
    requested: list[Packet] = []
    rig.bus.observe(lambda _at, sender, packet: requested.append(packet) if sender == "client" else None)
    before = rig.world.now
    scan, found = on_the_bus(rig, range(1, 128))
    assert (set(found), len(scan.silent)) == ({NEAR, FAR, FOREIGN_NODE}, 124)
    assert rig.world.now - before < 125 * TIMEOUT + SECOND // 4, "one time-out for each that is silent"
    reading = (sdo.UploadRequest, sdo.UploadSegmentRequest, sdo.Abort)
    assert len(requested) > 127
    for packet in requested:
        assert packet.address & ~cia301.NODE_MASK == cia301.SDO_REQUEST
        assert isinstance(sdo.decode_request(packet.payload), reading)
    for node in (NEAR, FAR):
        drive = found[node]
        assert (drive.maxon, drive.profile, drive.value(SOFTWARE)) == (True, 402, 0x2126)
        assert drive.value(SERIAL_NUMBER) == rig.value(node, SERIAL_NUMBER)
        assert (drive.state, drive.network) == (PowerState.SWITCH_ON_DISABLED, (NmtState.PRE_OPERATIONAL,))


def test_a_foreign_node_is_distinguished_from_a_drive_and_not_requested_what_only_a_drive_knows() -> None:
    rig = Rig()
    rig.world.attach("foreign", ForeignNode(OBJECTS), {CAN: rig.bus})
    _, found = on_the_bus(rig, range(FOREIGN_NODE, FOREIGN_NODE + 1))
    foreign_node = found[FOREIGN_NODE]
    assert (foreign_node.maxon, foreign_node.profile, foreign_node.state, foreign_node.network) == (
        False,
        401,
        None,
        (),
    )
    assert (foreign_node.value(od.DEVICE_NAME), foreign_node.value(od.VENDOR_ID)) == ("IO", 0x1234)
    assert foreign_node.value(od.SERIAL_NUMBER) is None, "it has refused that, and is there all the same"
    assert not {SOFTWARE, SERIAL_NUMBER, od.STATUSWORD} & set(foreign_node.outcomes)


def test_a_node_that_falls_silent_under_way_is_listed_with_what_it_has_stated() -> None:
    rig = Rig()
    foreign_node = ForeignNode({od.DEVICE_TYPE: OBJECTS[od.DEVICE_TYPE]}, refuses=False)
    rig.world.attach("foreign", foreign_node, {CAN: rig.bus})
    scan, found = on_the_bus(rig, range(1, 10))
    assert set(found[FOREIGN_NODE].outcomes) == {od.DEVICE_TYPE}
    assert set(found) == {NEAR, FAR, FOREIGN_NODE}
    assert FOREIGN_NODE not in scan.silent


def test_a_stopped_drive_is_received_though_it_does_not_answer() -> None:
    rig = Rig()
    rig.does(CanAccess(FAR), (Ask(WriteJob(od.PRODUCER_HEARTBEAT, b"\x64\0"), need(lambda _raw: ())),))
    rig.does(CanAccess(NEAR), NetworkCommand(NmtCommand.START, NEAR).script())
    rig.does(CanAccess(FAR), NetworkCommand(NmtCommand.STOP, FAR).script())
    scan, found = on_the_bus(rig, range(1, 4), listen=200 * MILLISECOND)
    assert (found[FAR].answers, found[FAR].network) == (False, (NmtState.STOPPED,))
    assert (found[NEAR].answers, found[NEAR].network) == (True, (NmtState.OPERATIONAL,))
    assert scan.silent == (3,)


@pytest.mark.parametrize("generation", Generation)
def test_a_line_brings_its_own_drive_and_those_behind_it(generation: Generation) -> None:
    rig = Rig(generation)
    link = SerialAccess(generation)
    scan = Scan(link, range(1, 5))
    found = scanned(rig, scan, link)
    assert (scan.own, scan.requested, set(found), scan.silent) == (NEAR, [1, 2, 3, 4], {NEAR, FAR}, (3, 4))
    for node in (NEAR, FAR):
        assert found[node].value(SERIAL_NUMBER) == rig.value(node, SERIAL_NUMBER)
    assert found[NEAR].network == (NmtState.PRE_OPERATIONAL, NmtState.STOPPED), "a line answers in both"
    assert found[FAR].network == (NmtState.PRE_OPERATIONAL,)


def test_a_line_on_which_no_one_answers_ends_the_scan() -> None:
    rig = Rig(Generation.V2)
    link = SerialAccess(Generation.V1)  # not what the drive speaks
    with pytest.raises(SilentError):
        scanned(rig, Scan(link, range(1, 128)), link)


def test_every_type_that_is_emulated_is_known_by_its_product_code() -> None:
    known = {name: profile for name, profile in PROFILES.items() if profile.hardware_version is not None}
    assert set(PROFILES) - set(known) == {"24/2"}
    for profile in known.values():
        assert type_of((profile.hardware_version or 0) << 16 | profile.application_number) == profile.name
    assert type_of(0) is None
