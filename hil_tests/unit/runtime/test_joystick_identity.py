"""Identity of a joystick, by the kernel's own structures: linux/joystick.h."""

import fcntl
from pathlib import Path

import pytest
import typer

from firmware_bridge.cli.pilot import PilotOptions, run
from firmware_bridge.runtime.ports.joystick import identity

NAME, AXES, AXIS_MAP = 0x80806A13, 0x80016A11, 0x80406A32
"""JSIOCGNAME(128), JSIOCGAXES, JSIOCGAXMAP, as its header's macros come to."""


def test_its_name_and_the_codes_of_its_axes_are_requested(monkeypatch: pytest.MonkeyPatch) -> None:
    states = {NAME: b"Pad\0rubbish", AXES: b"\3", AXIS_MAP: bytes((0, 3, 4, 9))}

    def ioctl(_fileno: int, request: int, answer: bytearray) -> int:
        answer[: len(states[request])] = states[request]
        return 0

    monkeypatch.setattr(fcntl, "ioctl", ioctl)
    assert identity(0) == ("Pad", frozenset({0, 3, 4}))


def test_what_is_no_joystick_sends_nothing(tmp_path: Path) -> None:
    with (tmp_path / "file").open("wb") as file:
        assert identity(file.fileno()) == ("", frozenset())


def test_a_gamepad_must_be_called_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    device = tmp_path / "js0"
    device.write_bytes(b"")
    monkeypatch.setattr(
        "firmware_bridge.runtime.ports.joystick.identity",
        lambda _fileno: ("Some X-Box pad", frozenset[int]()),
    )
    with pytest.raises(typer.Exit) as ended:
        run(PilotOptions(robot="rars", joystick=True, device=str(device)))
    assert ended.value.exit_code == 2
    reported = capsys.readouterr().err
    assert "'Some X-Box pad' is a gamepad; use --controls gamepad, or pedals where it is none" in reported
