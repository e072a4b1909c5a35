"""Channels of RC_CHANNELS_OVERRIDE, held from message to message (common.xml)."""

from dataclasses import dataclass, field

from firmware_bridge.units import Nanoseconds


@dataclass(slots=True)
class Channels:
    """One station's channels of RC_CHANNELS_OVERRIDE, each until it is given back, or grows old."""

    _held: dict[int, tuple[int, Nanoseconds]] = field(default_factory=dict)

    @property
    def values(self) -> dict[int, int]:
        """Return what is held, in us, by the channels' numbers."""
        return {number: value for number, (value, _) in self._held.items()}

    def receive(self, channels: dict[int, int | None], now: Nanoseconds, silent_after: Nanoseconds) -> None:
        """Take a message's values of some channels; one without a value for so long is given back."""
        for number, value in channels.items():
            if value is None:
                self._held.pop(number, None)
            else:
                self._held[number] = (value, now)
        for number in [one for one, (_, at) in self._held.items() if now - at >= silent_after]:
            del self._held[number]
