"""Caches that the memory benchmark empties before each look: those that have a bound, and no other."""

from benchmarks.memory import bounded_caches
from emulators.servo import kernel, scaling
from firmware_bridge.canopen import sdo
from firmware_bridge.wire import can


def test_caches_with_a_bound_are_emptied_and_one_without_counts() -> None:
    caches = list(bounded_caches())
    assert can.frame_bits in caches
    assert sdo.decode_request in caches
    assert all(cache.cache_info().maxsize for cache in caches)
    assert kernel.find not in caches
    assert any(cache.__module__ == scaling.__name__ for cache in caches)
