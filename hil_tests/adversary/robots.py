"""Robots by the words that `firmware-bridge bench` is told: `rome --protocol mw --encoders 3`."""

import argparse

from firmware_bridge.drivers.epos2.serial.fleet import over_serial
from firmware_bridge.drivers.shield.fleet import measured, over_protocol
from firmware_bridge.kinds import find
from firmware_bridge.robot import AnyRobot


def options(words: argparse.ArgumentParser) -> None:
    """Add what names a robot."""
    words.add_argument("robot")
    words.add_argument("--serial", choices=["v2"], help="the bridge on the first drive's serial port")
    words.add_argument("--protocol", help="the firmware on its board")
    words.add_argument("--encoders", type=int, help="how many that reads")


def robot_of(told: argparse.Namespace) -> AnyRobot:
    """Return the robot that is meant; RobotFileError."""
    found = over_serial(find(told.robot)) if told.serial else find(told.robot)
    return measured(over_protocol(found, told.protocol, told.encoders))


def line_of(told: argparse.Namespace) -> str:
    """Return the words for it."""
    options = {"serial": told.serial, "protocol": told.protocol, "encoders": told.encoders}
    return " ".join(
        [told.robot, *(f"--{key} {value}" for key, value in options.items() if value is not None)]
    )


def read(line: str) -> argparse.Namespace:
    """Read words; those behind them are left out."""
    words = argparse.ArgumentParser()
    options(words)
    return words.parse_known_args(line.split())[0]
