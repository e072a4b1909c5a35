"""The bridge between the operator's link and the drives' bus: one node, and the pipeline of its cycles."""

from firmware_bridge import renamed
from firmware_bridge.bridge.bridge import Bridge
from firmware_bridge.bridge.joint_state import Life

__all__ = ["Bridge", "Life"]

__getattr__ = renamed.module(__name__, __name__, Phase="Life")
