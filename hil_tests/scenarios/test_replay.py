"""A recorded run plays again without a difference, and one changed bit is named exactly."""

import lzma
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from emulators.replay import Into, RecordingFileError, ReplayOrder, ReplayResult, replay
from emulators.replay.player import Player
from emulators.rig import Rig
from emulators.robots.rars import BENCH_SETUP
from emulators.trace import parse_trace_line
from firmware_bridge.intent import ConfirmPosition
from firmware_bridge.node import CAN
from firmware_bridge.recording import candump_line, tlog_records
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, SECOND

GOLDEN = Path(__file__).parents[1] / "golden"
FOREIGN_NODE = GOLDEN.parent / "recordings" / "rars" / "canopen-master.log.xz"
RARS = find("rars")
SHORT = SECOND
LISTENS = 200 * MILLISECOND
"""Time for which a starting bridge listens to the bus before its first frame."""


class Session:
    """The first seconds of a mission as `bench` would record them."""

    def __init__(self, mission: str, folder: Path) -> None:
        self.log, self.tlog = folder / "can.log", folder / "operator.tlog"
        frames, messages = [], []
        self.senders: list[str] = []
        self.instants: list[int] = []
        for line in lzma.decompress((GOLDEN / f"{mission}.trace.xz").read_bytes()).decode().splitlines():
            at, link, sender, packet = parse_trace_line(line)
            if link == CAN:
                frames.append(candump_line(at, packet))
                self.senders.append(sender)
                self.instants.append(at)
            else:
                messages.append(tlog_records(at, packet.payload))
        self.lines = frames
        """Frame by frame; the others are parallel to it."""
        self.log.write_text("\n".join(frames) + "\n", encoding="ascii")
        self.tlog.write_bytes(b"".join(messages))


@pytest.fixture(scope="module")
def line(tmp_path_factory: pytest.TempPathFactory) -> Session:
    return Session("line", tmp_path_factory.mktemp("line"))


def order(session: Session, into: Into, log: Path | None = None, until: int | None = None) -> ReplayOrder:
    with_operator = session.tlog if into is Into.BRIDGE else None
    recording = session.tlog if into is Into.BENCH else log or session.log
    return ReplayOrder(RARS, recording, with_operator, into, until=until)


@pytest.mark.long(keeps=["drives"])
@pytest.mark.parametrize("into", Into)
def test_a_run_plays_again_into_all_that_took_part(line: Session, into: Into) -> None:
    outcome = replay(order(line, into))
    assert outcome.difference is None
    assert outcome.compared > 500
    assert outcome.played > 100
    assert outcome == replay(order(line, into))


@pytest.mark.long(keeps=["bridge"])
@pytest.mark.parametrize("into", [Into.BRIDGE, Into.BENCH])
def test_delays_and_losses_on_the_operators_link_are_no_difference(into: Into, tmp_path: Path) -> None:
    assert replay(order(Session("circles", tmp_path), into)).difference is None


def flipped(session: Session, folder: Path, number: int, bit: int) -> Path:
    """Write the recording with one bit of one frame's content changed; `number` as editors count lines."""
    head, content = session.lines[number - 1].rsplit("#", 1)
    other = int(content, 16) ^ 1 << bit % (4 * len(content))
    changed = [*session.lines]
    changed[number - 1] = f"{head}#{other:0{len(content)}X}"
    file = folder / "changed.log"
    file.write_text("\n".join(changed) + "\n", encoding="ascii")
    return file


