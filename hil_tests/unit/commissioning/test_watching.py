"""Reading again and again: reported at first, at each change, and never else; a refusal is a value, too."""

from itertools import pairwise

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.client import JobClient
from firmware_bridge.families.epos2.commissioning.job import RefusedError, SilentError
from firmware_bridge.families.epos2.commissioning.reading import Reading
from firmware_bridge.node import CAN
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.commissioning.rig import NEAR, Rig

PERIOD = 100 * MILLISECOND


def test_each_change_is_reported_once_and_within_a_period() -> None:
    rig, reported = Rig(), []
    reading = Reading([od.PROFILE_VELOCITY, Address(0x5555)])
    script = reading.again_and_again(PERIOD, lambda: reported.append(reading.value(od.PROFILE_VELOCITY)))
    client = JobClient(CanAccess(NEAR), script)
    rig.world.attach("client", client, {CAN: rig.bus})
    rig.waits(SECOND)
    for value in (7, 8, 8, 1000):
        rig.drives[NEAR].store.set(od.PROFILE_VELOCITY, value)
        rig.waits(PERIOD + 5 * MILLISECOND)
    assert reported == [1000, 7, 8, 1000]
    assert isinstance(reading.found[Address(0x5555)], RefusedError)
    assert not client.finished


def test_it_requests_no_more_often_than_it_is_reported_to() -> None:
    rig, requested = Rig(), []
    rig.bus.observe(lambda now, sender, _packet: requested.append(now) if sender == "client" else None)
    client = JobClient(CanAccess(NEAR), Reading([od.PROFILE_VELOCITY]).again_and_again(PERIOD, lambda: None))
    rig.world.attach("client", client, {CAN: rig.bus})
    rig.waits(SECOND + 50 * MILLISECOND)
    assert 10 <= len(requested) <= 11
    assert all(later - earlier >= PERIOD for earlier, later in pairwise(requested))


def test_a_drive_that_falls_silent_ends_it() -> None:
    rig = Rig()
    client = JobClient(CanAccess(9), Reading([od.PROFILE_VELOCITY]).again_and_again(PERIOD, lambda: None))
    rig.world.attach("client", client, {CAN: rig.bus})
    rig.waits(SECOND)
    assert client.finished
    assert isinstance(client.failure, SilentError)


def test_the_mode_is_read_for_words_that_need_it_and_only_then() -> None:
    for addresses, mode in (((od.STATUSWORD,), True), ((od.PROFILE_VELOCITY,), False)):
        rig, reading = Rig(), Reading(addresses)
        rig.does(CanAccess(NEAR), reading.once())
        assert (od.MODE_DISPLAY in reading.found) is mode
        assert reading.addresses == addresses
