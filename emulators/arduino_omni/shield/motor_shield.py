"""The Adafruit Motor Shield V2: which PWM channel drives which input of which half bridge.

Source: Adafruit_Motor_Shield_V2_Library, getMotor(). Assumed: STBY is tied high. FORWARD of the library is
the row CW of the half bridges; which way a motor then turns is its wiring's business.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Final

from emulators.arduino_omni.shield.pca9685 import PERIOD_COUNTS, Pca9685, Wave, driven
from emulators.arduino_omni.shield.tb6612 import Bridge, BridgeDuty, bridge
from firmware_bridge.units import Nanoseconds

DEFAULT_ADDRESS: Final = 0x60
JUMPERS: Final = 5
"""A0 to A4 add 0 to 31 to the address."""


@dataclass(frozen=True, slots=True)
class Port:
    """One motor's terminals: the channels of the PWM chip at its half bridge."""

    name: str
    pwm: int
    in2: int
    in1: int


PORTS: Final = (Port("M1", 8, 9, 10), Port("M2", 13, 12, 11), Port("M3", 2, 3, 4), Port("M4", 7, 6, 5))


def share(pwm: Wave, in1: Wave, in2: Wave) -> BridgeDuty:
    """Return what a half bridge does over one PWM period, count by count, from its three inputs."""
    waves = (pwm, in1, in2)
    edges = {0, PERIOD_COUNTS}
    for it in waves:
        # The bridge changes only where one of its inputs does: one look for each piece between two edges.
        edges |= {it.rises, (it.rises + it.high) % PERIOD_COUNTS}
    counts = dict.fromkeys(Bridge, 0)
    cuts = sorted(edges)
    for begin, end in pairwise(cuts):
        levels = [(begin - it.rises) % PERIOD_COUNTS < it.high for it in waves]
        counts[bridge(pwm=levels[0], in1=levels[1], in2=levels[2])] += end - begin
    return BridgeDuty(counts[Bridge.CW], counts[Bridge.CCW], counts[Bridge.BRAKE], counts[Bridge.OPEN])


# Called in every tick that something happens in, and there are few answers: a sign and 256 duties.
@lru_cache(maxsize=4_096)
def _shared(pwm: bytes, in1: bytes, in2: bytes, mode2: int, runs: bool) -> BridgeDuty:  # noqa: FBT001 - a cache's key
    return share(driven(pwm, mode2, runs=runs), driven(in1, mode2, runs=runs), driven(in2, mode2, runs=runs))


class MotorShield:
    """One shield with its jumpers; it has no wire to the board's reset."""

    def __init__(self, jumpers: int = 0) -> None:
        if not 0 <= jumpers < 1 << JUMPERS:
            raise ValueError(f"a shield's jumpers add 0 to 31 to its address, and not {jumpers}")
        self.chip: Final = Pca9685(DEFAULT_ADDRESS + jumpers)

    def outputs(self, now: Nanoseconds) -> tuple[BridgeDuty, ...]:
        """Return what the motors M1 to M4 get, now."""
        return tuple(self.output(port, now) for port in PORTS)

    def output(self, port: Port, now: Nanoseconds) -> BridgeDuty:
        """Return what one motor gets, now."""
        chip = self.chip
        pins = (chip.latched(port.pwm), chip.latched(port.in1), chip.latched(port.in2))
        return _shared(*pins, chip.latched_mode2, chip.runs(now))
