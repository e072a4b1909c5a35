"""The kinds of incidents on a serial line, one row each: causes, consequence, and what to check first."""

from typing import Final

from firmware_bridge.explain.incident import IncidentKind

NO_ANSWERS: Final = IncidentKind(
    "line_silent",
    "the device no more answers",
    (
        "its cable or plug is out",
        "its program hangs, as on an I2C bus that is stuck, or it is held in reset",
        "its supply is out",
    ),
    "set-points do not reach it; without a watchdog of its own a motor keeps its last command",
    "cable, plug and supply lamp of the device; then its program",
)
CAME_BACK: Final = (
    "its cable or plug was out: it has not started again",
    "its program has waited, as for an I2C bus, an interrupt or a print",
)
"""Causes of a silence after which the device goes on."""
STARTED_AGAIN: Final = (
    "its supply was out, or dipped: it has started again",
    "it was reset: a reset button, DTR when a program opens the port, its watchdog",
    "its program hung until a reset, as on an I2C bus that is stuck or has no motor driver",
)
"""Causes of a silence that ends with a start of the device."""

LOST_ANSWER: Final = IncidentKind(
    "answer_lost",
    "a request was not answered",
    (
        "bytes were lost or disturbed on the line",
        "the device was busy, as with an I2C bus or an interrupt that waits",
        "its firmware does not know the request",
    ),
    "the request is sent again, or its values are missing for a cycle",
    "cable and ground of the line, its bit rate, and the load of the device",
)
LATE_ANSWER: Final = IncidentKind(
    "answer_late",
    "an answer is late",
    (
        "the device was busy",
        "the computer or its USB port was busy",
        "a latency timer of the serial adapter",
    ),
    "measured values are older than assumed",
    "the latency timer of the adapter, and what else the device does",
)
REBOOT: Final = IncidentKind(
    "line_restart",
    "the device has started again",
    (
        "its supply dipped: a long cable, a motor that starts",
        "its reset line was pulled: a reset button, DTR when a program opens the port",
        "its watchdog has reset it",
    ),
    "its motors are off, its counts begin at 0, and its set-up is lost",
    "the supply at the device under load, and which programs open the port",
)
GARBAGE: Final = IncidentKind(
    "line_garbage",
    "bytes that are no answer",
    (
        "a disturbance on the line: a long cable, a missing ground",
        "another bit rate",
        "a second program has the port open",
    ),
    "answers are damaged, and requests may be",
    "shield and ground of the cable, and the bit rate on both sides",
)
REFUSED: Final = IncidentKind(
    "line_refused",
    "the device refuses a request",
    (
        "the request was damaged on the line",
        "the firmware of the device does not know it",
    ),
    "the request has no effect",
    "the protocol and version of the firmware",
)
CHATTER: Final = IncidentKind(
    "line_chatter",
    "the device prints what answers no request",
    (
        "a debug print, or a report, that was left in its program",
        "another protocol than assumed",
        "an answer that comes after the request was given up",
    ),
    "it may be taken for an answer, and it takes time of the line",
    "the program of the device",
)
HOST_SILENT: Final = IncidentKind(
    "requests_stopped",
    "the controller sends no request",
    (
        "its program hangs, has ended, or was suspended",
        "its serial port is unplugged",
    ),
    "the device has no new set-point: by its watchdog it stops, or it keeps the last one",
    "the log of the controller's program",
)
NO_COUNTS: Final = IncidentKind(
    "not_turning",
    "a motor is commanded and its encoder does not count",
    (
        "the shaft is blocked, or the load too high",
        "the motor's cable is off, or its supply is out",
        "the encoder's cable is off",
    ),
    "the axis is not where the counts show it, or it does not move",
    "turn the shaft by hand and look at the counts; then the motor's cable and supply",
)
ALL_STOPPED: Final = IncidentKind(
    "no_motor_turns",
    "motors are commanded and no encoder counts",
    (
        "the motors' supply is out or low",
        "the motor driver is absent, or its bus (I2C) is stuck",
        "the robot is blocked",
    ),
    "the robot does not move",
    "the motors' supply, the plug of the motor driver, its lamp",
)
REVERSED: Final = IncidentKind(
    "turns_backwards",
    "an encoder counts against the command",
    (
        "the motor's leads are exchanged",
        "the encoder's channels are exchanged",
        "the load turns the motor",
    ),
    "a closed loop runs away; the robot goes where it should not",
    "leads and channels of the motor that was worked on last",
)
FEWER_COUNTS: Final = IncidentKind(
    "counts_fall_behind",
    "an encoder counts much less for its command than before",
    (
        "the motors' supply is low, or the load has grown",
        "the motor driver limits its current, or is hot",
        "counts of the encoder are lost",
    ),
    "the axis is slower than commanded",
    "the motors' supply under load, then the load; then the encoder's lines",
)
ONE_BEHIND: Final = (
    "the motor's cable is off, or has a bad contact",
    "its load has grown, or its shaft is blocked",
    "counts of its encoder are lost, or its coupling slips",
)
"""Causes where the other motors are as before."""
MORE_COUNTS: Final = IncidentKind(
    "counts_run_ahead",
    "an encoder counts much more for its command than before",
    (
        "the load is off: the wheel is off the floor",
        "the motors' supply is higher than before",
        "disturbances are counted",
    ),
    "counts do not show the movement of the robot",
    "whether the wheel has contact with the floor",
)
JUMP: Final = IncidentKind(
    "counts_jump",
    "counts of an encoder jump",
    (
        "an answer was damaged and is taken for a number",
        "the device has started again",
    ),
    "the position that is derived from it is wrong",
    "the line; a protocol without check sum cannot notice it",
)

LINE_KINDS: Final = (
    NO_ANSWERS,
    LOST_ANSWER,
    LATE_ANSWER,
    REBOOT,
    GARBAGE,
    REFUSED,
    CHATTER,
    HOST_SILENT,
    NO_COUNTS,
    ALL_STOPPED,
    REVERSED,
    FEWER_COUNTS,
    MORE_COUNTS,
    JUMP,
)
"""Every kind on a serial line, as the page of the command lists them."""
