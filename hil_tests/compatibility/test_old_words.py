"""Each word of the release before: it does what the new one does, and a warning names that."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from emulators.bench.cases import Situation
from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.choices import chosen
from firmware_bridge import renamed
from firmware_bridge.kinds import find, load
from firmware_bridge.renamed import RenamedWarning
from firmware_bridge.robots.rars import KIND
from firmware_bridge.teleop.station import Value
from firmware_bridge.units import SECOND


@dataclass
class Walks:
    """A path follower of a robot package, as it was written before."""

    speed: float

    def wished(self, share: float) -> float:
        return share * self.speed

    def reset(self) -> None:
        self.speed = 0.0


def test_a_method_is_called_by_its_new_name() -> None:
    made: Any = renamed.makes(Walks, "wished", "command")
    with pytest.warns(RenamedWarning, match="Walks: 'wished' is called 'command' now"):
        walks = made(2.0)
    assert walks.command(0.5) == 1.0
    walks.reset()
    assert walks.wished(0.5) == 0.0


def test_arguments_are_taken_under_their_old_names() -> None:
    made: Any = Situation
    with pytest.warns(RenamedWarning, match="Situation: 'wish' is called 'command' now"):
        assert made(wish=3) == Situation(command=3)
    value: Any = Value
    with pytest.warns(RenamedWarning, match="Value: 'tells' is called 'title' now"):
        assert value("SPEED", SECOND, lambda _: 0.0, tells="m/s").title == "m/s"


def test_a_robot_file_has_its_old_keys(tmp_path: Path) -> None:
    text = KIND.file.read_text(encoding="utf-8")
    file = tmp_path / "old.toml"
    file.write_text(text.replace("[geometry.degraded]", "[geometry.limp]"), encoding="utf-8")
    with pytest.warns(
        RenamedWarning, match=r"old\.toml: 'geometry\.limp' is called 'geometry\.degraded' now"
    ):
        assert load(file) == find("rars")


def test_a_choice_of_an_emulated_drive_has_its_old_name() -> None:
    profile = PROFILES["70/10"]
    with pytest.warns(RenamedWarning, match="--choice: 'tells-cured' is called 'reports-reset' now"):
        assert chosen(profile, ["tells-cured=no"]) == chosen(profile, ["reports-reset=no"])
