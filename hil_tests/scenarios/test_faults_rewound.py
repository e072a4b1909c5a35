"""Runs with faults: one seed is one run, and time goes back across every fault."""

from collections.abc import Iterator, Sequence
from typing import Final

import pytest

from emulators.bench.faults import Fault, FaultError
from emulators.bench.mission import Noise
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds
from hil_tests.scenarios.ride import ARMED, Ride, fault, ride, step
from hil_tests.unit.rewind.digest import digest

FAULTS: Final[Sequence[Fault]] = (
    fault("frame_error", 4.0, share=0.05, for_s=3.0),
    fault("frame_loss", 4.2, node="lift", share=0.3, for_s=2.0),
    fault("datagram_loss", 4.1, share=0.3, for_s=2.0),
    fault("datagram_doubled", 4.5, share=0.5, after_ms=30, for_s=2.0),
    fault("babbling_node", 4.6, every_us=400, for_s=0.3),
    fault("encoder_counts_lost", 4.8, node="steer", share=0.01, for_s=1.0),
    fault("supply_sag", 5.0, to_v=15.0, for_s=0.5),
    fault("drive_restart", 5.6, node="left", for_s=0.3),
    fault("can_cut", 6.0, between=["steer", "lift"], for_s=0.3),
    fault("can_swapped", 6.4, node="right", for_s=0.1),
    fault("bus_off", 6.6, node="bridge", for_s=0.1),
    fault("nmt_stranger", 6.8, command="reset_node"),
    fault("node_silent", 6.9, node="steer", for_s=0.05),
)
GRID: Final[Nanoseconds] = 50 * MILLISECOND
LOOK: Final = 8
"""Every so many of these instants the whole state is compared, too."""
BEGIN, END = from_seconds(3.9), from_seconds(7.2)


def begun(seed: int = 3) -> Ride:
    noise = Noise(stick=0.02, delay_ms=3, jitter_ms=25, loss=0.03)
    steps = (ARMED, step(4.0, speed_mps=0.3), step(4.6, steer_deg=15), step(6.2, speed_mps=0.0))
    return ride(*steps, seconds=20, noise=noise, seed=seed, faults=FAULTS)


@pytest.fixture(scope="module")
def one() -> Iterator[Ride]:
    run = begun()
    yield run
    run.rig.finish()


@pytest.mark.long(beside="test_from_any_instant_the_run_goes_on_as_it_went")
def test_from_any_instant_among_the_faults_the_run_goes_on_as_it_went(one: Ride) -> None:
    moments, traces, digests = {}, {}, {}
    for at in range(BEGIN, END + 1, GRID):
        one.rig.run(at)
        moments[at] = one.rig.snapshot()
        traces[at] = one.rig.world.trace_sha256
        if len(moments) % LOOK == 0:
            digests[at] = digest(one.rig)
    records = list(one.rig.faults.records)
    assert len(records) == len(FAULTS)
    assert all(record.ended is not None for record in records)
    instants = list(moments)
    for at in instants[::-2] + instants[1::7]:
        one.rig.restore(moments[at])
        if at in digests:
            assert digest(one.rig) == digests[at], f"at {at} ns"
        for check in (at + 3 * GRID, at + 8 * GRID):
            if check <= END:
                one.rig.run(check)
                assert one.rig.world.trace_sha256 == traces[check], f"from {at} to {check} ns"
    one.rig.restore(moments[instants[-1]])
    assert one.rig.faults.records == records


def test_one_seed_is_one_run_and_another_one_draws_other_frames(one: Ride) -> None:
    same, other = begun(), begun(seed=4)
    one.rig.run(END)
    for run in (same, other):
        run.rig.run(END)
        run.rig.finish()
    assert one.rig.world.now == END
    assert same.rig.world.trace_sha256 == one.rig.world.trace_sha256
    assert other.rig.can_wire.damaged != one.rig.can_wire.damaged


def test_faults_can_be_put_on_a_rig_that_runs_and_are_gone_when_time_goes_back(one: Ride) -> None:
    rig = one.rig
    rig.run(max(rig.world.now, END))
    moment, before = rig.snapshot(), digest(rig)
    at_s = rig.world.now / 1e9
    planned = len(rig.faults.records)
    rig.faults.plan([fault("drive_restart", at_s + 0.1, node="lift", for_s=0.1)])
    rig.runs(0.15)
    assert len(rig.faults.records) == planned + 1
    rig.restore(moment)
    assert digest(rig) == before
    rig.runs(0.15)
    assert len(rig.faults.records) == planned
    with pytest.raises(FaultError, match=r"fault\[1\]\.at_s: 1 s is over"):
        rig.faults.plan([fault("frame_loss", at_s + 1.0), fault("frame_loss", 1.0)])
    with pytest.raises(FaultError, match=r"fault\[0\]\.node: rars has no node 'ster'"):
        rig.faults.plan([fault("frame_loss", at_s + 1.0, node="ster")])
    rig.runs(0.2)
    assert len(rig.faults.records) == planned, "refused, none of them happens"
