"""A kind of robot is read without MAVLink's messages, which take half a second to load."""

import subprocess
import sys


def test_a_kind_loads_without_pymavlink() -> None:
    look = "import sys, firmware_bridge.robots.rars; print('pymavlink' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", look], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
