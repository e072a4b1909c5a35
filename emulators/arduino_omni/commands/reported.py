"""Reports of an emulated board's console."""

from emulators.arduino_omni.mega.mega import KEPT, Mega
from firmware_bridge.cli.console import say
from firmware_bridge.units import to_seconds


def keeping_reported(mega: Mega, name: str = "the board") -> None:
    """Let a board say once that bytes keep it in its boot loader."""
    before = mega.kept

    def report() -> None:
        mega.kept = before
        say(
            f"{name} is kept in its boot loader, as a real one, by bytes that came within a second of its "
            f"reset: the sketch starts {to_seconds(KEPT):g} s after the last of them; send nothing before it"
        )

    mega.kept = report
