"""The bridge between the operator's link and the drives' bus: one node, and the pipeline of its cycles."""

from firmware_bridge.bridge.bridge import Bridge, Phase

__all__ = ["Bridge", "Phase"]
