"""`emulate ROBOT`: with which parameters its drives come."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final, TypeAlias

import pytest
import typer

from emulators.cli.emulate_robot import RobotOptions, run
from emulators.devices import devices
from emulators.epos2.drive import Epos2
from emulators.epos2.options import PRODUCT
from emulators.family import Devices
from emulators.parameter_files import ParameterFile
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.families.epos2.driver.product import commissioned
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.node import Node
from firmware_bridge.robot_types import find
from firmware_bridge.runtime.clock import Clock, LivedClock
from firmware_bridge.units import SECOND

Drives: TypeAlias = Callable[..., Mapping[str, Epos2]]
RARS: Final = find("rars")
OWN: Final = 7_777
"""A position P gain that neither factory nor robot file has."""


@pytest.fixture
def emulated(monkeypatch: pytest.MonkeyPatch) -> Drives:
    """Return the drives that `emulate` would carry, switched on."""

    def emulate(**options: object) -> Mapping[str, Epos2]:
        made: list[Devices] = []

        def noted(*words: Any, **more: Any) -> Devices:
            made.append(devices(*words, **more))
            return made[-1]

        def carried(node: Node, *_rest: object, clock: Clock) -> None:
            assert isinstance(clock, LivedClock)
            node.wake(0)
            node.wake(2 * SECOND)

        monkeypatch.setattr("emulators.devices.devices", noted)
        monkeypatch.setattr("firmware_bridge.cli.real_time.carry", carried)
        given: Any = {"robot": "rars", "interface": "virtual", **options}
        run(RobotOptions(**given))
        return made[0].nodes(Epos2)

    return emulate


def differing(drives: Mapping[str, Epos2]) -> set[SetupObject]:
    """Return what is not as in the robot file."""
    found = set[SetupObject]()
    for axis in RARS.axes:
        store = drives[axis.name].store
        found |= {row for row in commissioned(axis) if store.get(row.address) != row.value}
    return found


def test_drives_come_commissioned(emulated: Drives) -> None:
    assert differing(emulated()) == set()


def test_from_the_factory_they_have_none_of_the_robot_s_gains(emulated: Drives) -> None:
    names = {row.name for row in differing(emulated(factory=True))}
    assert {"position P gain", "velocity P gain", "current P gain"} <= names


@pytest.mark.parametrize("factory", [False, True])
def test_what_was_saved_comes_before_both(emulated: Drives, tmp_path: Path, *, factory: bool) -> None:
    axis = RARS.axes[0]
    ParameterFile(tmp_path / f"node-{Epos2Axis.of(axis).node}.json", PRODUCT).write({at.POSITION_P: OWN})
    drive = emulated(factory=factory, parameters=tmp_path)[axis.name]
    assert drive.store.get(at.POSITION_P) == OWN


def test_a_damaged_file_of_parameters_is_named(
    emulated: Drives, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "node-2.json").write_text("{")
    with pytest.raises(typer.Exit) as ended:
        emulated(parameters=tmp_path)
    assert ended.value.exit_code == 2
    assert "node-2.json" in capsys.readouterr().err
