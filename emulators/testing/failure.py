"""Output of a failing test: its recording in a folder, and a report of the robot's events."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from emulators.bench.columns import motor_speed
from emulators.bench.records import FaultRecord
from emulators.testing.rig import VirtualRig
from firmware_bridge.extras import installed, remedy_of
from firmware_bridge.units import Nanoseconds, to_seconds

TURNING: Final = frozenset(
    {
        *("encoder_cable_off", "encoder_cut", "encoder_frozen", "encoder_swapped", "encoder_counts_lost"),
        *("motor_cable_off", "motor_leads_swapped", "shaft_blocked", "load_lifted", "index_missing"),
    }
)
"""Kinds that no one notices while the motor stands."""
STANDSTILL_RAD_S: Final = 1.0
"""Limit of a standstill at the motor's shaft."""


def failure_text(rig: VirtualRig, test: str, folder: Path, again: str, *, pictures: bool) -> str:
    """Keep a rig's recording and pictures in a folder, and say what a person wants to know first.

    `again` is the line that runs the test again.
    """
    return "\n".join(_lines(rig, test, folder, again, pictures=pictures))


def _lines(rig: VirtualRig, test: str, folder: Path, again: str, *, pictures: bool) -> Iterator[str]:
    yield f"{rig.robot.name}, seed {rig.seed}, at {rig.now:.2f} s of virtual time"
    events = [event for event in rig.interlock_history if event.ended is None or event.ended > rig.began]
    yield f"interlocks since it was armed at {to_seconds(rig.began):.2f} s:{'' if events else ' none'}"
    yield from (f"  {_span(event.began, event.ended)}  {event.name}: {event.reason}" for event in events)
    if rig.faults:
        yield "faults:"
        for fault in rig.faults:
            yield f"  {_span(fault.began, fault.ended)}  {_wrong(fault)}{_hidden(rig, fault)}"
    yield "operator:"
    entries = [entry for entry in rig.operator.diary if entry.at >= rig.began]
    yield from (f"  {to_seconds(entry.at):6.2f} s  {entry.kind}: {entry.text}" for entry in entries)
    try:
        drawn = pictures and installed("plots")
        kept = [*rig.recording.keep(folder), *(_drawn(rig, test, folder) if drawn else ())]
    except OSError as error:
        yield f"kept: nothing, {folder} cannot be written: {error}"
    else:
        yield f"kept in {folder}: {', '.join(path.name for path in kept)}"
        if pictures and not drawn:
            yield f"no pictures: {remedy_of('plots')}"
    yield f"again: {again}"


def _drawn(rig: VirtualRig, test: str, folder: Path) -> list[Path]:
    # Half a second for Matplotlib, which no test needs that is green.
    from emulators.bench.plots import draw  # noqa: PLC0415 - see above

    title = f"{rig.robot.name} · {test} · seed {rig.seed}"
    shown, more = rig.bench_setup.panels, rig.bench_setup.pictures
    return draw(
        folder,
        title,
        rig.robot,
        shown,
        rig.bench.samples,
        events=rig.interlock_history,
        faults=rig.faults,
        more=more,
    )


def _span(began: Nanoseconds, ended: Nanoseconds | None) -> str:
    until = "      on" if ended is None else f"{to_seconds(ended):6.2f} s"
    return f"{to_seconds(began):6.2f} s to {until}"


def _wrong(fault: FaultRecord) -> str:
    titled = f": {fault.title}" if fault.title else ""
    return f"{fault.kind} ({', '.join(fault.nodes)}){titled}"


def _hidden(rig: VirtualRig, fault: FaultRecord) -> str:
    """Return a remark on a fault that acts on a turning motor, if none of its motors has turned since."""
    columns = [motor_speed(node) for node in fault.nodes if rig.bench.samples.has(motor_speed(node))]
    if fault.kind not in TURNING or not columns:
        return ""
    ended = rig.bench.world.now if fault.ended is None else fault.ended
    rows = [row for row in rig.bench.samples if fault.began <= row.at <= ended]
    if any(abs(row[name]) > STANDSTILL_RAD_S for row in rows for name in columns):
        return ""
    return "; it could not show: its motor stood all that time"
