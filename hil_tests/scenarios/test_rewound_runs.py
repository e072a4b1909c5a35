"""Time that is rewound: from any instant a run goes on as it went, to the byte."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import pytest

from emulators.bench.faults import Fault, FaultError
from emulators.bench.mission import Noise
from emulators.rewind import Checkpoint, RewindError
from emulators.rig import BRIDGE
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds, from_seconds
from hil_tests.lanes import examples
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, ride, step, story
from hil_tests.unit.rewind.digest import digest

SEED: Final = 20
SECONDS: Final = 20.0
EVERY: Final = 1000
INSTANTS: Final = examples(EVERY)
GRID: Final[Nanoseconds] = 200 * MILLISECOND
"""Instants at which the straight run is compared with the others."""
AHEAD: Final[Nanoseconds] = 60 * MILLISECOND
"""Each continued run goes on for so long at least: more than a cycle of the bus."""

FAULTS: Final[Sequence[Fault]] = (
    fault("frame_error", 4.2, share=0.05, for_s=3.0),
    fault("datagram_loss", 4.3, share=0.3, for_s=2.0),
    fault("frame_loss", 4.4, node="lift", share=0.3, for_s=2.0),
    fault("datagram_doubled", 4.7, share=0.5, after_ms=30, for_s=2.0),
    fault("babbling_node", 4.8, every_us=400, for_s=0.3),
    fault("encoder_counts_lost", 5.0, node="left", share=0.01, for_s=1.0),
    fault("supply_sag", 5.2, to_v=15.0, for_s=0.5),
    fault("drive_restart", 8.6, node="left", for_s=0.3),
    fault("can_cut", 19.4, between=["steer", "lift"], for_s=0.3),
    fault("can_swapped", 18.9, node="right", for_s=0.1),
    fault("bus_off", 19.2, node="bridge", for_s=0.1),
    fault("nmt_foreign_node", 10.45, command="reset_node", node="left"),
    fault("node_silent", 10.5, node="steer", for_s=0.05),
)
Act = Callable[[Ride], None]

ACTS: Final[tuple[tuple[float, Act], ...]] = (
    (9.0, lambda one: one.rig.world.silence("steer", from_seconds(9.0))),
    (9.6, lambda one: one.rig.world.silence("steer", NEVER)),
    (18.5, lambda one: one.ends()),
)
"""Outside events: a drive is lost, and faults by itself; it is found again; the bridge ends."""


def eventful() -> Ride:
    """Start-up, driving, faults, the way back, an emergency stop, the lift, the end; with all noise."""
    return ride(
        ARMED,
        step(4.0, speed_mps=0.4),
        step(5.5, steer_deg=25),
        step(8.0, speed_mps=0.2, steer_deg=-10),
        step(10.0, speed_mps=0.0, steer_deg=0),
        step(12.0, arm=True),
        step(12.6, arm=True),
        step(13.0, speed_mps=0.3),
        step(14.0, emergency_stop=True),
        step(14.8, speed_mps=0.0),
        step(15.3, clear=True),
        step(15.6, arm=True),
        step(16.4, lift_m=0.05),
        step(17.8, force_disarm=True),
        seconds=SECONDS,
        noise=Noise(stick=0.02, delay_ms=3, jitter_ms=25, loss=0.03),
        seed=SEED,
        faults=FAULTS,
    )


def go(one: Ride, until: Nanoseconds) -> None:
    """Run to an instant; outside events come in time, in every kind of run."""
    for second, act in ACTS:
        if one.rig.world.now < from_seconds(second) <= until:
            one.rig.run(from_seconds(second))
            act(one)
    one.rig.run(until)


@dataclass
class Straight:
    """A run that went straight on."""

    one: Ride
    traces: dict[Nanoseconds, str] = field(default_factory=dict)


@pytest.fixture(scope="module")
def straight() -> Iterator[Straight]:
    run = Straight(eventful())
    for at in range(GRID, from_seconds(SECONDS) + 1, GRID):
        go(run.one, at)
        run.traces[at] = run.one.rig.world.trace_sha256
    yield run
    run.one.rig.finish()


def instants(count: int) -> list[Nanoseconds]:
    """Return wholly random instants, to the nanosecond."""
    chance = np.random.default_rng(SEED)
    return sorted(int(at) for at in chance.integers(1, from_seconds(SECONDS) - 2 * GRID, count))


@dataclass
class Kept:
    """A second run of the same kind, and the moments that were taken of it on the way."""

    one: Ride
    moments: list[tuple[Nanoseconds, Checkpoint]] = field(default_factory=list)
    digests: dict[Nanoseconds, str] = field(default_factory=dict)
    """Digests of the first time through; this rig is compared with itself, as two differ in addresses."""

    def moment(self, number: int) -> tuple[Nanoseconds, Checkpoint]:
        """Return one of them by its place among `EVERY`."""
        return self.moments[number * len(self.moments) // EVERY]


def look(found: Kept, at: Nanoseconds) -> None:
    go(found.one, at)
    found.digests[at] = digest(found.one.rig)


@pytest.fixture(scope="module")
def kept() -> Iterator[Kept]:
    found = Kept(eventful())
    checks = list(range(from_seconds(2.0), from_seconds(SECONDS) + 1, from_seconds(2.0)))
    for at in instants(INSTANTS):
        while checks[0] < at:
            look(found, checks.pop(0))
        go(found.one, at)
        moment = found.one.rig.snapshot()
        found.moments.append((at, moment))
    for at in checks:
        look(found, at)
    yield found
    found.one.rig.finish()


def test_the_story_has_everything_that_may_be_forgotten(straight: Straight) -> None:
    held = {event.name.split(":")[0] for event in straight.one.rig.interlock_events}
    assert {"starting", "not armed", "axis timeout", "axis fault", "emergency stop", "lift moving"} <= held
    assert straight.one.rig.operator_wire.lost > 0
    assert all(record.ended is not None for record in straight.one.rig.faults.records)
    assert len(straight.one.rig.faults.records) == len(FAULTS)
    assert straight.one.fastest(13.0, 14.0) > 0.2, "it drives again after the fault"
    assert max(row["lift_m"] for row in straight.one.rig.samples) > 0.01
    assert straight.one.rig.bridge.finished


@pytest.mark.parametrize(
    "count", [pytest.param(16, id="of 16"), pytest.param(EVERY, id="of all", marks=pytest.mark.long)]
)
def test_from_any_instant_the_run_goes_on_as_it_went(straight: Straight, kept: Kept, count: int) -> None:
    """In a random order, so that the way to a moment is another one than the first time."""
    one, rows = kept.one, straight.one.rig.samples
    order = np.random.default_rng(SEED + 1).permutation(len(kept.moments))[:count]
    for number in order:
        at, moment = kept.moments[number]
        one.rig.restore(moment)
        assert one.rig.world.now == at
        check = -(-(at + AHEAD) // GRID) * GRID
        go(one, check)
        assert one.rig.world.trace_sha256 == straight.traces[check], f"from {at} ns"
        assert list(one.rig.samples) == rows[: len(one.rig.samples)], f"from {at} ns"
        assert one.rig.samples[-1].at == check
        if check in kept.digests:
            assert digest(one.rig) == kept.digests[check], f"from {at} ns"


@pytest.mark.long(keeps=["4.7", "9.31"])
@pytest.mark.parametrize("second", [0.0, 0.4, 1.13, 2.9, 4.7, 9.31, 11.2, 14.05, 16.9, 18.7])
def test_nothing_that_can_change_is_left_out(kept: Kept, second: float) -> None:
    """The restored state is judged by a reader that does not know how moments are taken."""
    _, nearest = min(kept.moments, key=lambda pair: abs(pair[0] - from_seconds(second)))
    rig = kept.one.rig
    rig.restore(nearest)
    before, moment = digest(rig), rig.snapshot()
    rig.runs(0.3)
    assert digest(rig) != before
    rig.restore(moment)
    assert digest(rig) == before
    rig.restore(nearest)
    assert digest(rig) == before


def test_the_world_alone_can_be_rewound_too(kept: Kept) -> None:
    rig = kept.one.rig
    rig.restore(kept.moment(400)[1])
    moment, trace = rig.world.snapshot(), rig.world.trace_sha256
    rig.runs(0.5)
    assert rig.world.trace_sha256 != trace
    rig.world.restore(moment)
    assert rig.world.trace_sha256 == trace


def test_faults_can_be_put_on_a_rig_that_runs_and_are_gone_when_time_goes_back(kept: Kept) -> None:
    rig = kept.one.rig
    rig.restore(kept.moment(700)[1])
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


def test_a_broken_run_is_taken_back(kept: Kept) -> None:
    rig = kept.one.rig
    rig.restore(kept.moment(300)[1])
    moment, before = rig.snapshot(), digest(rig)
    rig.world.detach(BRIDGE)
    rig.runs(1.0)
    rig.restore(moment)
    assert digest(rig) == before
    rig.runs(0.5)
    assert not rig.bridge.finished


def test_a_moment_belongs_to_its_rig(kept: Kept, straight: Straight) -> None:
    with pytest.raises(RewindError, match="taken elsewhere"):
        straight.one.rig.restore(kept.moments[0][1])
    with pytest.raises(RewindError, match="taken elsewhere"):
        kept.one.rig.world.restore(kept.moments[0][1])


def test_observers_are_outside_and_receive_everything_again(kept: Kept) -> None:
    rig = kept.one.rig
    rig.restore(kept.moment(500)[1])
    moment = rig.snapshot()
    received: list[tuple[Nanoseconds, str]] = []
    rig.can_wire.observe(lambda now, sender, _: received.append((now, sender)))
    rig.runs(0.2)
    first = list(received)
    rig.restore(moment)
    rig.runs(0.2)
    assert first
    assert received == first * 2
    rig.can_wire.unobserved()


def test_a_forked_story_is_the_same_as_one_that_began_at_the_beginning(rides: Ridden) -> None:
    steps = (ARMED, step(4.0, speed_mps=0.3), step(4.4, steer_deg=20), step(5.0, emergency_stop=True))
    forked, fresh = rides(*steps, seconds=9), rides(*steps, seconds=9)
    assert forked.rig.world.now > 0
    assert fresh.rig.world.now == 0
    for one in (forked, fresh):
        one.runs_until(7.0)
    assert forked.rig.world.trace_sha256 == fresh.rig.world.trace_sha256
    assert forked.rig.samples == fresh.rig.samples
    assert forked.rig.interlock_events == fresh.rig.interlock_events
    assert forked.operator.diary == fresh.operator.diary


def test_an_operator_takes_no_mission_over_that_was_another_one_so_far(rides: Ridden) -> None:
    forked = rides(ARMED, step(4.0, speed_mps=0.3), seconds=9)
    forked.runs_until(4.5)
    with pytest.raises(ValueError, match="with other steps to come"):
        forked.operator.take_over(story(ARMED, step(4.0, speed_mps=0.2), seconds=9))
    with pytest.raises(ValueError, match="with other steps to come"):
        forked.operator.take_over(story(ARMED, step(4.0, speed_mps=0.3), seconds=9, noise=Noise(stick=0.1)))
