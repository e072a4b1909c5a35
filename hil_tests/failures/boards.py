"""How far ROME's base runs on when its board fails in mid-motion, firmware by firmware."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from hil_tests.failures.kept import Kept
from hil_tests.scenarios.rome_ride import FULL, STANDS_MPS, driven, held, speed
from validation.pages.pages import table

FAILS_AT_S: Final = 6.5
WATCHED_S: Final = 8.0
LOOKS_S: Final = 0.01
TEXT: Final = """Each firmware's board fails while the base drives ahead with 0.3 m/s: the way and the time
from then until it stands for good, by the plant's truth, and how often the bridge resets the board. A test
drives each row again, to the millimetre.

No wire leads from the board's reset to the shield: the motors run on as they were told while a board boots,
and to set it up releases them. The cycle's next question keeps the boot loader of a Mega that was reset, for
as long as somebody speaks; a board that hangs looks the same. So both are told to release, are reset, and
hear nothing until the firmware must run. The auto-stop of ros_arduino_bridge hangs with its sketch, and
counts only where the line is cut; there a board without one **runs on** until the line is back: keep a
hardware switch within reach."""
HEADINGS: Final = ("what fails", *FULL)


@dataclass(frozen=True, slots=True)
class Fails:
    """One way to fail."""

    name: str
    fault: str


CAUSES: Final = (
    Fails("the board is reset", 'kind = "board_reset"'),
    Fails("the board hangs", 'kind = "board_hangs"'),
    Fails("the line is cut for 3.5 s", 'kind = "board_silent"\nfor_s = 3.5'),
)


@dataclass(frozen=True, slots=True)
class RunsOn:
    """One row of the file."""

    cause: str
    protocol: str
    way_mm: int
    rest_ms: int
    resets: int


KEPT: Final = Kept(RunsOn, "boards")


@dataclass(frozen=True, slots=True)
class Seen:
    """What came of it."""

    row: RunsOn
    holds: frozenset[str]
    armed: bool
    powered: bool


def seen(cause: Fails, protocol: str) -> Seen:
    """Drive it."""
    fault = f"[[fault]]\nat_s = {FAILS_AT_S}\n{cause.fault}\n"
    with driven(protocol, "speed_mps = 0.3", 20.0, fault, FULL[protocol]) as rig:
        rig.runs(FAILS_AT_S)
        (board,) = rig.devices.boards.values()
        first, before, rests = rig.samples[-1]["x_m"], board.mega.resets, 0
        for look in range(round(WATCHED_S / LOOKS_S)):
            rig.runs(LOOKS_S)
            if speed(rig) > STANDS_MPS:
                rests = look + 1
        row = RunsOn(
            cause.name,
            protocol,
            round(1000 * (rig.samples[-1]["x_m"] - first)),
            round(1000 * rests * LOOKS_S),
            board.mega.resets - before,
        )
        powered = any(axis.powered for axis in rig.devices.bank.axes)
        return Seen(row, frozenset(held(rig)), rig.bridge.seen.facts.armed, powered)


def sections() -> tuple[str, ...]:
    """Return the part of the page, in Markdown."""
    return ("### How far it runs on when its board fails", TEXT, table(HEADINGS, _lines()))


def _lines() -> Iterator[tuple[str, ...]]:
    rows = {(row.cause, row.protocol): row for row in KEPT.read()}
    for cause in CAUSES:
        found = [rows[cause.name, protocol] for protocol in FULL]
        yield (
            cause.name,
            *(
                f"{row.way_mm} mm, {row.rest_ms / 1000:.2f} s, {row.resets} reset{'s' * (row.resets != 1)}"
                for row in found
            ),
        )
