"""The robot's plant: two driven wheels, two castors."""

from diff_drive.plant.parameters import PLANT

__all__ = ["PLANT"]
