"""What comes of four failures and of what somebody orders, for every robot and on every link: measured."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from emulators.rig import BRIDGE
from emulators.testing.rig import STEP_S, VirtualRig
from firmware_bridge.bridge.stops import Progress
from firmware_bridge.robot.settings.shield import ShieldLink
from hil_tests.failures.kept import Kept
from hil_tests.safety.driving import ARM, SPEEDS, driving, robot_of
from validation.pages.pages import table

WATCHED_S: Final = 12.0
STANDS_MPS: Final = 0.005
LOOKS: Final = 10
"""Samples over which motion is the mean: a stepper's rotor swings with each step."""
NO_ONE: Final = "no one"
ALONE: Final = "the devices by themselves"
TEXT: Final = """Straight ahead at {speed}, on the flat, by the plant's truth: how far it goes on, for how
long, and who stops it; with several steps of a stop, those that its axes needed. "Line cut" is the bridge's
end of a bus, the adapter of a serial line, or a board's cable, for good; "reset" a board's button, or a
drive's supply for 0.3 s. A test drives each row again, to the millimetre."""
LINES: Final = {
    "rars": ("rars", "rars+serial"),
    "climber": ("climber", "climber+serial"),
    "rome": ("rome:ros-arduino-bridge", "rome:mw:3", "rome:arduinoio:3", "rome+cameras:firmata"),
    "ar2": (ARM,),
    "rome_arm": ("rome_arm", "rome_arm:mw:3"),
}
"""How each robot is reached."""
ENCODER: Final = {"rome": "encoder_cable_off", "rome_arm": "encoder_cable_off"}
"""What takes an encoder off; `encoder_cut` of a drive, and an arm without encoders has none."""
FAILING: Final = {"rars": "left", "climber": "left", "rome": "two", "rome_arm": "two"}


def _fault(kind: str, **keys: object) -> Callable[[VirtualRig], None]:
    return lambda rig: rig.fault(kind, **keys)


def _link(rig: VirtualRig) -> dict[str, str]:
    boards = [*rig.robot.shield_links, *rig.robot.ar2_links]
    return {"link": boards[0]} if len(boards) > 1 else {}


def _cut(rig: VirtualRig) -> None:
    """Cut a board's cable, the bus behind the bridge, or unplug the adapter of a serial line."""
    if rig.robot.shield_links or rig.robot.ar2_links:
        rig.fault("board_silent", **_link(rig))
    elif rig.bench.lines:
        rig.fault("serial_unplugged")
    else:
        rig.fault("node_silent", node="bridge")


def _reset(rig: VirtualRig) -> None:
    """Reset what moves: a board's button, a drive's supply."""
    if rig.robot.shield_links or rig.robot.ar2_links:
        rig.fault("board_reset", **_link(rig))
    else:
        rig.fault("drive_restart", node=FAILING[rig.robot.kind], for_s=0.3)


def _encoder(rig: VirtualRig) -> None:
    rig.fault(ENCODER.get(rig.robot.kind, "encoder_cut"), node=FAILING[rig.robot.kind])


CAUSES: Final[Mapping[str, Callable[[VirtualRig], None]]] = {
    "stick let go": lambda rig: rig.operator.lets_go(),
    "emergency stop": lambda rig: rig.operator.stops(),
    "forced disarm": lambda rig: rig.operator.does(force_disarm=True),
    "end of the program": lambda rig: rig.bench.world.stop(BRIDGE),
    "bridge killed": _fault("bridge_ends", how="killed"),
    "line cut": _cut,
    "board or drive reset": _reset,
    "encoder off": _encoder,
}


@dataclass(frozen=True, slots=True)
class Row:
    """What came of one cause, by the plant's truth."""

    line: str
    cause: str
    way_mm: int
    """Of base or tool, until it stood; where it never did, until the end of the look."""
    rest_ms: int
    """-1 where it never stood."""
    by: str
    """Who stopped it."""


KEPT: Final = Kept(Row, "every_robot")


def wanted(robot: str) -> Iterator[tuple[str, str]]:
    """Yield each way to reach a robot with each cause that it can have."""
    for line in LINES[robot]:
        for cause in CAUSES:
            if cause != "encoder off" or robot != ARM:
                yield line, cause


def measured(line: str, cause: str) -> Row:
    """Drive it."""
    with driving(line) as rig:
        places = [_place(rig)]
        CAUSES[cause](rig)
        began, rests, way = rig.now, 0.0, 0.0
        while rig.now < began + WATCHED_S:
            rig.runs(STEP_S)
            places.append(_place(rig))
            if _moves(rig, places):
                rests, way = rig.now - began, math.dist(places[-1], places[0])
        if rests > WATCHED_S - 1.0:
            return Row(line, cause, round(1000 * way), -1, NO_ONE)
        return Row(line, cause, round(1000 * way), round(1000 * rests), _by(rig, cause))


def _moves(rig: VirtualRig, places: list[tuple[float, ...]]) -> bool:
    turns = 0.15 * abs(rig.body.yaw_rate_rad_s) > STANDS_MPS
    return turns or math.dist(places[-1], places[-1 - LOOKS :][0]) > STANDS_MPS * LOOKS * STEP_S


def _place(rig: VirtualRig) -> tuple[float, ...]:
    """Return where the base is, or an arm's tool."""
    names = ("x_m", "tool_y_m", "y_m") if rig.robot.kind == ARM else ("x_m", "y_m")
    return tuple(getattr(rig.body, name) for name in names)


def _by(rig: VirtualRig, cause: str) -> str:
    """Tell who stopped it: the bridge by the last step of a stop, or the devices by themselves."""
    stops = rig.bench.bridge.stops.values()
    lost = any(stop.progress in (Progress.GIVEN_UP, Progress.NOT_ASKED) for stop in stops)
    if cause == "bridge killed" or (cause == "line cut" and lost):
        return ALONE
    last = {stop.steps[min(stop.place, len(stop.steps) - 1)].name for stop in stops if stop.steps}
    return f"the bridge: {', '.join(sorted(last))}"


def sections(robot: str) -> tuple[str, ...]:
    """Return the part of the page on safety, in Markdown."""
    lines = LINES.get(robot, ())
    if not lines:
        return ()
    speeds = f"{SPEEDS.get(robot, 0.3):g} m/s" if robot != ARM else "20 mm/s at the tool"
    headings = ("what happens", *map(_title, lines))
    return ("### What comes of it, measured", TEXT.format(speed=speeds), table(headings, _cells(lines)))


def _title(line: str) -> str:
    link = next(iter(robot_of(line).links.values()))
    spoken = f", {link.protocol.value}" if isinstance(link, ShieldLink) else ""
    return f"{link.driver.value}{spoken}"


def _cells(lines: Sequence[str]) -> Iterator[tuple[str, ...]]:
    rows = {(row.line, row.cause): row for row in KEPT.read()}
    for cause in CAUSES:
        found = [rows.get((line, cause)) for line in lines]
        if any(found):
            yield (cause, *("-" if row is None else _cell(row) for row in found))


def _cell(row: Row) -> str:
    if row.rest_ms < 0:
        return f"**drives on**: {row.way_mm / 1000:.1f} m in {WATCHED_S:g} s"
    return f"{row.way_mm} mm, {row.rest_ms / 1000:.2f} s, {row.by}"
