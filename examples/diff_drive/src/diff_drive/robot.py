"""Two driven wheels on one axle, and a lamp: what the robot is, and its rows on MAVLink.

Full stick is the speed limit and the turn rate's; with `r` unused `y` turns.
Buttons: 0 lamp, 2 emergency stop.
"""

from dataclasses import replace
from typing import Final

from firmware_bridge.differential.geometry import Geometry
from firmware_bridge.differential.robot import DifferentialRobot
from firmware_bridge.teleop.station import StationRows, Switch

from diff_drive.motion import Motion, State

ROBOT: Final[DifferentialRobot[Geometry, Motion, State]] = DifferentialRobot(
    Motion, lambda _robot, speed_mps, turn_rad_s, _sensors: State(speed_mps, turn_rad_s)
)

STATION: Final[StationRows[Geometry, Motion, State]] = StationRows(
    stick=ROBOT.stick,
    target=ROBOT.target,
    twist=ROBOT.twist,
    # A stick is sent again and again: nothing of a command has to be forgotten.
    forgotten=lambda command: command,
    largest=ROBOT.largest,
    meters_rolled=ROBOT.meters_rolled,
    stop_button=2,
    switches=(
        Switch(
            "lamp",
            read=lambda command: command.lamp,
            write=lambda command, on: replace(command, lamp=on),
            relay=0,
            button=0,
            telemetry="LAMP",
        ),
    ),
    values=(ROBOT.turn_value,),
    parameters=ROBOT.parameters,
)
