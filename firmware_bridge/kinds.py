"""`firmware_bridge.robot_types` under its name of the release before."""

from firmware_bridge import renamed

__getattr__ = renamed.module(
    __name__, "firmware_bridge.robot_types", kind_of="robot_type_of", kind_named="robot_type_named"
)
