"""`firmware_bridge.differential.kinematics` under its name of the release before."""

from firmware_bridge import renamed

__getattr__ = renamed.module(
    __name__, "firmware_bridge.differential.kinematics", DifferentialBody="DifferentialKinematics"
)
