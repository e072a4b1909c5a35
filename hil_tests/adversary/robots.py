"""Robots by the words of `firmware-bridge bench`: `rome --protocol mw --encoders 3`."""

import argparse

from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.motor_shield.driver.link_drivers import measured, over_protocol
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find


def options(words: argparse.ArgumentParser) -> None:
    """Add what names a robot."""
    words.add_argument("robot")
    words.add_argument("--serial", choices=["v2"], help="the bridge on the first drive's serial port")
    words.add_argument("--protocol", help="the firmware on its board")
    words.add_argument("--encoders", type=int, help="how many that reads")


def robot_of(reported: argparse.Namespace) -> AnyRobot:
    """Return the robot that is meant; RobotFileError."""
    found = over_serial(find(reported.robot)) if reported.serial else find(reported.robot)
    return measured(over_protocol(found, reported.protocol, reported.encoders))


def line_of(reported: argparse.Namespace) -> str:
    """Return the words for it."""
    options = {"serial": reported.serial, "protocol": reported.protocol, "encoders": reported.encoders}
    return " ".join(
        [reported.robot, *(f"--{key} {value}" for key, value in options.items() if value is not None)]
    )


def read(line: str) -> argparse.Namespace:
    """Read words; those behind them are left out."""
    words = argparse.ArgumentParser()
    options(words)
    return words.parse_known_args(line.split())[0]
