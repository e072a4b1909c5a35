"""One emulated EPOS2 on a CAN bus: a CANopen slave with maxon's choices, and motion control behind it.

Not known here: the node's services (`emulators.canopen`), and how a motor moves (the package `control`).
"""

from functools import partial
from typing import Final

from emulators.canopen.identity import FIRST_NUMBER
from emulators.canopen.object_store import ObjectStore
from emulators.canopen.saved_parameters import Storage, Volatile
from emulators.canopen.slave import CanopenSlave
from emulators.epos2.canopen.high_resolution_clock import HighResolutionClock
from emulators.epos2.canopen.motion_protocol import MotionFactory
from emulators.epos2.canopen.product import product_of
from emulators.epos2.control import value_ranges
from emulators.epos2.control.motion_control import MotionControl
from emulators.epos2.objects.device_profile import EPOS2_70_10, DeviceProfile
from emulators.epos2.objects.parameters import restore_cob_ids
from emulators.servo.axis import STAGE_RISE_MC, ServoAxis
from firmware_bridge.canopen.cia301 import LAST_NODE
from firmware_bridge.units import Nanoseconds


def _counting(motion: MotionFactory, profile: DeviceProfile) -> MotionFactory:
    """Return the factory of motion control, with the profile's rule for set-points by write."""
    if motion is not MotionControl:
        return motion
    return partial(MotionControl, each_write_counts=profile.written_word_is_setpoint)


class Epos2(CanopenSlave):
    """One drive. `node_id` is the setting of its DIP switch; with 0 the saved number counts."""

    def __init__(
        self,
        node_id: int,
        axis: ServoAxis,
        profile: DeviceProfile = EPOS2_70_10,
        motion: MotionFactory = MotionControl,
        *,
        storage: Storage | None = None,
        bus_rate: int | None = None,
    ) -> None:
        """`storage` keeps saved parameters; at another bit rate than `bus_rate` the drive is off the bus."""
        if not 0 <= node_id <= LAST_NODE:
            raise ValueError(f"a DIP switch gives a number between 0 and {LAST_NODE}, not {node_id}")
        self.profile: Final = profile
        product = product_of(profile)
        store = ObjectStore(
            profile.objects, node_id or FIRST_NUMBER, profile.differing(node_id), profile.bounds()
        )
        # Ranges first: hooks run in the order of registration, and none may act on a value out of range.
        value_ranges.keep(store)
        restore_cob_ids(store, product)
        axis.over_current_ma, axis.over_voltage_mv = profile.over_current_ma, profile.over_voltage_mv
        # In mA^2 per 1/1000 K: the continuous current heats the stage by STAGE_RISE_MC.
        axis.square_per_mc = profile.continuous_current_ma**2 // STAGE_RISE_MC
        self._clock: Final = HighResolutionClock(store)
        self.motion: Final = _counting(motion, profile)(store, axis, self.report)
        super().__init__(
            node_id, store, product, self.motion, storage=storage or Volatile(), bus_rate=bus_rate
        )

    def synchronize(self, now: Nanoseconds) -> None:
        """Let the high-resolution clock take the time of a SYNC."""
        self._clock.latch(now)
