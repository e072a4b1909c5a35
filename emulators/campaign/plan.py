"""The runs of a campaign, numbered; what a run is made of goes with it, so that any machine can drive it."""

import hashlib
import json
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any, Final

from emulators.bench.bench_setup import BenchSetup, bench_setup_of
from emulators.bench.faults.failures import failures_of
from emulators.bench.mission import Mission, MissionFileError
from emulators.bench.mission import parse as parse_mission
from emulators.bench.toml_text import as_toml
from emulators.campaign.campaign_file import AllFaults, Campaign, CampaignError, Require
from emulators.campaign.interlock_names import interlock_names
from emulators.campaign.sampling import samples_of
from emulators.run import RunOrder
from firmware_bridge import robot_types
from firmware_bridge.family import LinkOptions, family_of
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.robot.problems import FileError, near
from firmware_bridge.robot.table import Medium
from fmu import plants
from fmu.errors import PlantError

NOWHERE: Final = Path()
_PART: Final = re.compile(r"([A-Za-z0-9_-]+)|\[(\d+)\]")


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A robot, a mission, a protocol and a fault, with the texts of both files."""

    robot: str
    mission: str
    protocol: str
    fault: str
    faults: tuple[Mapping[str, Any], ...]
    robot_text: str
    mission_text: str


@dataclass(frozen=True, slots=True)
class Run:
    """One run: its number in the campaign, its case, its seed, and the parameters' values by their paths."""

    number: int
    case: Case
    seed: int
    values: Mapping[str, Any] = field(default_factory=dict)

    @property
    def key(self) -> dict[str, Any]:
        """What it is of, a column each."""
        case = self.case
        named = {"robot": case.robot, "mission": case.mission, "protocol": case.protocol, "fault": case.fault}
        return {"run": self.number, **named, "seed": self.seed, **self.values}


@dataclass(frozen=True, slots=True)
class Plan:
    """All runs of a campaign in their order."""

    campaign: Campaign
    runs: tuple[Run, ...]
    file: str
    sha256: str
    """Of everything that the results depend on but the program."""


def plan(campaign: Campaign, file: str, base: Path = NOWHERE) -> Plan:
    """Return the runs of a campaign; `base` is the folder that its paths are relative to.

    CampaignError with every robot, mission, protocol, fault and parameter that does not fit;
    ExtraMissingError where its way of sampling needs an extra.
    """
    cases = _cases(campaign, file, base)
    paths = [row.path for row in campaign.parameter]
    drawn = [dict(zip(paths, values, strict=True)) for values in samples_of(campaign)]
    all_of = product(cases, drawn, campaign.each_seed)
    runs = tuple(Run(number, case, seed, values) for number, (case, values, seed) in enumerate(all_of))
    _check(runs, campaign.require, file)
    require = [row.model_dump(exclude_defaults=True) for row in campaign.require]
    # Cases once each, the rest by their places.
    listed = [[asdict(case) for case in cases], drawn, campaign.each_seed, require]
    digest = hashlib.sha256(json.dumps(listed, sort_keys=True).encode()).hexdigest()
    return Plan(campaign, runs, file, digest)


def order_of(run: Run, folder: Path = NOWHERE, again: str = "") -> RunOrder:
    """Return what drives a run; RobotFileError and MissionFileError where a value does not suit."""
    robot, setup, mission = _made(run)
    return RunOrder(robot, setup, Path(run.case.mission).stem, mission, run.seed, folder, again=again)


def texts_of(run: Run) -> tuple[str, str]:
    """Return the robot file and the mission file of a run, its values and faults in them."""
    return _robot_text(run), _mission_text(run)


def _made(run: Run) -> tuple[AnyRobot, BenchSetup, Mission]:
    robot = _linked(robot_types.parse(_robot_text(run), run.case.robot), run.case.protocol)
    setup = bench_setup_of(robot)
    return robot, setup, parse_mission(_mission_text(run), run.case.mission, robot, setup)


def _robot_text(run: Run) -> str:
    changes = _of(run, "robot")
    if not changes:
        return run.case.robot_text
    table = _read(run.case.robot_text)
    for path, value in changes.items():
        place(table, path, value, run.case.robot)
    return as_toml(table)


def _mission_text(run: Run) -> str:
    table = _read(run.case.mission_text)
    for path, value in _of(run, "mission").items():
        place(table, path, value, run.case.mission)
    if changes := _of(run, "plant"):
        table["plant"] = {**table.get("plant", {}), **changes}
    if link := _of(run, "link"):
        parts = (part.partition("=") for part in table.get("link", "").split(",") if part.strip())
        stated = {key.strip(): value.strip() for key, _, value in parts}
        table["link"] = ",".join(f"{key}={value}" for key, value in {**stated, **link}.items())
    if run.case.faults:
        table["fault"] = [*table.get("fault", []), *map(dict, run.case.faults)]
    return as_toml(table)


def _of(run: Run, place_of: str) -> dict[str, Any]:
    """Return the values whose paths begin so, by the rest of the path."""
    split = {path: path.partition(".") for path in run.values}
    return {rest: run.values[path] for path, (begins, _, rest) in split.items() if begins == place_of}


@lru_cache(maxsize=64)
def _parsed(text: str) -> str:
    # Kept as text that is quick to read: each run changes a table of its own.
    return json.dumps(tomllib.loads(text), default=str)


def _read(text: str) -> dict[str, Any]:
    table: dict[str, Any] = json.loads(_parsed(text))
    return table


def place(table: Any, path: str, value: Any, file: str) -> None:
    """Set the key at a path, as `step[2].speed_mps` or `axes.left.ratio`, rows by place or name.

    MissionFileError where a table or a row on the way is missing; the last key need not be there.
    """
    parts = [name or int(index) for name, index in _PART.findall(path)]
    try:
        for part in parts[:-1]:
            table = _step(table, part)
        table[parts[-1]] = value
    except (KeyError, IndexError, TypeError, StopIteration):
        raise MissionFileError(file, Problem(path, "no such table or row on the way to it")) from None


