"""A copy of the parameters that can no longer be read: an internal software error, and the defaults."""

from collections.abc import Mapping

import pytest

from emulators.canopen.saved_parameters import StorageError
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from hil_tests.unit.epos2.quiet_motion import Desk

SAVE = "601#2310100173617665"


class Worn:
    """A flash memory that can wear out."""

    def __init__(self) -> None:
        self.worn = False
        self.values: Mapping[Address, int] = {}

    def read(self) -> Mapping[Address, int]:
        if self.worn:
            raise StorageError("worn out")
        return self.values

    def write(self, values: Mapping[Address, int]) -> None:
        self.values = dict(values)


@pytest.mark.emergency(0x6100)
def test_parameters_that_are_lost_at_a_restart_are_an_internal_software_error() -> None:
    storage = Worn()
    desk = Desk(storage=storage)
    desk.powers()
    desk.receives("601#23816000D2040000")  # 0x6081 = 1234
    desk.receives(SAVE)
    assert desk.receives("000#8101") == ["701#00"]
    assert desk.store.get(od.PROFILE_VELOCITY) == 1234
    storage.worn = True
    assert desk.receives("000#8101") == ["701#00", "081#0061200000000000"]
    assert desk.store.get(od.PROFILE_VELOCITY) == 1000
    assert desk.store.get(od.ERROR_REGISTER) == 0x20
    storage.worn = False
    desk.receives(SAVE)
    assert desk.receives("000#8101") == ["701#00"]
