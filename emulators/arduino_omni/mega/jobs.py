"""Timed actions of a sketch, one after the other: a list, so that it can stop anywhere."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from emulators.arduino_omni.shield.i2c import Transfer, TransferResult
from firmware_bridge.units import Nanoseconds


@dataclass(frozen=True, slots=True)
class OnBus:
    """A transfer on the I2C bus; `then` gets its result."""

    transfer: Transfer
    then: Callable[[TransferResult, Nanoseconds], None] | None = None


@dataclass(frozen=True, slots=True)
class Delay:
    """delay(), or whatever else keeps the processor."""

    duration: Nanoseconds


@dataclass(frozen=True, slots=True)
class Say:
    """Serial.write(): it returns when the last byte has found room in the transmit ring."""

    data: bytes


@dataclass(frozen=True, slots=True)
class Call:
    """Action that takes no time, after the jobs before it."""

    action: Callable[[Nanoseconds], None]


Job: TypeAlias = OnBus | Delay | Say | Call
