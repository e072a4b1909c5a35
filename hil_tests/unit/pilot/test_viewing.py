"""The view of an operator: the picture as it comes, or moved to the newest pose; another program draws it."""

import json
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.pilot.camera import UNSEEN
from firmware_bridge.pilot.driver import NEUTRAL, Sight, Target
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.pilot.station import PilotStation
from firmware_bridge.pilot.video import Video
from firmware_bridge.pilot.viewing import PERIOD, VIEW, Viewing
from firmware_bridge.runtime.ports import PortError
from firmware_bridge.runtime.ports.view_window import ViewWindow
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds, to_seconds

image: Final = pytest.importorskip("matplotlib.image")

ROBOT: Final = Codec(1, 1)
CYCLE: Final[Nanoseconds] = 50 * MILLISECOND


class Seeing:
    """A driver that does nothing and remembers what it saw."""

    def __init__(self) -> None:
        self.seen: list[Sight] = []

    def sees(self, sight: Sight) -> None:
        self.seen.append(sight)

    def command(self, _link: PilotLink, _now: Nanoseconds, *, armed: bool) -> Target:
        del armed
        return NEUTRAL


def driven(video: Video | None, *, predicted: bool) -> tuple[Seeing, list[tuple[float, Any]]]:
    """Return what the driver and the view see of a robot that drives 1 m/s for three seconds.

    Its pose comes each 50 ms without delay, and its clock is not known.
    """
    driver = Seeing()
    station = PilotStation(driver, (1, 1), video=video)
    view = Viewing(station, station, Video(), predicted=predicted)
    drawn: list[tuple[float, Any]] = []
    still = (0.0,) * 21

    def take(reaction: Reaction, now: Nanoseconds) -> None:
        drawn.extend((to_seconds(now), json.loads(one.payload)) for one in reaction.sent if one.link == VIEW)

    for now in range(0, 3 * SECOND + 1, CYCLE):
        odometry = dialect.MAVLink_odometry_message(
            now // MICROSECOND,
            *(1, 8, to_seconds(now), 0.0, 0.0, (1.0, 0.0, 0.0, 0.0), 1.0, 0.0, 0.0, 0.0, 0.0, 0.0),
            *(still, still),
        )
        take(view.receive(Packet(OPERATOR, 5, ROBOT.encode(odometry)), now), now)
        take(view.wake(now), now)
    return driver, drawn


@pytest.mark.parametrize("predicted", [False, True])
def test_the_picture_is_old_and_the_prediction_is_of_now(*, predicted: bool) -> None:
    _, drawn = driven(None, predicted=predicted)
    assert len(drawn) == pytest.approx(2.5 * SECOND / PERIOD, abs=1)
    for at, poses in drawn:
        assert 0.5 <= at - poses["picture"][0] < 1.0
        assert poses["now"] == (pytest.approx([at, 0.0, 0.0]) if predicted else poses["picture"])


def test_a_driver_by_video_sees_two_pictures_a_second_and_else_each_pose() -> None:
    by_video, _ = driven(Video(), predicted=False)
    assert [(one.received_at, one.moving.pose.x_m) for one in by_video.seen] == [
        (at * SECOND // 2, at / 2.0 - 0.5) for at in range(1, 7)
    ]
    assert len(driven(None, predicted=True)[0].seen) == 61


def line(picture: list[float], now: list[float]) -> bytes:
    return json.dumps({"picture": picture, "now": now}).encode() + b"\n"


def test_another_program_draws_it_into_a_file(tmp_path: Path) -> None:
    file = tmp_path / "view.png"
    port = ViewWindow(file)
    try:
        port.write(0, line([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]), 0)
        port.write(0, line([0.0, 0.0, 0.0], [0.2, 0.0, 0.2]), 0)
        assert port.read(0) == []
    finally:
        # It ends once it has drawn what it was given.
        port.close()
    port.close()
    picture = image.imread(file)
    assert picture.shape[:2] == (240, 320)
    unseen = (np.abs(picture[..., :3] - np.array(UNSEEN) / 255.0) < 0.004).all(axis=-1)
    # Without a depth nothing can be moved: above the horizon all is unseen.
    assert unseen[0].all()
    assert not unseen.all()


@pytest.mark.parametrize("problem", [BrokenPipeError, BlockingIOError])
def test_a_window_that_is_closed_or_behind_is_no_loss(
    problem: type[OSError], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    port, tried = ViewWindow(tmp_path / "view.png"), []

    def write(_file: int, payload: bytes) -> int:
        tried.append(payload)
        raise problem

    with monkeypatch.context() as patched:
        patched.setattr("os.write", write)
        port.write(0, b"a line", 0)
    port.close()
    assert tried == [b"a line"]


def test_a_place_where_nothing_can_be_written_is_reported(tmp_path: Path) -> None:
    with pytest.raises(PortError, match=r"a name that ends in \.png"):
        ViewWindow(tmp_path / "none" / "view.png")


def test_without_a_display_the_other_way_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    with pytest.raises(PortError, match="--view-to FILE"):
        ViewWindow(None)
