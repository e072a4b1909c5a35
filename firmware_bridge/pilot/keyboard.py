"""A keyboard, where there is no joystick: a terminal reports keys pressed, and not keys released.

So the operator keeps a key down, and its repetition keeps the robot going. A key is taken as down until its
repetition must have begun, and then from one to the next: assumed 0.7 s and 0.2 s, above the 660 ms and 40 ms
with which X begins. The terminal repeats only the newest key.
"""

from collections.abc import Iterator
from types import MappingProxyType
from typing import Final

from firmware_bridge.pilot.at_standstill import SeenAtStandstill
from firmware_bridge.pilot.driver import NO_EXTRAS, ButtonRequest, Extras, Sight, Stick
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

BEGINS: Final[Nanoseconds] = 700 * MILLISECOND
REPEATS: Final[Nanoseconds] = SECOND // 5
STEP: Final = 0.1
"""Of full lock, at a press."""
HELP: Final = (
    "keep w or s (arrows) down to drive, a and d turn the helm, x brings it back; p arms, space is neutral, "
    "Enter is the emergency stop; r and f go up and down, 1 to 9 switch"
)
_ARROWS: Final = MappingProxyType({b"A": b"w", b"B": b"s", b"C": b"d", b"D": b"a"})
_ESCAPE: Final = b"\x1b"
_REQUESTS: Final = MappingProxyType(
    {b"p": ButtonRequest.ARM, b"\r": ButtonRequest.STOP, b"\n": ButtonRequest.STOP}
)
_FORWARD: Final = MappingProxyType({b"w": 1.0, b"s": -1.0})
_UP: Final = MappingProxyType({b"r": 1.0, b"f": -1.0})
_HELM: Final = MappingProxyType({b"a": STEP, b"d": -STEP})
_DIGITS: Final = frozenset(b"%d" % number for number in range(1, 10))


class Keyboard:
    """A `firmware_bridge.pilot.driver.AtHand`."""

    def __init__(self, share: float, extras: Extras = NO_EXTRAS) -> None:
        """Drive with this share of full stick."""
        self._share: Final = share
        self._extras: Final = extras
        self._rest = b""
        self._forward = 0.0
        self._up = 0.0
        self._helm = 0.0
        self._switches: Final[set[int]] = set()
        """Pressed since the last command."""
        self._seen: Final = SeenAtStandstill()
        self._key = b""
        self._until: Nanoseconds = 0
        """So long the newest key counts as down."""

    def sees(self, sight: Sight) -> None:
        """See it: what to do about it is the human's business."""

    def handle(self, chunk: bytes, now: Nanoseconds) -> Iterator[ButtonRequest]:
        """Take a terminal's bytes, cut anywhere; yield what the keys ask for."""
        for key in self._keys(chunk):
            if key in _REQUESTS:
                self._to_neutral()
                if _REQUESTS[key] is ButtonRequest.ARM:
                    self._seen.arm_requested()
                yield _REQUESTS[key]
            elif key == b" ":
                self._to_neutral()
            elif key in _DIGITS:
                self._switches.add(int(key) - 1)
            else:
                self._driven(key, now)

    def command(self, _link: PilotLink, now: Nanoseconds, *, armed: bool) -> Stick:
        """Return the command of the keys; once the robot is armed, only of those released since."""
        # The repetition of the key is the enabling switch: a released key is noticed only by its absence.
        if now >= self._until:
            self._to_neutral()
        driven = bool(self._forward or self._up)
        self._seen.look({"keys": not driven, "helm": not self._helm}, armed=armed)
        forward, raised = (self._forward, self._up) if self._seen.counts("keys") else (0.0, 0.0)
        up, buttons = self._extras.encoded(raised, self._switches)
        self._switches.clear()
        helm = self._helm if self._seen.counts("helm") else 0.0
        return Stick(self._share * forward, helm, up, buttons)

    def _driven(self, key: bytes, now: Nanoseconds) -> None:
        if key in _FORWARD or key in _UP:
            self._down(key, now)
            self._forward, self._up = _FORWARD.get(key, 0.0), _UP.get(key, 0.0)
        elif key in _HELM:
            self._helm = max(-1.0, min(round(self._helm + _HELM[key], 1), 1.0))
            if now < self._until:  # it is driven on while it is turned
                self._down(key, now)
        elif key == b"x":
            self._helm = 0.0

    def _down(self, key: bytes, now: Nanoseconds) -> None:
        # The first repetition of a terminal comes late, the following ones quickly.
        again = key == self._key and now < self._until
        self._key, self._until = key, now + (REPEATS if again else BEGINS)

    def _to_neutral(self) -> None:
        self._forward = self._up = 0.0
        self._key, self._until = b"", 0

    def _keys(self, chunk: bytes) -> Iterator[bytes]:
        """Yield the keys, arrows as the letters that mean the same."""
        at, whole = 0, self._rest + chunk
        while at < len(whole):
            # Arrows are three bytes from Escape on, which may arrive in parts.
            key = whole[at : at + 1]
            if key != _ESCAPE:
                at += 1
                yield key.lower()
            elif len(whole) < at + 3:
                break
            else:
                at += 3
                yield _ARROWS.get(whole[at - 1 : at], b"")
        self._rest = whole[at:]
