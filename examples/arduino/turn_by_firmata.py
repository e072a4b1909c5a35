"""Turn the motor at M1 by pyFirmata2: the shield's registers over I2C, its counts by the encoder's messages.

Usage: python turn_by_firmata.py PORT [COUNTS]

For a board with ConfigurableFirmata. Without a board:

    firmware-bridge emulate board --firmware firmata --encoders 2 --serial-link board.tty
"""

import sys

import pyfirmata2

SHIELD = 0x60
I2C_REQUEST, I2C_CONFIG, ENCODER = 0x76, 0x78, 0x61
WRITE = 0x00
ATTACH, READ = 0, 1
PINS = (2, 3)
"""Pins of the first encoder."""
MODE1, AUTO_INCREMENT = 0x00, 0x21
"""Awake, registers one after the other, and the address for all chips."""
PWM, IN2, IN1 = 8, 9, 10
"""Outputs of the chip that drive M1."""
ON, OFF = (0x00, 0x10, 0x00, 0x00), (0x00, 0x00, 0x00, 0x10)
"""An output that is always high, or always low."""
HALF = (0x00, 0x00, 0x00, 0x08)
"""2048 of 4096 parts high."""
FORWARD = {PWM: HALF, IN2: OFF, IN1: ON}
RELEASE = {IN1: OFF, IN2: OFF}


class Wheel:
    """A motor and its encoder."""

    def __init__(self, port: str) -> None:
        self.board = pyfirmata2.ArduinoMega(port, timeout=10)
        self._counts: list[int] = []
        self.board.add_cmd_handler(ENCODER, self._take)
        self.board.send_sysex(I2C_CONFIG, [0, 0])
        self.board.send_sysex(ENCODER, [ATTACH, 0, *PINS])
        self._writes(MODE1, AUTO_INCREMENT)

    def outputs(self, levels: dict[int, tuple[int, ...]]) -> None:
        """Bring outputs of the chip to their levels."""
        for output, level in levels.items():
            self._writes(6 + 4 * output, *level)

    def count(self) -> int:
        """Request the encoder's counts."""
        self._counts.clear()
        self.board.send_sysex(ENCODER, [READ, 0])
        while not self._counts:
            self.board.iterate()
        return self._counts[-1]

    def _writes(self, *data: int) -> None:
        halves = [half for byte in data for half in (byte & 0x7F, byte >> 7)]
        self.board.send_sysex(I2C_REQUEST, [SHIELD, WRITE, *halves])

    def _take(self, *data: int) -> None:
        size = sum(byte << 7 * place for place, byte in enumerate(data[1:5]))
        self._counts.append(-size if data[0] & 0x40 else size)


def main(port: str, counts: int = 500) -> None:
    """Turn until so many counts have come, and let the motor go, whatever ends the program."""
    wheel = Wheel(port)
    try:
        wheel.outputs(FORWARD)
        while wheel.count() < counts:
            pass
    finally:
        wheel.outputs(RELEASE)
    print(wheel.count())
    wheel.board.exit()


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], *(int(word) for word in sys.argv[2:3]))
