"""The pages of `docs/` that are made from the tables, so that they agree with the code."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from emulators.bench.faults import CABLE_ORDER, KINDS
from emulators.documents import fidelity, object_table
from emulators.epos2.control.power_states import TRANSITIONS
from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.pilot.keyboard import HELP as KEYS
from validation.pages import (
    board_fidelity,
    capture_fidelity,
    emergencies,
    faults,
    message_page,
    safety,
    serial_commands,
    state_diagram,
    stations,
)
from validation.pages.safety_texts import (
    AGE_TEXT,
    AXIS_TEXT,
    BELIEF_TEXT,
    SAFETY_TEXT,
    guard_text,
    power_text,
    stops_text,
    watchdog_text,
)

MADE: Final = "This page is made by `make docs` from the tables in the code; change those."
OBJECTS_TEXT: Final = """{objects} objects under {indexes} indexes, as a 70/10 has them; the other types
differ in identity and current limits, and where a row of `wire.epos2.differences` says so. `receive` and
`transmit` say which PDOs may carry an object; `kept` says whether 'save' (0x1010) stores it; an empty bound
is the type's own. To the serial number (0x1018:04, 0x2004, 0x2FFF) each emulated drive adds its node: no
two have the same. How far each is known stands in [fidelity](fidelity.md). The same as JSON:
`firmware-bridge epos2 objects --json`."""
FIDELITY_TEXT: Final = """* **Proven**: from maxon's EDS of the 70/10, or recorded from a device.
* **Documented**: from a document on the EPOS2, from maxon's command library, or from the standard that the
  device claims.
* **By analogy**: from a document on a sister device.
* **Assumed**: nothing was found; a choice that may change.

Where a choice can be changed, it is a field of the device profile. The object table is proven for the 70/10;
that the other types have the same is by analogy."""
EMERGENCIES_TEXT: Final = """An emergency message carries the code (two bytes, low byte first), the error
register 0x1001 and five zeros. What it does depends on where the [power machine](power-machine.md) is:

* Not enabled: {disabled}. The power stage, which may be on in Measure init, goes off at once; the drive goes
  to Fault by transitions 13 and 14.
* Enabled: {enabled}. The drive goes to Fault by transitions 17 and 18, ramp in between.
* In Fault, and on the way there, another emergency is told and kept in the history; one that switches off at
  once cuts a ramp short. Fault is left only when no cause stands.
* Stopped, in the sense of network management: nothing is sent; register and history keep it.

0x605E = -1 tells a ramped error only, 0 switches off, 1 ramps with 0x6084, 2 with 0x6085. After the last
error is gone a message with code 0 is sent. A test is named here when it reaches the emergency in the
emulation."""
MACHINE_TEXT: Final = """CiA 402's machine with maxon's states Refresh and Measure init, the same in all types
({types}). The numbers are those of the firmware specification; the words in the boxes are the statusword's,
without the bits that each mode or the network sets."""
MACHINE_END: Final = """A command is completed, ramp included, before the next one is looked at. Quick stop
active is left by disable voltage (12), enable operation (16) or a fault (17), and never by itself."""


OPCODES_TEXT: Final = """The same commands go over both lines; V1 is RS232, V2 is USB. Numbers go low byte
first, and a frame carries whole words. An answer has the opcode 0x00 and begins with an error code, 0 or one
of the abort codes of SDO; it has its whole layout also on error, the rest being zeros.

* **V1**: `opcode`, `words - 1`, data, check sum. The host sends the opcode and waits for `O` (0x4F; `F`,
  0x46, for an unknown one), sends the rest and waits again (`F` for a wrong check sum), then answers the 0x00
  of the answer, and its rest, with `O`.
* **V2**: `0x90 0x02`, `opcode`, `words`, data, check sum; each 0x90 behind the first is doubled.
* **Check sum**: CRC-CCITT (0x1021, from 0) over 16-bit words, high byte first; the first word is
  `opcode << 8 | words - 1` in V1, `words << 8 | opcode` in V2. It goes low byte first.
* **Silence**: half a frame is forgotten after 0x2005 (V1) or 0x2006 (V2), by default 500 ms; in V2 the next
  `0x90 0x02` ends it, too.
* **Gateway**: node 0, or the drive's own number, means the drive on the line. Any other goes onto the CAN
  bus; a node that does not answer there is error 0x05040000. A segment then carries 7 bytes, else up to 63.

