"""The tables in the file of every robot with two driven wheels on one axle; a package may add to them."""

from typing import Self

from pydantic import model_validator

from firmware_bridge.motion.tables import DifferentialBase
from firmware_bridge.robot.table import Positive, Table


class Limits(Table):
    """The limits that the interlocks enforce, whatever the operator commands."""

    speed_mps: Positive
    acceleration_mps2: Positive
    turn_rate_rad_s: Positive
    turn_acceleration_rad_s2: Positive
    sideways_mps2: Positive
    """Speed times turn rate: what load and tires stand."""


class Geometry(Table):
    """The base and its limits."""

    base: DifferentialBase
    limits: Limits

    @model_validator(mode="after")
    def _fits_between_its_wheels(self) -> Self:
        radius, track = self.base.wheel_radius_m, self.base.track_m
        if radius >= track:
            raise ValueError(
                f"wheel_radius_m = {radius:g} is not below track_m = {track:g}: both are in meters"
            )
        return self
