"""A tour of the live page in a browser: each of its parts and buttons, on a bench and on a recording."""

import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from emulators.testing.plugin import PROGRAM
from emulators.testing.process import Process
from hil_tests.lanes import HUNG_S
from hil_tests.live.browser import Browser, browser

pytest_plugins = ["emulators.testing.plugin"]
pytestmark = pytest.mark.browser

WIDE, NARROW = (1280, 1400), (400, 900)
SPEED = "Math.abs(known.state.command['speed'])"
GAMEPAD = """
globalThis.standIn = {axes: [0, 0, 0, 0],
    buttons: Array.from({length: 17}, () => ({pressed: false, value: 0})),
    connected: true, index: 0, id: "stand-in", mapping: "standard", timestamp: 0};
navigator.getGamepads = () => [{...standIn, timestamp: performance.now()}];
dispatchEvent(new Event("gamepadconnected"));
"""


REWIND = """(e => {
    e.value = %d;
    e.dispatchEvent(new Event('input'));
    e.dispatchEvent(new Event('change'));
})(document.getElementById('rewind'))"""


@pytest.fixture
def page(tmp_path: Path) -> Iterator[Browser]:
    with browser(tmp_path / "profile") as one:
        yield one
        assert one.errors == []


def address(program: Process) -> str:
    """Return the page's address, which a program has printed."""
    program.prints("Ctrl-C ends it", HUNG_S)
    found = re.search(r"live page: (http://\S+)", program.printed)
    assert found is not None
    return found[1]


def fits(page: Browser, path: Path) -> None:
    """Check that the page has no sideways scrolling, and that its stops are in view; keep a picture."""
    for width, height in (WIDE, NARROW):
        page.resizes(width, height)
        page.rests()
        assert page.value("document.documentElement.scrollWidth <= innerWidth")
        for stop in ("stop", "emergency"):
            corners = "(b => [b.left, b.top, b.right, b.bottom])"
            box = page.value(f"{corners}(document.getElementById('{stop}').getBoundingClientRect())")
            assert 0 <= box[0] < box[2] <= width
            assert 0 <= box[1] < box[3] <= height
        page.screenshot(path.with_name(f"{path.name}-{width}.png"))
    page.resizes(*WIDE)


def drives_by_hand(page: Browser, folder: Path) -> None:
    """Drive by keys, a tab that loses its focus, and a gamepad as helm and pedals."""
    page.clicks("take")
    page.waits("known.state.operator.station.startsWith('254/190')")
    page.waits("document.getElementById('arm').offsetParent !== null")
    page.clicks("arm")
    page.waits(f"{SPEED} === 0 && known.state.armed && known.state.interlocks.length === 0")
    page.key("w", down=True)
    page.waits(f"{SPEED} > 0.05")
    page.value("dispatchEvent(new Event('blur'))")
    page.waits(f"{SPEED} === 0")
    page.key("w", down=False)
    page.value(GAMEPAD)
    for _ in range(10):
        page.rests()
    # A helm and two pedals, as the robot's station has them: the right trigger accelerates.
    assert page.value("document.getElementById('wheel').checkVisibility()")
    assert page.value("document.querySelectorAll('#gauges dd').length") >= 6
    page.value("standIn.buttons[7] = {pressed: true, value: 0.8}")
    page.waits(f"{SPEED} > 0.05")
    page.value("standIn.buttons[7] = {pressed: false, value: 0}")
    page.waits(f"{SPEED} === 0")
    page.clicks("reverse")
    page.value("standIn.buttons[7] = {pressed: true, value: 0.8}")
    page.waits("known.state.command['speed'] < -0.05")
    page.value("standIn.buttons[7] = {pressed: false, value: 0}")
    page.waits(f"{SPEED} === 0")
    page.screenshot(folder / "station.png")