def lines_of(session: Session, theirs: Callable[[str], bool]) -> list[int]:
    """Return the numbers of five frames with content that those senders have sent within the short time."""
    numbers = [
        place + 1
        for place, text in enumerate(session.lines)
        if theirs(session.senders[place])
        and not text.endswith("#")
        and MILLISECOND < session.instants[place] < SHORT * 0.9
    ]
    return [numbers[place * (len(numbers) - 1) // 4] for place in range(5)]


def last_of(session: Session, theirs: Callable[[str], bool]) -> int:
    """Return the place of the last frame of those senders within the short time."""
    return max(
        place
        for place, sender in enumerate(session.senders)
        if theirs(sender) and session.instants[place] < SHORT * 0.9
    )


@pytest.mark.long(keeps=["bridge-3", "drives-1"])
@pytest.mark.parametrize("place", range(5))
@pytest.mark.parametrize("into", [Into.DRIVES, Into.BRIDGE])
def test_one_changed_bit_is_named_exactly(line: Session, into: Into, place: int, tmp_path: Path) -> None:
    number = lines_of(line, lambda sender: (sender == "bridge") is (into is Into.BRIDGE))[place]
    outcome = replay(order(line, into, flipped(line, tmp_path, number, 7 * place), SHORT))
    assert outcome.difference is not None
    head, *context, expected, came = outcome.difference.splitlines()
    assert head == f"changed.log, line {number} is the first that differs"
    assert len(context) == min(5, number - 1) or into is Into.BRIDGE
    name, true = line.lines[number - 1].split()[2].split("#")
    assert f"{line.senders[number - 1]}  {name}#{true}" in came
    assert f"{line.senders[number - 1]}  {name}#" in expected
    assert expected.replace("expected", "but came") != came


def edited(session: Session, folder: Path, edit: Callable[[list[str]], list[str]]) -> Path:
    file = folder / "edited.log"
    file.write_text("\n".join(edit([*session.lines])) + "\n", encoding="ascii")
    return file


def reported(session: Session, file: Path) -> list[str]:
    outcome = replay(order(session, Into.DRIVES, file, SHORT))
    assert outcome.difference is not None
    return outcome.difference.splitlines()


def test_a_frame_that_is_missing_in_the_recording_is_shown_as_the_one_that_came(
    line: Session, tmp_path: Path
) -> None:
    number = lines_of(line, lambda sender: sender == "left")[2]
    head, *_, came = reported(line, edited(line, tmp_path, lambda all_: all_[: number - 1] + all_[number:]))
    assert head.startswith("edited.log, line ")
    assert line.lines[number - 1].split()[2] in came


def test_a_frame_that_does_not_come_is_stated_to_be_missing(line: Session, tmp_path: Path) -> None:
    # A heartbeat of the first drive, after which it sends nothing more in this recording.
    last = last_of(line, lambda sender: sender == "left")

    def edit(all_: list[str]) -> list[str]:
        return [*all_[: last + 1], line.lines[last].split()[0] + " vcan0 701#7F"]

    head, *_, expected, came = reported(line, edited(line, tmp_path, edit))
    assert head == f"edited.log, line {last + 2} is the first that differs"
    assert "heartbeat, node 1: pre operational" in expected
    assert came == "but came  nothing more"


@pytest.mark.long(keeps=["49-False", "50-True"])
@pytest.mark.parametrize(("tolerance_us", "fits"), [(0, False), (49, False), (50, True)])
def test_a_late_frame_is_one_within_the_tolerance(
    line: Session, tolerance_us: int, *, fits: bool, tmp_path: Path
) -> None:
    # The last frame of the drives: no one answers it.
    last = last_of(line, lambda sender: sender != "bridge")
    text = line.lines[last]
    late = f"{text[:12]}{int(text[12:18]) + 50:06d}{text[18:]}"
    file = edited(line, tmp_path, lambda all_: [*all_[:last], late])
    outcome = replay(ReplayOrder(RARS, file, into=Into.DRIVES, tolerance=tolerance_us * 1000))
    assert (outcome.difference is None) is fits
    if outcome.difference is not None:
        assert outcome.difference.endswith("the same, but 50 us earlier")


def test_services_may_be_left_out(line: Session, tmp_path: Path) -> None:
    number = next(i for i, text in enumerate(line.lines, start=1) if " 283#" in text)
    file = flipped(line, tmp_path, number, 0)
    until = SHORT // 2
    assert replay(ReplayOrder(RARS, file, until=until)).difference is not None
    assert replay(ReplayOrder(RARS, file, until=until, without=frozenset({"pdo"}))).difference is None


def test_the_drives_of_a_real_bus_are_switched_on_when_they_boot(line: Session, tmp_path: Path) -> None:
    real = [text.replace("(15778368", "(17778368", 1) for text in line.lines]
    assert real[0] != line.lines[0]
    outcome = replay(
        ReplayOrder(RARS, edited(line, tmp_path, lambda _: real), until=LISTENS + 20 * MILLISECOND)
    )
    assert outcome.difference is None
    assert outcome.compared > 50


def test_drives_that_were_there_before_the_recording_boot_unheard(line: Session, tmp_path: Path) -> None:
    lines = lzma.decompress(FOREIGN_NODE.read_bytes()).decode().splitlines()
    assert [text.split()[2] for text in lines[:5]] == [
        "701#00",
        "702#00",
        "703#00",
        "704#00",
        lines[4].split()[2],
    ]
    outcome = replay(ReplayOrder(RARS, edited(line, tmp_path, lambda _: lines[4:])))
    assert outcome.difference is None
    assert outcome.compared > 50
    changed = [*lines[4:-1], lines[-1][:-1] + "F"]
    outcome = replay(ReplayOrder(RARS, edited(line, tmp_path, lambda _: changed)))
    assert outcome.difference is not None
    assert outcome.difference.startswith(f"edited.log, line {len(changed)} is the first that differs")
    assert "\nexpected  0.69" in outcome.difference, "instants count from the first frame"


def test_drives_that_say_nothing_stay_off_the_bus(line: Session, tmp_path: Path) -> None:
    keep = [
        text for text, sender in zip(line.lines, line.senders, strict=True) if sender in {"left", "bridge"}
    ]
    outcome: ReplayResult = replay(
        ReplayOrder(
            RARS,
            edited(line, tmp_path, lambda _: keep),
            until=LISTENS + 10 * MILLISECOND,
            tolerance=MILLISECOND,
        )
    )
    assert outcome.difference is None
    assert outcome.compared > 3


@pytest.mark.long(beside="test_a_run_plays_again_into_all_that_took_part")
def test_a_bridge_that_was_given_where_its_axes_stand_is_informed_again(tmp_path: Path) -> None:
    frames, messages = [], []
    stated = (ConfirmPosition("lift", 0.1), ConfirmPosition("steer", 10.0))
    rig = Rig(RARS, BENCH_SETUP, Player([]), confirmed=stated)
    rig.can_wire.observe(lambda at, _, packet: frames.append(candump_line(at, packet)))
    rig.operator_wire.observe(lambda at, _, packet: messages.append(tlog_records(at, packet.payload)))
    rig.run(2 * SECOND)
    rig.finish()
    log, tlog = tmp_path / "can.log", tmp_path / "operator.tlog"
    log.write_text("\n".join(frames) + "\n", encoding="ascii")
    tlog.write_bytes(b"".join(messages))
    for one in (ReplayOrder(RARS, log, into=Into.BRIDGE), ReplayOrder(RARS, tlog, into=Into.BENCH)):
        assert replay(replace(one, confirmed=stated)).difference is None
        assert replay(one).difference is not None
    with pytest.raises(RecordingFileError, match=r"can\.log: the drives take no position, a bridge does"):
        replay(ReplayOrder(RARS, log, into=Into.DRIVES, confirmed=stated))
