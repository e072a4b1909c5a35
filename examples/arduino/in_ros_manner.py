"""Drive three wheels as ROS's base controller does: ten times a second speeds, and counts read between.

Usage: python in_ros_manner.py PORT [TICKS] [SECONDS]

For a board with the ros_arduino_bridge sketch, extended to three wheels; TICKS are an encoder's in a
thirtieth of a second. Nothing but pyserial is needed. Without a board:

    firmware-bridge emulate board --firmware ros-arduino-bridge --encoders 3 --serial-link board.tty
"""

import sys
import time

import serial

BAUD = 57600
WHEELS = 3
EVERY_S = 0.1
BOOTS_S = 2.0
"""Time after opening: it resets a board, and a byte in the first second keeps its boot loader for 9 s."""
PATIENCE_S = 10.0


class Board:
    """Board that answers each request with a line."""

    def __init__(self, port: str) -> None:
        self._line = serial.Serial(port, BAUD, timeout=0.5)

    def request(self, command: str) -> str:
        """Send a command; return the line that comes."""
        self._line.write(f"{command}\r".encode())
        return self._line.readline().decode("ascii", "replace").strip()

    def comes(self) -> None:
        """Wait until the board answers with its baud rate."""
        time.sleep(BOOTS_S)
        until = time.monotonic() + PATIENCE_S
        while self.request("b") != str(BAUD):
            self._line.reset_input_buffer()
            if time.monotonic() > until:
                sys.exit(f"no board that speaks ros_arduino_bridge on {self._line.port}")
        self._line.timeout = PATIENCE_S


def main(port: str, ticks: int = 15, seconds: float = 2.0) -> None:
    """Turn all wheels for so long, and stop them, whatever ends the program."""
    board = Board(port)
    board.comes()
    board.request("r")
    stands = " ".join(["0"] * WHEELS)
    try:
        for _ in range(round(seconds / EVERY_S)):
            stated = board.request("m " + " ".join([str(ticks)] * WHEELS))
            if stated != "OK":
                sys.exit(f"the board does not take three speeds; it answers {stated!r}")
            print(board.request("e"))
            time.sleep(EVERY_S)
    finally:
        board.request(f"m {stands}")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], *(int(word) for word in sys.argv[2:3]), *(float(word) for word in sys.argv[3:4]))
