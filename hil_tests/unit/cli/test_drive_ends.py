"""End of `drive` where no drive answers: within the runner's time, and with their names."""

from collections.abc import Callable, Mapping
from typing import Final

import pytest

from firmware_bridge.cli.drive import DriveOptions, run
from firmware_bridge.cli.narrated import Narrated, StartUpFailedError
from firmware_bridge.node import Stoppable
from firmware_bridge.runtime.ports import Port
from firmware_bridge.runtime.runner import STOP_WITHIN
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds, to_seconds

NAMES: Final = "left rear wheel", "right rear wheel", "steering", "scissor lift"


@pytest.mark.parametrize("serial", [None, "/dev/nowhere"])
@pytest.mark.parametrize("after", [210 * MILLISECOND, SECOND])
def test_drives_that_are_not_known_to_be_without_power_are_named_at_the_end(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    serial: str | None,
    after: Nanoseconds,
) -> None:
    took: list[Nanoseconds] = []
    problems: list[str] = []

    def carried(
        node: Narrated,
        _openers: Mapping[str, Callable[[], Port]],
        *_rest: object,
        unfinished: Callable[[], str],
    ) -> None:
        """Carry the bridge to ports at which no one answers; ask it to end once it has begun to speak."""
        assert isinstance(node, Stoppable)
        now, reaction = 0, node.wake(0)
        while reaction.wake_at < after:
            now, reaction = reaction.wake_at, node.wake(reaction.wake_at)
        reaction = node.stop(after)
        while reaction.wake_at != NEVER:
            now = max(reaction.wake_at, now)
            reaction = node.wake(now)
        took.append(now - after)
        problems.append(unfinished())

    monkeypatch.setattr("firmware_bridge.cli.real_time.carry", carried)
    run(DriveOptions(robot="rars", mavlink="udpin:127.0.0.1:0", serial=serial))
    (text,) = problems
    assert "not confirmed to be without power" in text
    assert all(name in text for name in NAMES)
    assert "not acknowledged" not in capsys.readouterr().out, (
        "nothing was received: the stop stages report nothing"
    )
    assert took[0] < STOP_WITHIN, to_seconds(took[0])


def test_a_line_on_which_nothing_was_received_is_reported_with_what_it_was_spoken_to_in(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def carried(
        node: Narrated, _openers: Mapping[str, Callable[[], Port]], *_rest: object, **_more: object
    ) -> None:
        reaction = node.wake(0)
        while True:
            reaction = node.wake(reaction.wake_at)

    monkeypatch.setattr("firmware_bridge.cli.real_time.carry", carried)
    options = DriveOptions(robot="rars", mavlink="udpin:127.0.0.1:0", serial="/dev/nowhere")
    with pytest.raises(StartUpFailedError, match=r"nothing was received .* in v2 .*\(--protocol v1\)\?$"):
        run(options)
