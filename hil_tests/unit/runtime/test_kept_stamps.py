"""The file in which signatures' time stamps outlive the bridge: what was believed is not believed again."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.mavlink.trust import NO_STAMPS, UNIT, Stamps
from firmware_bridge.runtime.kept_stamps import EVERY, DamagedStampsError, KeptStamps
from firmware_bridge.units import SECOND

STATION, OTHER = (255, 190, 1), (254, 190, 0)


def test_what_is_written_at_the_end_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "deeper" / "rars.stamps.json"
    stamps = Stamps(123, 100, {STATION: 45, OTHER: (1 << 48) - 1})
    kept = KeptStamps(path)
    kept.write(stamps, 0)
    assert kept.file.settled() is None
    assert KeptStamps(path).read() == stamps
    assert [one.name for one in path.parent.iterdir()] == [path.name], "nothing else is left there"


def test_before_the_first_run_there_is_nothing(tmp_path: Path) -> None:
    assert KeptStamps(tmp_path / "rars.stamps.json").read() == NO_STAMPS


@pytest.mark.parametrize(
    "text",
    [
        "", "{", "[]", "null", "{}", '{"own": 1}', '{"own": 1, "streams": []}', '{"own": -1, "streams": {}}',
        '{"own": "1", "streams": {}}', '{"own": 1, "streams": {"255/190": 1}}', "\x00",
        '{"own": 1, "streams": {"a/b/c": 1}}', '{"own": 1, "streams": {"1/1/1": 281474976710656}}',
    ],
)  # fmt: skip
def test_a_damaged_file_is_no_reason_to_believe(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rars.stamps.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DamagedStampsError, match=r"rars\.stamps\.json"):
        KeptStamps(path).read()


def test_a_new_stream_is_written_at_once_and_the_rest_when_it_is_due(tmp_path: Path) -> None:
    kept = KeptStamps(tmp_path / "rars.stamps.json")
    kept.keep(Stamps(0, 0, {STATION: 5}), 0)
    kept.keep(Stamps(0, 0, {STATION: 9}), 1)
    assert kept.file.settled() is None
    assert kept.read().streams == {STATION: 5}
    kept.keep(Stamps(0, 0, {STATION: 9, OTHER: 3}), 2)
    assert kept.file.settled() is None
    assert kept.read().streams[OTHER] == 3


@given(pace=st.integers(1, 200_000), writes=st.integers(2, 20), crash=st.integers(0, EVERY - 1))
def test_a_crash_between_two_writes_leaves_nothing_that_was_received_open(
    tmp_path_factory: pytest.TempPathFactory, pace: int, writes: int, crash: int
) -> None:
    """A stream at any steady pace: stamps that follow the time, or that count frames."""
    kept = KeptStamps(tmp_path_factory.mktemp("stamps") / "rars.stamps.json")

    def at(now: int) -> Stamps:
        return Stamps(now // UNIT, now // UNIT, {STATION: 1000 + now * pace // EVERY})

    for n in range(writes):
        kept.keep(at(n * EVERY), n * EVERY)
    last = at((writes - 1) * EVERY + crash)
    assert kept.file.settled() is None
    found = kept.read()
    assert found.streams[STATION] >= last.streams[STATION]
    assert found.own >= last.own
    soon = at((writes + 2) * EVERY)
    assert found.streams[STATION] < soon.streams[STATION], "it is not locked out for good"
    assert found.own <= last.own + 2 * SECOND * 2 // UNIT


def test_a_file_that_cannot_be_written_states_so(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    kept = KeptStamps(tmp_path / "file" / "rars.stamps.json")
    kept.keep(NO_STAMPS, 0)
    assert kept.file.settled() == f"{kept.path}: File exists"
