"""Guesses in the emulated Arduino board: from its protocols' rows, and its modules' texts."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import emulators
from emulators.epos2.documents.fidelity import stated
from firmware_bridge.families.motor_shield.wire import arduinoio, mw, ros_arduino_bridge

TEXT: Final = """Registers, libraries and protocols follow their sources, which the modules
name: data sheets, the Arduino core, libraries and sketches. None of it was recorded from a board. The sketch
for a real board, built by avr-gcc and run by simavr, sends the same bytes on serial and on I2C as
ros_arduino_bridge here (`pytest -m avr`). For the items on this page no source was found; they are
assumptions that may change."""

_ROOT: Final = Path(emulators.__file__).parent
BOARD: Final = "arduino_omni"


def commands() -> Iterator[tuple[str, str, str]]:
    """Yield protocol, command and guess, for each row that has one."""
    for row in mw.ROWS:
        if row.assumed:
            yield "MWProtocol", row.name, row.assumed
    for other in ros_arduino_bridge.ROWS:
        if other.assumed:
            yield "ros_arduino_bridge", f"{other.letter}, {other.name}", other.assumed
    for each in arduinoio.ROWS:
        if each.assumed:
            yield "ArduinoIO", f"{each.letter}, {each.name}", each.assumed


def assumptions(folder: str) -> Iterator[tuple[str, str]]:
    """Yield each assumption that a module of a device states, and where."""
    for path in sorted((_ROOT / folder).rglob("*.py")):
        for what in stated(path.read_text(encoding="utf-8")):
            yield what, path.relative_to(_ROOT.parent).as_posix()