def _step(table: Any, part: str | int) -> Any:
    if isinstance(table, list) and isinstance(part, str):
        return next(row for row in table if row.get("name") == part)
    return table[part]


def _linked(robot: AnyRobot, protocol: str) -> AnyRobot:
    if protocol:
        on_bus = any(link.medium is Medium.CAN for link in robot.links.values())
        options = LinkOptions(protocol, lines=tuple(robot.links) if on_bus else ())
        families = tuple(dict.fromkeys(family_of(link) for link in robot.links.values()))
        if not any("protocol" in family.takes for family in families):
            problem = f"{robot.name} has nothing that takes the protocol '{protocol}'"
            raise RobotFileError(robot.name, Problem("protocols", problem))
        for family in families:
            robot = family.over(robot, options)
    for link in robot.links.values():
        robot = family_of(link).drivable(robot)
    return robot


def _cases(campaign: Campaign, file: str, base: Path) -> list[Case]:
    found, problems = [], list[Problem]()
    for (at, robot), (mission_at, mission), protocol in product(
        enumerate(campaign.robots), enumerate(campaign.missions), campaign.protocols
    ):
        try:
            text = robot_types.text_named(_path(robot, base))
            machine = _linked(robot_types.parse(text, robot), protocol)
        except (FileError, LookupError) as error:
            problems.append(Problem(f"robots[{at}]", str(error)))
            continue
        try:
            script = _mission(mission, machine, base)
        except (FileError, LookupError) as error:
            problems.append(Problem(f"missions[{mission_at}]", f"for {robot}: {error}"))
            continue
        for title, rows in _faults(campaign, machine):
            found.append(Case(robot, mission, protocol, title, rows, text, script))
    if problems:
        raise CampaignError(file, *dict.fromkeys(problems))
    return found


def _mission(name: str, robot: AnyRobot, base: Path) -> str:
    setup = bench_setup_of(robot)
    shipped = setup.shipped()
    path = shipped.get(name, Path(_path(name, base)))
    if name not in shipped and path.suffix != ".toml":
        known = ", ".join(shipped)
        problem = f"{robot.name} has no such mission; there are {known} (a path to a .toml file works, too)"
        raise MissionFileError(name, Problem("", problem))
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise MissionFileError(name, Problem("", f"cannot be read: {error}")) from error
    parse_mission(text, name, robot, setup)
    return text


def _path(name: str, base: Path) -> str:
    return str(base / name) if name.endswith(".toml") else name


def _faults(campaign: Campaign, robot: AnyRobot) -> Iterator[tuple[str, tuple[Mapping[str, Any], ...]]]:
    if not isinstance(campaign.faults, AllFaults):
        for row in campaign.faults:
            title = ", ".join(f"{value}" if key == "kind" else f"{key} {value}" for key, value in row.items())
            yield title, (row,) if row else ()
        return
    at = {"at_s": campaign.faults.all_at_s}
    length = {} if campaign.faults.for_s is None else {"for_s": campaign.faults.for_s}
    for failure in failures_of(robot):
        keys = {key: list(it) if isinstance(it, tuple) else it for key, it in failure.keys.items()}
        row = {"kind": failure.kind, **at, **(length if failure.lasts else {}), **keys}
        yield " ".join(filter(None, (failure.title, failure.place))), (row,)


def _check(runs: Sequence[Run], require: Sequence[Require], file: str) -> None:
    """Read each case, alone and with each parameter's least and largest value; CampaignError."""
    ends = _ends(runs)
    problems: dict[Problem, None] = {}
    # Which seed it is makes no difference.
    for run in {run.case: run for run in runs}.values():
        where = f"for {run.case.robot}, {run.case.mission}"
        try:
            robot = _made(replace(run, values={}))[0]
        except (FileError, LookupError) as error:
            problems.setdefault(Problem("faults", f"{where}: {error}"))
            continue
        for problem in _unknown_interlocks(robot, require):
            problems.setdefault(problem)
        for path, value in ends:
            try:
                _made(replace(run, values={path: value}))
                _plant_has(robot, path)
            except (FileError, LookupError, PlantError) as error:
                problems.setdefault(Problem(f"parameter '{path}'", f"{where}: {error}"))
    if problems:
        raise CampaignError(file, *problems)


def _unknown_interlocks(robot: AnyRobot, require: Sequence[Require]) -> Iterator[Problem]:
    known = sorted(interlock_names(robot))
    for place, row in enumerate(require):
        for key in ("never", "always"):
            if (name := getattr(row, key)) and name not in known:
                problem = f"{robot.name} has no interlock '{name}'; {near(name, known)}"
                yield Problem(f"require[{place}].{key}", problem)


def _ends(runs: Sequence[Run]) -> list[tuple[str, Any]]:
    """Return each parameter with its least and its largest value, with every one where they have no order."""
    found: dict[str, dict[Any, None]] = {}
    for run in runs:
        for path, value in run.values.items():
            found.setdefault(path, {})[value] = None
    ends = []
    for path, values in found.items():
        ordered = all(isinstance(value, (int, float)) for value in values)
        ends += [(path, value) for value in ({min(values), max(values)} if ordered else values)]
    return ends


def _plant_has(robot: AnyRobot, path: str) -> None:
    """Raise UnknownNameError where it is no parameter of the robot's plant; a file's are not known here."""
    begins, _, name = path.partition(".")
    if begins == "plant" and robot.plant.fmu in plants.names():
        plants.find(robot.plant.fmu).starting({name: 0.0})
