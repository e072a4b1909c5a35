"""Each word of the release before: it does what the new one does, and a warning names that."""

import sys
from dataclasses import dataclass, fields
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.cases import Case, Situation
from emulators.bench.faults import read
from emulators.bench.step import Step
from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.choices import chosen
from emulators.run import RunOrder
from emulators.servo import kernel
from emulators.testing.inherited.fake_driver import seen
from emulators.testing.process import Process
from emulators.testing.rig import VirtualRig
from firmware_bridge import renamed
from firmware_bridge.drivers.driver import Reports, SetPoint
from firmware_bridge.intent import ConfirmPosition
from firmware_bridge.renamed import RenamedWarning
from firmware_bridge.robot_type import PathFollower, RobotType
from firmware_bridge.robot_types import find, load, robot_type_of
from firmware_bridge.robots.climber.kinematics import CLIMBER
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.robots.rars.geometry import Degraded
from firmware_bridge.robots.rars.motion import RarsMotion
from firmware_bridge.runtime.run_file import RUN_FILE, AsRun, read_run, run_file
from firmware_bridge.safety.gate import NO_GROUP
from firmware_bridge.safety.interlock import View
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.kinematic_model import KinematicModel
from firmware_bridge.safety.snapshot import ActiveInterlock
from firmware_bridge.teleop.station import StationRows, Value
from firmware_bridge.units import SECOND
from fmu.export.model import StateVariable


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
    case: Any = Case
    with pytest.warns(RenamedWarning, match="Case: 'row' is called 'interlock' now"):
        assert case(row="too fast", trips=Situation(), spares=Situation(), reason="").interlock == "too fast"
    setup = bench_setup_of(find("ar2"))
    replaced: Any = type(setup)
    made = {one.name: getattr(setup, one.name) for one in fields(setup) if one.name != "start_positions"}
    with pytest.warns(RenamedWarning, match="BenchSetup: 'stands' is called 'start_positions' now"):
        assert replaced(**made, stands=setup.start_positions) == setup
    with pytest.warns(RenamedWarning, match="RobotType: 'body' is called 'kinematics' now"):
        assert ROBOT_TYPE.body is ROBOT_TYPE.kinematics
    with pytest.warns(RenamedWarning, match="RobotType: 'rest' is called 'standstill' now"):
        assert ROBOT_TYPE.rest is ROBOT_TYPE.standstill
    with pytest.warns(RenamedWarning, match="BenchSetup: 'stands' is called 'start_positions' now"):
        assert setup.stands is setup.start_positions
    value: Any = Value
    with pytest.warns(RenamedWarning, match="Value: 'tells' is called 'title' now"):
        assert value("SPEED", SECOND, lambda _: 0.0, tells="m/s").title == "m/s"


def test_the_servos_reference_is_chosen_by_its_old_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(kernel.VARIABLE, "twin")
    with pytest.warns(RenamedWarning, match="FIRMWARE_BRIDGE_SERVO: 'twin' is called 'reference' now"):
        assert kernel.choose().library is None


def test_a_robot_file_has_its_old_keys(tmp_path: Path) -> None:
    text = ROBOT_TYPE.file.read_text(encoding="utf-8")
    file = tmp_path / "old.toml"
    file.write_text(text.replace("[geometry.degraded]", "[geometry.limp]"), encoding="utf-8")
    with pytest.warns(
        RenamedWarning, match=r"old\.toml: 'geometry\.limp' is called 'geometry\.degraded' now"
    ):
        assert load(file) == find("rars")


def test_a_robot_files_operator_link_has_its_old_key(tmp_path: Path) -> None:
    text = ROBOT_TYPE.file.read_text(encoding="utf-8")
    file = tmp_path / "old.toml"
    file.write_text(text.replace("[operator]\n", "[operator]\ngone_ms = 20_000\n"), encoding="utf-8")
    with pytest.warns(RenamedWarning, match=r"old\.toml: 'operator\.gone_ms' is called 'operator\.lost_ms'"):
        assert load(file).operator.lost_ms == 20_000


def test_a_recording_has_the_old_keys_of_its_robot(tmp_path: Path) -> None:
    robot = find("rars")
    (text,) = run_file(AsRun(robot)).values()
    (tmp_path / RUN_FILE).write_text(text.replace('"degraded"', '"limp"'), encoding="utf-8")
    with pytest.warns(RenamedWarning, match=r"'geometry\.limp' is called 'geometry\.degraded' now"):
        kept = read_run(tmp_path)
    assert kept is not None
    assert kept.robot == robot


def test_a_recording_has_the_old_key_of_its_confirmed_positions(tmp_path: Path) -> None:
    given = (ConfirmPosition("lift", 0.1),)
    (text,) = run_file(AsRun(find("rars"), given)).values()
    (tmp_path / RUN_FILE).write_text(text.replace('"confirmed"', '"stands"'), encoding="utf-8")
    kept = read_run(tmp_path)
    assert kept is not None
    assert kept.confirmed == given


