"""pyFirmata2 as it is, at the pty of an emulated board: it turns a wheel by the shield's registers."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyfirmata2
import pytest

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.shield.motor_shield import PORTS
from emulators.arduino_omni.shield.pca9685 import AI, ALLCALL, MODE1
from firmware_bridge.families.motor_shield.wire import firmata

PROGRAM = Path(sys.executable).with_name("firmware-bridge")
SHIELD = 0x60
WRITE, READ = 0x00, 0x08
FIRST_WHEEL = 0


@contextmanager
def emulated(link: Path, *words: str) -> Iterator[None]:
    """Run a board until the block is left; it is there once it has printed so."""
    stated = [str(PROGRAM), "emulate", "board", "--serial-link", str(link), *words]
    with subprocess.Popen(stated, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as running:
        assert running.stdout is not None
        assert b"Ctrl-C ends it" in running.stdout.readline()
        try:
            yield
        finally:
            running.terminate()


def pairs(*data: int) -> list[int]:
    return [half for byte in data for half in (byte & 0x7F, byte >> 7)]


class Client:
    """A user's program: the library, and the messages that it has received."""

    def __init__(self, port: Path) -> None:
        self.board = pyfirmata2.ArduinoMega(str(port), timeout=10)
        self._read: list[int] = []
        self._counts: list[int] = []
        self.board.add_cmd_handler(firmata.I2C_REPLY, self._take_registers)
        self.board.add_cmd_handler(firmata.ENCODER, self._take_count)

    def _take_registers(self, *data: int) -> None:
        self._read[:] = [low | high << 7 for low, high in zip(data[::2], data[1::2], strict=True)]

    def _take_count(self, *data: int) -> None:
        size = sum(byte << 7 * place for place, byte in enumerate(data[1:5]))
        self._counts.append(-size if data[0] & 0x40 else size)

    def write(self, data: bytes) -> None:
        self.board.send_sysex(firmata.I2C_REQUEST, [SHIELD, WRITE, *pairs(*data)])

    def register(self, number: int) -> int:
        self._read.clear()
        self.board.send_sysex(firmata.I2C_REQUEST, [SHIELD, READ, *pairs(number, 1)])
        while not self._read:
            self.board.iterate()
        return self._read[-1]

    def count(self) -> int:
        self._counts.clear()
        self.board.send_sysex(firmata.ENCODER, [1, FIRST_WHEEL])
        while not self._counts:
            self.board.iterate()
        return self._counts[-1]


@pytest.mark.long(beside="test_firmata_turns_a_motor_by_the_registers_and_reads_its_encoder")
def test_it_turns_a_wheel_forwards_and_back_and_stops_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pyfirmata2.pyfirmata2, "BOARD_SETUP_WAIT_TIME", 0)  # it awaits the board
    link = tmp_path / "board"
    with emulated(link, "--firmware", "firmata", "--encoders", "2", "--reset-on-open"):
        it = Client(link)
        while it.board.firmware is None:
            it.board.iterate()
        assert (it.board.firmware, it.board.get_firmata_version()) == ("ConfigurableFirmata.ino", (2, 5))
        it.board.send_sysex(firmata.I2C_CONFIG, [0, 0])
        it.board.send_sysex(firmata.ENCODER, [0, FIRST_WHEEL, 2, 3])
        assert it.register(MODE1) == 0x11  # as at power-on
        it.write(bytes((MODE1, AI | ALLCALL)))
        assert it.register(MODE1) == AI | ALLCALL
        it.write(library.set_speed(PORTS[0], 128))
        for data in library.run(PORTS[0], library.RunArgument.FORWARD):
            it.write(data)
        while it.count() < 500:
            pass
        for data in library.run(PORTS[0], library.RunArgument.BACKWARD):
            it.write(data)
        while it.count() > -500:
            pass
        for data in library.run(PORTS[0], library.RunArgument.RELEASE):
            it.write(data)
        before = it.count()
        while (now := it.count()) != before:
            before = now
        it.board.exit()
