"""How it comes to be known where an axis stands: `[axes.zero]` in a robot file."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field, field_validator

from firmware_bridge.robot.table import Table


class ZeroFrom(StrEnum):
    """Who gives an axis its zero."""

    CONFIRM = "confirm"
    """Whoever drives looks where it stands, and says so; before, and after each restart of its drive."""
    AT_POWER_ON = "at power-on"
    """It is 0 where its drive was switched on; only where a wrong zero does no harm, as with wheels."""


class Zero(Table):
    """Where an axis has its zero from; without it an axis with `travel` is confirmed, others need nothing."""

    how: Annotated[ZeroFrom | None, Field(strict=False)] = None

    @field_validator("how", mode="before")
    @classmethod
    def _homes_nothing(cls, how: object) -> object:
        if how == "home":
            raise ValueError("the bridge homes no axis; say 'confirm', and tell it where the axis stands")
        return how
