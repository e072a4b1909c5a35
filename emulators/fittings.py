"""Encoders and gears by name or order number, beside numbers: what is mounted at a motor.

Sources: encoders, maxon's Product Range 2025/26 and sensor list of 2018; `gears.csv`, maxon's shop pages of
October 2020: exact ratios, and inertias at the motor's shaft. Losses and backlash of a gear are not emulated.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Final

PULSES: Final = range(16, 2_500_001)
"""Range of 0x2210:1."""
FILE: Final = Path(__file__).with_name("gears.csv")


class FittingError(Exception):
    """An encoder or a gear that is not known: one message."""


@dataclass(frozen=True, slots=True)
class Encoder:
    """Encoder at the motor's shaft: pulses in one turn, with or without a third channel."""

    pulses: int
    index: bool = True


@dataclass(frozen=True, slots=True)
class Gear:
    """Turns of the motor for one of the load, and its inertia at the motor's shaft in kg m2."""

    ratio: float = 1.0
    inertia_kg_m2: float = 0.0


ENCODERS: Final[Mapping[str, Encoder]] = {
    **{str(order): Encoder(500) for order in range(110_511, 110_519)},
    "HEDS 5540": Encoder(500),
    "HEDL 5540": Encoder(500),
    "HEDL 9140": Encoder(500),
    "225787": Encoder(1024),
    "228456": Encoder(1000),
    "225780": Encoder(1000),
}
"""HEDS and HEDL 5540, and MR encoders L and ML."""


def encoder_names() -> list[str]:
    """Return what an encoder that is known can be called."""
    return list(ENCODERS)


def encoder(text: str) -> Encoder:
    """Read PULSES, PULSES,no-index, or a name or order number; FittingError."""
    for name, known in ENCODERS.items():
        if text.casefold() == name.casefold():
            return known
    pulses, _, rest = text.partition(",")
    if not pulses.isdecimal() or int(pulses) not in PULSES or rest not in {"", "no-index"}:
        raise FittingError(
            f"--encoder {text}: give PULSES[,no-index], {PULSES.start} to {PULSES.stop - 1} in a turn, "
            f"or one of {', '.join(ENCODERS)}"
        )
    return Encoder(int(pulses), not rest)


@cache
def gears() -> Mapping[str, Gear]:
    """Return every gear of the file by its name with its order number."""
    with FILE.open(encoding="utf-8", newline="") as file:
        return {
            f"{row['name']} {row['order_number']}".strip(): Gear(
                float(Fraction(row["ratio"])), float(row["inertia_kg_m2"])
            )
            for row in csv.DictReader(file)
        }


def gear(text: str) -> Gear:
    """Read a ratio, as 26 or 57/13, or a name or order number, of which a part will do; FittingError."""
    try:
        # An exact ratio, as 57/13, is rounded once.
        ratio = float(Fraction(text))
    except (ValueError, ZeroDivisionError, OverflowError):
        ratio = 0.0
        words = text.casefold().split()
        known = gears()
        found = {name: known[name] for name in known if set(words) <= set(name.casefold().split())}
        if len(found) == 1:
            return next(iter(found.values()))
        if words and found:
            raise FittingError(
                f"--gear {text}: {len(found)} gears have it in their names: {'; '.join(found)}"
            ) from None
    # Order numbers are numbers, too: one that is known is no ratio.
    orders = {name.rpartition(" ")[2]: one for name, one in gears().items() if not name.endswith(":1")}
    if text in orders:
        return orders[text]
    if not 0.0 < ratio < float("inf"):
        raise FittingError(
            f"--gear {text}: give the motor's turns for one turn of the load, as 26 or 57/13, or a "
            "gear by name or order number, as 'GP 32 C 23:1'"
        )
    return Gear(ratio)
