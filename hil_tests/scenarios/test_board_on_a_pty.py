"""`emulate board` and a client with pyserial, two programs on one line: a wheel turns and is read."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import pytest

from firmware_bridge.runtime.clock import Clock
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import HUNG_S

PROGRAM: Final = Path(sys.executable).with_name("firmware-bridge")
WITHIN: Final = 30 * SECOND
"""A loaded machine takes its time; nothing here is measured."""

# What a third party would write, in pyserial and bytes: programs of their own, which end with what was read.
ROS: Final = """
import serial, sys, time
line = serial.Serial(sys.argv[1], 57600, timeout=0.3)
def ask(text):
    line.write(text + b"\\r")
    return line.readline().strip()
time.sleep(2)  # a byte earlier would keep the boot loader
while ask(b"b") != b"57600":
    time.sleep(10)
line.timeout = 20  # a busy machine
assert ask(b"m 20 0 -20") == b"OK"
for _ in range(200):
    counts = [int(it) for it in ask(b"e").split()]
    if counts[0] > 100 and counts[2] < -100:
        break
    time.sleep(0.05)
assert ask(b"m 0 0 0") == b"OK"
print(*counts)
"""
MW: Final = """
import serial, struct, sys, time
line = serial.Serial(sys.argv[1], 115200, timeout=0.3)
def ask(text):
    line.write(bytes.fromhex(text))
    head = line.read(4)
    return line.read(head[3] + 1)[1:-1] if head[:2] == bytes.fromhex("A5 00") else b""
time.sleep(2)
line.reset_input_buffer()
while not ask("5A 03 00 00 01 FC"):  # who is there?
    time.sleep(10)
ask("5A 08 00 81 02 00 00 60 40 06 CF")  # a shield
ask("5A 06 00 82 02 02 00 00 74")  # motor 1
ask("5A 07 00 86 03 01 00 02 03 6A")  # encoder 0 on pins 2 and 3
ask("5A 08 00 83 02 03 00 00 7F 01 F0")  # 127 forwards
line.timeout = 20  # a busy machine
for _ in range(200):
    count, at, wraps = struct.unpack("<iIb", ask("5A 06 00 87 03 04 00 00 6C"))
    if count > 100:
        break
    time.sleep(0.05)
line.timeout = 0.3
ask("5A 06 00 85 02 04 00 00 6F")  # released
print(count, 0, -count)
"""


@contextmanager
def emulated(link: Path, *words: str) -> Iterator["subprocess.Popen[str]"]:
    process = subprocess.Popen(
        [PROGRAM, "emulate", "board", *words, "--serial", "pty", "--serial-link", link],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )
    try:
        clock = Clock()
        while not link.is_symlink():
            assert process.poll() is None, "it has ended"
            assert clock.now() < WITHIN, "no line came"
            clock.wait([], clock.now() + 20 * MILLISECOND)
        yield process
    finally:
        process.kill()
        process.communicate()


@pytest.mark.long(keeps=["ros-arduino-bridge-client0"])
@pytest.mark.timeout(120)
@pytest.mark.parametrize(("firmware", "client"), [("ros-arduino-bridge", ROS), ("mw", MW)])
def test_a_client_drives_a_wheel_and_reads_its_encoder(firmware: str, client: str, tmp_path: Path) -> None:
    link = tmp_path / "board.tty"
    with emulated(link, "--firmware", firmware, "--record", str(tmp_path)) as board:
        script = [sys.executable, "-c", client, str(link)]
        done = subprocess.run(script, capture_output=True, text=True, timeout=HUNG_S, check=False)
        assert done.returncode == 0, done.stderr
        one, two, three = (int(it) for it in done.stdout.split())
        assert one > 100
        assert two == 0
        assert three < -100
        board.send_signal(signal.SIGINT)
        stated, _ = board.communicate(timeout=HUNG_S)
        assert board.returncode == 0, stated
    assert not link.is_symlink()
    (log,) = tmp_path.glob("*/serial.log")
    assert f" board~{firmware} R " in log.read_text(encoding="utf-8")
