"""Families of devices: found by entry point, a broken one beside the others, and a link that needs it."""

from collections.abc import Iterator
from importlib.metadata import EntryPoint, entry_points

import pytest
from typer.testing import CliRunner

from firmware_bridge import family
from firmware_bridge.cli import program
from firmware_bridge.drivers.all_drivers import alone, reports_of
from firmware_bridge.drivers.driver import Reports
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robot.table import LinkTable
from firmware_bridge.robot_types import find, parse, robots

BROKEN = EntryPoint("toy", "nowhere.toy:FAMILY", family.GROUP)


@pytest.fixture
def broken(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Install a family that cannot be imported, beside the others."""
    own = entry_points(group=family.GROUP)
    monkeypatch.setattr(family, "entry_points", lambda group: [*own, BROKEN] if group == family.GROUP else [])
    family._loaded.cache_clear()  # noqa: SLF001 - what is installed is read once
    yield
    family._loaded.cache_clear()  # noqa: SLF001 - as above


def test_a_family_s_links_lead_to_it() -> None:
    for robot in map(find, robots()):
        for link in robot.links.values():
            assert type(link) is family.family_of(link).link


def test_each_family_gives_the_reports_of_its_devices_and_what_stops_them_without_the_bridge() -> None:
    for robot in map(find, robots()):
        for axis in robot.axes:
            assert reports_of(robot, axis)
        for name in robot.links:
            assert isinstance(alone(robot, name), str)
    rars = find("rars")
    assert Reports.POWER in reports_of(rars, rars.axes[0])
    assert "heartbeat" in alone(rars, rars.axes[0].link)


def test_a_link_of_no_installed_family_is_a_lookup_that_fails() -> None:
    class Strange(LinkTable):
        """A table of no family."""

    with pytest.raises(LookupError, match="no installed family has links of Strange"):
        family.family_of(Strange.model_construct())


@pytest.mark.usefixtures("broken")
def test_a_broken_family_hides_no_other() -> None:
    assert {"ar2", "epos2", "motion_capture", "motor_shield"} <= {one.name for one in family.families()}
    assert "cannot be loaded: ModuleNotFoundError" in family.unloadable()["toy"]
    shown = CliRunner().invoke(program, ["families"])
    assert shown.exit_code
    assert "epos2-can" in shown.stdout
    assert "toy: cannot be loaded" in shown.stderr


@pytest.mark.usefixtures("broken")
def test_a_link_whose_family_is_broken_is_reported_with_the_cause() -> None:
    from firmware_bridge.robots.rars import ROBOT_TYPE  # noqa: PLC0415 - as an entry point does

    text = ROBOT_TYPE.file.read_text(encoding="utf-8").replace("epos2-can", "toy-line")
    with pytest.raises(RobotFileError, match="the family 'toy' cannot be loaded") as ended:
        parse(text, "mine.toml")
    assert "links.drives.driver: 'toy-line' is not known; there are: ar2, " in str(ended.value)
