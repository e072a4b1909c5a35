"""`firmware_bridge.robot_type` under its name of the release before."""

from firmware_bridge import renamed

__getattr__ = renamed.module(
    __name__, "firmware_bridge.robot_type", Guide="PathFollower", Kind="RobotType", Mode="RobotMode"
)