def test_a_bench_is_shown_broken_driven_stopped_put_back_and_ended(
    page: Browser, under_test: Callable[[Sequence[str]], Process], tmp_path: Path
) -> None:
    words = ("bench", "rars", "--mission", "line", "--realtime", "--live", "--out", str(tmp_path / "out"))
    program = under_test((*PROGRAM, *words))
    page.opens(address(program), *WIDE)
    page.waits("known.state?.armed && known.state.axes.length === 4")
    fits(page, tmp_path / "bench")
    # Time.
    page.clicks("pause")
    page.waits("known.state.paused")
    page.value("globalThis.before = known.state.at_s")
    page.value("document.getElementById('step').requestSubmit()")
    page.waits("known.state.at_s > before + 0.05 && known.state.paused")
    page.clicks("pause")
    page.waits("!known.state.paused")
    # A fault, by its form; frames in words.
    page.value(
        "(e => {e.value = 'set_points_ignored'; e.dispatchEvent(new Event('input'))})"
        "(document.getElementById('fault-filter'))"
    )
    page.value("document.querySelector('#fault-kinds button').click()")
    page.value("document.getElementById('fault-form').requestSubmit()")
    page.waits("known.state.faults.some(one => one.kind === 'set_points_ignored')")
    page.clicks("clear-all")
    page.waits("known.state.faults.length === 0")
    page.clicks("watch")
    page.waits("document.querySelectorAll('#frames > *').length > 10")
    page.clicks("watch")
    drives_by_hand(page, tmp_path)
    # Stops, by keys.
    page.key("Escape", down=True)
    page.key("Escape", down=False)
    page.waits("known.state.stopped && !known.state.armed")
    page.waits("known.state.interlocks.some(one => one.name === 'emergency stop')")
    page.screenshot(tmp_path / "stopped.png")
    # A mission, from the page.
    page.value("document.getElementById('missions').value = 'line'")
    page.value("document.getElementById('mission').requestSubmit()")
    page.waits("document.body.innerText.includes('mission line begins')")
    # Time put back to before the stop.
    page.value(REWIND % 4)
    page.waits("known.state.at_s < 5 && !known.state.stopped")
    page.clicks("shutdown")
    page.clicks("shutdown")
    program.prints("results:", HUNG_S)
    page.waits("!document.getElementById('lost').hidden")


def test_a_robot_with_an_arm_is_shown_from_above_and_from_the_side(
    page: Browser, under_test: Callable[[Sequence[str]], Process], tmp_path: Path
) -> None:
    words = ("bench", "rome_arm", "--mission", "orbit", "--realtime", "--live", "--out", str(tmp_path))
    page.opens(address(under_test((*PROGRAM, *words))), *WIDE)
    page.waits("known.state?.armed && known.state.arm.length === 7")
    assert page.value("document.querySelectorAll('#robot polygon').length") == 4
    page.value("globalThis.before = document.getElementById('tool').textContent")
    page.waits("document.getElementById('tool').textContent !== before")
    drawn = "document.querySelector('#{} .arm polyline').points.length"
    assert [page.value(drawn.format(one)) for one in ("robot", "side")] == [7, 7]
    # Its margin has a plot behind the three of its axes, and a line for the least one.
    page.waits("plots.charts.length === 4 && plots.charts[3].data[1].filter(isNumber).length > 5")
    assert page.value("new Set(plots.charts[3].data[2].filter(isNumber)).size") == 1
    fits(page, tmp_path / "arm")


def test_a_recording_is_played_in_a_browser(
    page: Browser, under_test: Callable[[Sequence[str]], Process], tmp_path: Path
) -> None:
    recorded = str(tmp_path / "run.mcap")
    words = ("bench", "rars", "--mission", "line", "--record", recorded, "--out", str(tmp_path / "out"))
    under_test((*PROGRAM, *words)).prints("results:", HUNG_S)
    page.opens(address(under_test((*PROGRAM, "live", recorded))), *WIDE)
    page.waits("known.state?.at_s > 0.2")
    assert page.value("document.getElementById('stop').offsetParent") is None, "a recording cannot be stopped"
    assert page.value("document.querySelectorAll('#robot polygon').length") == 5
    page.value(REWIND % 6)
    page.waits("known.state.at_s >= 6 && known.state.armed")
    page.screenshot(tmp_path / "recording.png")