`firmware-bridge epos2 read --serial DEVICE` speaks both. A test is named here when it sends the command to
the emulated drive, or has it refused there."""

FAULTS_TEXT: Final = """A mission names what shall go wrong, beside its steps:

```toml
[[fault]]
kind = "frame_loss"
title = "a loose contact at one drive"
at_s = 6.0
for_s = 0.4             # or until_s = 6.4; with neither it stays to the end
node = 3                # the node's number, or the axis' name in quotes
share = 0.3
```

`firmware-bridge bench rars --mission faults` shows most of them. A fault begins at `at_s` and ends at
`until_s`, or after `for_s`; one that is an instant has no end. The summary tells which faults were on, the
pictures shade them. Chance comes from the run's seed, from a stream of each fault's own. Of two faults that
act on the same thing of the same node one must end before the other begins. From Python:

```python
from emulators.bench.faults import read

rig.faults.plan([read({{"kind": "frame_loss", "at_s": 6.0, "for_s": 0.4, "node": 3}})])
```

{kinds} kinds; `EMCY` codes are explained [here](emergencies.md). Stations lie on the CAN cable in this order:
{cable} (ASSUME)."""


def pages(
    tests: emergencies.Tests, commands: serial_commands.Tests, measured: Mapping[str, Sequence[str]]
) -> Mapping[str, str]:
    """Return every page by its file name.

    `tests` has the tests that reach each emergency, `commands` those that go through each serial command,
    `measured` further measurements of a robot's safety.
    """
    return {
        "objects.md": _objects(),
        "fidelity.md": _fidelity(),
        "fidelity-arduino.md": _board_fidelity(),
        "fidelity-motion-capture.md": _page(*capture_fidelity.parts(table)),
        "emergencies.md": _emergencies(tests),
        "power-machine.md": _machine(),
        "opcodes.md": _opcodes(commands),
        "faults.md": _faults(),
        "safety.md": _safety(measured),
        "ground-stations.md": _stations(),
        "messages.md": _page("Messages, their causes and remedies", *message_page.parts(table)),
    }


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [_line(headings), _line(["---"] * len(headings)), *map(_line, rows)]
    return "\n".join(lines)


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _page(title: str, *parts: str) -> str:
    return "\n\n".join((f"# {title}", MADE, *parts)) + "\n"


def _objects() -> str:
    found = object_table.entries(EPOS2_70_10)
    indexes = len({entry.row.address.index for entry in found})
    return _page(
        "The objects of the emulated EPOS2",
        OBJECTS_TEXT.format(objects=len(found), indexes=indexes),
        table(object_table.HEADINGS, (entry.cells() for entry in found)),
    )


def _fidelity() -> str:
    counts, order = fidelity.counted(), fidelity.ORDER
    summary = (
        (part, *(str(found[known] or "") for known in order), str(found.total()))
        for part, found in counts.items()
    )
    parts = [
        FIDELITY_TEXT,
        "## In numbers",
        table(("part", *(known.value for known in order), "all"), summary),
    ]
    for part in counts:
        rows = [line for line in fidelity.ledger() if line.part == part]
        shown = [line for line in rows if line.provenance is not order[0]]
        if not shown:
            continue
        parts.append(f"## {part.capitalize()}")
        if len(shown) < len(rows):
            parts.append(f"{len(rows) - len(shown)} are proven; the others:")
        lines = ((line.what, line.provenance.value, line.source) for line in shown)
        parts.append(table(("what", "known", "from"), lines))
    return _page("How far the emulated EPOS2 is known", *parts)


def _board_fidelity() -> str:
    return _page(
        "How far the emulated Arduino board is known",
        board_fidelity.TEXT,
        "## Commands",
        table(("protocol", "command", "assumed"), board_fidelity.commands()),
        "## Stated assumptions",
        table(("what", "where"), board_fidelity.assumptions(board_fidelity.BOARD)),
        "## Faults",
        board_fidelity.FAULTS_TEXT,
        table(("fault", "what it is"), board_fidelity.faults()),
    )


def _emergencies(tests: emergencies.Tests) -> str:
    disabled = ", ".join(state_diagram.title(state) for state in emergencies.states_not_enabled())
    enabled = ", ".join(state_diagram.title(state) for state in emergencies.states_enabled())
    return _page(
        "Emergencies against states",
        EMERGENCIES_TEXT.format(disabled=disabled, enabled=enabled),
        table(emergencies.HEADINGS, emergencies.table(tests)),
    )


def _machine() -> str:
    return _page(
        "The power machine",
        MACHINE_TEXT.format(types=", ".join(PROFILES)),
        f"```mermaid\n{state_diagram.diagram()}\n```",
        table(state_diagram.HEADINGS, (state_diagram.cells(row) for row in TRANSITIONS)),
        MACHINE_END,
    )


def _opcodes(commands: serial_commands.Tests) -> str:
    rows = table(serial_commands.HEADINGS, serial_commands.table(commands))
    return _page("The serial protocols, command by command", OPCODES_TEXT, rows)


def _faults() -> str:
    parts = [FAULTS_TEXT.format(kinds=len(KINDS), cable=CABLE_ORDER)]
    for kind, keys in faults.sections():
        parts.append(f"## `{kind.name}`")
        parts.append(f"{kind.happens}")
        parts.append(f"* **Device**: {kind.does}\n* **Meets**: {faults.target(kind)}.")
        if keys:
            parts.append(table(faults.HEADINGS, keys))
    return _page("Faults that a mission can name", *parts)


def _safety(measured: Mapping[str, Sequence[str]]) -> str:
    parts = [SAFETY_TEXT, "## Every axis", AXIS_TEXT, table(safety.AXIS_HEADINGS, safety.axis_rows())]
    parts += ["## How old a word is", AGE_TEXT, table(safety.AGE_HEADINGS, safety.ages())]
    for kind, robot in safety.shipped():
        parts += [
            f"## {robot.title}",
            *filter(None, (watchdog_text(robot),)),
            f"### What stops `{robot.name}`",
            table(safety.HEADINGS, safety.interlocks(kind, robot)),
            "### What limits a command",
            table(safety.LIMIT_HEADINGS, safety.limits(kind, robot)),
            "### How far its axes are believed",
            BELIEF_TEXT,
            table(safety.PLAUSIBILITY_HEADINGS, safety.plausibility_rows(robot)),
            "### What becomes of its power",
            power_text(robot),
            table(safety.UNPOWERED_HEADINGS, safety.unpowered(robot)),
            "### What its guard lets pass",
            guard_text(robot),
            table(safety.BOUND_HEADINGS, safety.bounds(robot)),
        ]
        for headings, rows in (
            (safety.SUM_HEADINGS, safety.guarded_sums(robot)),
            (safety.EXCLUSIVE_HEADINGS, safety.exclusive(robot)),
        ):
            found = tuple(rows)
            if found:
                parts.append(table(headings, found))
        parts += ["### In which steps its axes are stopped", stops_text(robot)]
        for reached in safety.reached(robot):
            for link in reached.links:
                parts.append(f"Link `{link}`, {safety.spoken(reached, link)}:")
                if reached.axes_on(link):
                    parts.append(table(safety.STOP_HEADINGS, safety.stops(reached, link)))
                    parts.append(safety.sums_of_stops(reached, link))
        parts += measured.get(robot.name, ())
    return _page("What holds a robot back", *parts)


STICK_TEXT: Final = """What the axes of MANUAL_CONTROL do where they are positive, and its buttons. x,
y and r are neutral at 0. An axis with a dash is not read, wherever it stands, which is told once. z, a
throttle, rests at 0 or at 500: it counts from where it stood when its button was pressed. Before arming all
that is read must be neutral; the refusal names the axis and its value. An axis that is not used any more
(0x7FFF) is neutral at once.

