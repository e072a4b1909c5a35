"""The station's rates and its silence, the hand's ramps and its tremor; one seed gives the same bytes."""

from collections.abc import Iterator

import numpy as np
import pytest

from emulators.bench.operator import ScriptedOperator
from emulators.bench.stick import Ramp, Tremor
from emulators.robots.rars import BENCH_SETUP
from firmware_bridge.intent import Arm
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, from_seconds
from hil_tests.unit.bench_operator.joined import CYCLE, RARS, Joined, find, join, mission


@pytest.fixture
def generators() -> Iterator[np.random.Generator]:
    return (np.random.default_rng(seed) for seed in range(10))


def test_heartbeats_and_sticks_come_at_their_rates() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.run(4.99)
    assert [at for at, _ in joined.messages("HEARTBEAT")] == [n * SECOND for n in range(5)]
    assert [at for at, _ in joined.messages("MANUAL_CONTROL")] == [n * CYCLE for n in range(100)]


def test_the_station_is_a_station() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.run(0.5)
    [(_, heartbeat)] = joined.messages("HEARTBEAT")
    assert (heartbeat.type, heartbeat.autopilot, heartbeat.get_srcSystem(), heartbeat.get_srcComponent()) == (
        6,
        8,
        255,
        190,
    )


def test_silence_is_total_and_ends() -> None:
    joined = join(mission("1.0 speed_mps = 0.3", "2.0 silent_s = 1.5", "2.5 arm = true"))
    assert joined.run(3.4).received_at == from_seconds(1.95)
    assert not [at for at, _ in joined.sent if 2 * SECOND <= at < from_seconds(3.5)]
    assert joined.run(3.5).received_at == from_seconds(3.5)
    joined.run(5.0)
    assert joined.robotlike.requests == [Arm()]
    assert [at for at, _ in joined.messages("HEARTBEAT")] == [n * SECOND for n in (0, 1, 4, 5)]


def test_the_hand_trembles_only_while_it_drives_and_by_the_seed() -> None:
    def sticks(seed: int) -> list[tuple[int, int]]:
        joined = join(mission("1.0 speed_mps = 0.3", head="[noise]\nstick = 0.01\n"), seed)
        joined.run(60.0)
        return [(one.x, one.r) for _, one in joined.messages("MANUAL_CONTROL")]

    one = sticks(1)
    assert one == sticks(1)
    assert one != sticks(2)
    still, moving = one[:20], one[20:]
    assert set(still) == {(0, 0)}
    assert abs(np.corrcoef([x for x, _ in moving], [r for _, r in moving])[0, 1]) < 0.5
    assert np.mean([x for x, _ in moving]) == pytest.approx(600, abs=5)
    assert np.std([x for x, _ in moving]) == pytest.approx(10, rel=0.35)
    assert np.std([r for _, r in moving]) == pytest.approx(10, rel=0.35)


def test_without_noise_no_random_number_is_drawn() -> None:
    generator = np.random.default_rng(1)
    before = generator.bit_generator.state
    joined = Joined(ScriptedOperator(RARS, BENCH_SETUP, find("line"), generator))
    joined.run(30.0)
    assert generator.bit_generator.state == before


@pytest.mark.long(beside="test_two_runs_with_one_seed_are_the_same_bytes")
def test_two_runs_send_the_same_bytes() -> None:
    def run() -> list[tuple[Nanoseconds, bytes]]:
        joined = join(find("interlocks"), seed=3)
        joined.run(102.0)
        return joined.sent

    assert run() == run()


def test_a_ramp_changes_its_mind_without_a_jump() -> None:
    ramp = Ramp()
    ramp.go(1.0, 0.1, 0)
    assert ramp.at(5 * SECOND) == pytest.approx(0.5)
    ramp.go(0.0, 0.2, 5 * SECOND)
    assert ramp.at(6 * SECOND) == pytest.approx(0.3)
    assert ramp.at(60 * SECOND) == 0.0
    ramp.go(-1.0, None, 60 * SECOND)
    assert ramp.at(60 * SECOND) == -1.0


def test_a_tremor_keeps_its_deviation_at_any_rate(generators: Iterator[np.random.Generator]) -> None:
    for period in (10 * MILLISECOND, 50 * MILLISECOND, SECOND):
        tremor = Tremor(0.01, period, next(generators))
        assert np.std([tremor.step() for _ in range(20_000)]) == pytest.approx(0.01, rel=0.1)