def test_attributes_are_read_by_their_old_names(tmp_path: Path) -> None:
    robot = find("diff_drive")
    snapshot = seen(robot, SECOND)
    view: View[Any, Any, Any] = View(robot, snapshot, snapshot.command, NO_GROUP, None)
    with pytest.warns(RenamedWarning, match="Snapshot: 'wish' is called 'command' now"):
        assert snapshot.wish is snapshot.command
    with pytest.warns(RenamedWarning, match="Snapshot: 'demanded' is called 'commanded' now"):
        assert snapshot.demanded is snapshot.commanded
    with pytest.warns(RenamedWarning, match="View: 'asked' is called 'requested' now"):
        assert view.asked is view.requested
    program = Process([sys.executable, "-c", "print('here')"], tmp_path / "printed.txt")
    with pytest.warns(RenamedWarning, match="Process: 'says' is called 'prints' now"):
        program.says("here", within=60)
    assert program.ends(within=60) == 0


def test_what_the_operator_has_received_has_its_old_name() -> None:
    rig = VirtualRig(find("diff_drive"))
    try:
        with pytest.warns(RenamedWarning, match=r"rig\.operator: 'told' is called 'texts' now"):
            assert rig.operator.told == rig.operator.texts
        with pytest.warns(RenamedWarning, match="operator: 'lets_go' is called 'returns_to_neutral' now"):
            rig.operator.lets_go()
    finally:
        rig.finish()


def test_a_choice_of_an_emulated_drive_has_its_old_name() -> None:
    profile = PROFILES["70/10"]
    with pytest.warns(RenamedWarning, match="--choice: 'tells-cured' is called 'reports-reset' now"):
        assert chosen(profile, ["tells-cured=no"]) == chosen(profile, ["reports-reset=no"])


def test_a_fault_is_put_on_by_its_old_words() -> None:
    with pytest.warns(RenamedWarning, match="'nmt_stranger' is called 'nmt_foreign_node' now"):
        assert read({"kind": "nmt_stranger", "at_s": 1.0, "command": "stop"}).kind == "nmt_foreign_node"
    with pytest.warns(RenamedWarning, match="fault bridge_ends, how: 'asked' is called 'interrupted' now"):
        assert read({"kind": "bridge_ends", "at_s": 1.0, "for_s": 1.0, "how": "asked"}).kind == "bridge_ends"


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("firmware_bridge.kind", "Kind", RobotType),
        ("firmware_bridge.kind", "Guide", PathFollower),
        ("firmware_bridge.kinds", "find", find),
        ("firmware_bridge.drivers.driver", "Demand", SetPoint),
        ("firmware_bridge.drivers.driver", "Tells", Reports),
        ("firmware_bridge.robots.rars.geometry", "Limp", Degraded),
        ("firmware_bridge.safety.row", "Severity", Severity),
        ("firmware_bridge.safety.body", "Body", KinematicModel),
        ("firmware_bridge.safety.snapshot", "Hold", ActiveInterlock),
        ("firmware_bridge.robots.rars", "KIND", ROBOT_TYPE),
        ("firmware_bridge.robots.rars.motion", "Motion", RarsMotion),
        ("emulators.bench.rehearsal", "rehearsal_of", bench_setup_of),
        ("emulators.run", "Order", RunOrder),
    ],
)
def test_modules_and_classes_have_their_old_names(module: str, old: str, new: object) -> None:
    with pytest.warns(RenamedWarning, match=rf"'{module}\.{old}' is called '.*' now"):
        assert getattr(import_module(module), old) is new


def test_a_name_that_was_never_there_is_not_there() -> None:
    with pytest.raises(AttributeError, match=r"module 'firmware_bridge\.kind' has no attribute 'Nothing'"):
        _ = import_module("firmware_bridge.kind").Nothing


def test_a_state_of_a_plant_has_its_old_name() -> None:
    with pytest.warns(FutureWarning, match="'State' is called 'StateVariable' now"):
        assert import_module("fmu.export.model").State is StateVariable
    assert not hasattr(import_module("fmu.export.model"), "Nothing")


def test_a_robot_file_has_its_old_axis_keys(tmp_path: Path) -> None:
    own = find("diff_drive")
    text = robot_type_of(own).file.read_text(encoding="utf-8")
    file = tmp_path / "old.toml"
    old = text.replace("plausibility = ", "belief = ").replace("standstill_group = ", "stands_with = ")
    file.write_text(old, encoding="utf-8")
    assert old.count("belief = ") == old.count("stands_with = ") == 2
    with pytest.warns(RenamedWarning) as warned:
        assert load(file) == own
    texts = " ".join(str(one.message) for one in warned)
    assert "'axes.belief' is called 'axes.plausibility' now" in texts
    assert "'axes.stands_with' is called 'axes.standstill_group' now" in texts


def test_a_step_of_a_mission_has_its_old_keys() -> None:
    with pytest.warns(RenamedWarning, match="step: 'guide' is called 'path_follower' now"):
        step = Step.model_validate({"at_s": 1.0, "title": "drive", "guide": "circle"})
    assert step.path_follower == "circle"


def test_a_station_and_a_differential_robot_have_their_old_spelling() -> None:
    robot: Any = CLIMBER
    with pytest.warns(
        RenamedWarning, match="DifferentialRobot: 'metres_rolled' is called 'meters_rolled' now"
    ):
        assert robot.metres_rolled(find("climber")) == robot.meters_rolled(find("climber"))
    given = {one.name: getattr(ROBOT_TYPE.station, one.name) for one in fields(ROBOT_TYPE.station)}
    given["metres_rolled"] = given.pop("meters_rolled")
    with pytest.warns(RenamedWarning, match="StationRows: 'metres_rolled' is called 'meters_rolled' now"):
        assert StationRows(**given) == ROBOT_TYPE.station