`firmware-bridge pilot` drives from the terminal, too: {keys}."""
STATIONS_TEXT: Final = """Any MAVLink station drives: by MANUAL_CONTROL, by RC_CHANNELS_OVERRIDE, or by
SET_POSITION_TARGET_LOCAL_NED. All of them pass through the same permission, the same rule of silence, the
same limits of age and the same interlocks ([what holds a robot back](safety.md), [station in
control](decisions/station-in-control.md)). A station is answered in the version of MAVLink that it speaks;
MAVLink 1 has no numbers above 255 and no signatures."""
WAYS_TEXT: Final = """Without an order the newest word counts, whichever kind it is of. **Guided** by an order
(`DO_SET_MODE`, `SET_MODE`): a stick that is let go does not count while set-points come; one that is moved
takes over. **Hold** stops at the ramp and waits; Manual or Guided goes on, with everything let go. The
numbers are those of ArduPilot's Rover; a station that asks in PX4's is told in PX4's.
[Why](decisions/mavlink-modes.md)."""
RC_TEXT: Final = """1500 us is let go, 1000 and 2000 are full; 0 gives a channel back, 65535 leaves it as it
is (from channel 9 on: 65534, and 0 or 65535). A channel of which no message speaks for the time that silence
may last is given back. Below 900 us a receiver has lost its transmitter: that moves nothing, and is no sign
of life. A robot's station may have other rows (`channels`)."""
MASKS_TEXT: Final = """A velocity, with or without yaw rate, in the body frames 8, 9 and 12: masks 1511, 3559,
1479 (MAVSDK, MAVROS with `mav_frame: BODY_NED`) and 4039 (DroneKit). A robot that can go any way follows
frames 1 and 7, too, by its own heading. A velocity of zero stops in each of these frames, whatever heading
stands beside it. Places, headings and accelerations are refused in words, as are SET_ATTITUDE_TARGET,
SET_POSITION_TARGET_GLOBAL_INT and SET_ACTUATOR_CONTROL_TARGET: at once, and then more and more seldom."""
NARROW_TEXT: Final = """`drive --bandwidth 57600`, or `bandwidth_bit_s` under `[operator]` in the robot file,
says what the link carries, ten bits a byte. Telemetry takes at most half of it: {full:.0f} B/s on a network,
{slow:.0f} B/s at 57,600; on narrower links all but the heartbeat waits longer. Each station may ask for
intervals of its own (SET_MESSAGE_INTERVAL), one that does not drive for none shorter than these. Arming,
landed state and mode are told at once when they change."""
LACKING_TEXT: Final = "Refused at once by the protocol's own means, since the bridge has none of it: {names}."
STOP_TEXT: Final = """* **QGroundControl** takes the robot for a generic rover. It shows modes by name and
  arms; it cannot set modes of a generic autopilot. While the robot is armed its action *Emergency stop* is on
  the screen: it sends a forced disarm, which brakes first and takes the power at rest. Of a station that only
  watches it is an emergency stop, which brakes and can be cleared. Armed counts as *in the air*, as on rovers
  of PX4: the action is shown for nothing else. A stop button of your own is a file in QGroundControl's folder
  `MavlinkActions`, chosen under *Application settings, Fly view*:

```json
{"version": 1, "fileType": "MavlinkActions", "actions": [
  {"label": "Stop", "description": "Brake, and stay until cleared", "mavCmd": 5300, "param1": 0},
  {"label": "Clear", "description": "Let go of the stop", "mavCmd": 5300, "param1": 1}]}
```

* **MAVSDK**: `action.arm`, `manual_control`, `offboard.set_velocity_body` and `start`, `action.hold`,
  `action.disarm`, `action.kill` (brakes first). `offboard` goes on after a hold, and begins
  after arming, with a set-point of zero: one is enough. `mavsdk_server` repeats the last set-point of a
  script that has died: run it under something that ends it with the script.
* **pymavlink, MAVProxy, DroneKit**: modes `MANUAL`, `GUIDED`, `HOLD`; `rc` overrides.
* **MAVROS**: `setpoint_velocity` with `mav_frame: BODY_NED`, `setpoint_raw`, `manual_control`, and
  `rc/override`."""
COMMANDS_TEXT: Final = (
    "\\* From a station without control: requests and stops; all else is refused by a text."
)


def _stations() -> str:
    full, slow = stations.loads()
    return _page(
        "Ground stations",
        STATIONS_TEXT,
        "## Stations by name",
        STOP_TEXT,
        "## Modes",
        WAYS_TEXT,
        table(stations.MODE_HEADINGS, stations.modes()),
        "## Sticks",
        STICK_TEXT.format(keys=KEYS),
        table(stations.STICK_HEADINGS, stations.sticks()),
        "## Radio channels",
        RC_TEXT,
        table(stations.CHANNEL_HEADINGS, stations.channels()),
        "## Set-points",
        MASKS_TEXT,
        "## Texts",
        NARROW_TEXT.format(full=full, slow=slow),
        table(stations.STREAM_HEADINGS, stations.streams()),
        "## Commands",
        table(stations.COMMAND_HEADINGS, stations.commands()),
        COMMANDS_TEXT,
        "## What there is not",
        LACKING_TEXT.format(names=stations.lacking()),
    )
