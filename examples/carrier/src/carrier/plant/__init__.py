"""The robot's plant: two driven wheels, two castors."""

from carrier.plant.parameters import PLANT

__all__ = ["PLANT"]
