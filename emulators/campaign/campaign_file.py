"""A campaign's TOML file: what is driven, what is varied, what a run must hold to; all mistakes at once."""

import math
import tomllib
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self

from pydantic import Field, ValidationError, model_validator

from firmware_bridge.robot.problems import FileError, Problem, problems_of
from firmware_bridge.robot.table import Finite, Table

Number = int | float | bool | str
Text = Annotated[str, Field(min_length=1)]
Texts = Annotated[tuple[Text, ...], Field(min_length=1, strict=False)]
PLACES: Final = ("plant", "mission", "robot", "link")
"""What a parameter's path begins with."""
DRAWN: Final = ("random", "latin_hypercube", "sobol")
"""Ways of sampling that take `samples`."""


class CampaignError(FileError):
    """A campaign that cannot be driven."""


class Varied(Table):
    """One parameter: its values, or its range."""

    path: Annotated[str, Field(pattern=r"^(plant|mission|robot|link)\..+")]
    """A plant's parameter, a key of the mission's or of the robot's file, a condition of the link."""
    values: Annotated[tuple[Number, ...] | None, Field(strict=False)] = None
    least: Finite | None = None
    most: Finite | None = None
    steps: Annotated[int, Field(ge=2)] = 5
    """Values of a range in a grid, both ends included."""
    log: bool = False
    """The range is even in its logarithm."""

    @model_validator(mode="after")
    def _has_one_of_both(self) -> Self:
        ends = self.least, self.most
        if (self.values is None) == (ends == (None, None)):
            raise ValueError("needs either `values`, or `least` and `most`")
        if self.values is not None:
            if not self.values:
                raise ValueError("`values` is empty")
            return self
        if self.least is None or self.most is None or not self.least < self.most:
            raise ValueError("needs `least` below `most`")
        if self.log and self.least <= 0.0:
            raise ValueError("an even logarithm needs `least` above 0")
        return self

    def at(self, share: float) -> Any:
        """Return the value at a share of the range, 0 to 1; of `values` the one at this place."""
        if self.values is not None:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        least, most = self.range
        return least * (most / least) ** share if self.log else least + (most - least) * share

    @property
    def range(self) -> tuple[float, float]:
        """Both ends; of `values` no range."""
        return (math.nan if self.least is None else self.least, math.nan if self.most is None else self.most)

    @property
    def grid(self) -> tuple[Any, ...]:
        """The values of a grid."""
        if self.values is not None:
            return self.values
        return tuple(self.at(place / (self.steps - 1)) for place in range(self.steps))


class Require(Table):
    """What a run must hold to; one that does not has failed."""

    key: str = ""
    """A number of the summary."""
    least: Finite | None = None
    most: Finite | None = None
    never: str = ""
    """An interlock that must not become active."""
    always: str = ""
    """An interlock that must become active."""

    @model_validator(mode="after")
    def _states_something(self) -> Self:
        if bool(self.key) + bool(self.never) + bool(self.always) != 1:
            raise ValueError("needs one of `key`, `never` and `always`")
        if bool(self.key) == (self.least is None and self.most is None):
            raise ValueError("`least`, `most` or both go with `key`, and with nothing else")
        return self


class AllFaults(Table):
    """Every failure that the robot can have, one in each run."""

    all_at_s: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    for_s: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    """Length of those that end; None: as long as the mission."""


FaultRows = tuple[dict[str, Any], ...]


class Campaign(Table):
    """A whole campaign, checked by itself; robots and missions are checked by `plan`."""

    title: str = ""
    robots: Texts
    missions: Texts
    protocols: Annotated[tuple[str, ...], Field(min_length=1, strict=False)] = ("",)
    """Protocols of serial lines, or firmware of boards; "": as in the robot file."""
    seeds: Annotated[int, Field(ge=1)] | Annotated[tuple[int, ...], Field(min_length=1, strict=False)] = 1
    """Seeds, or how many of them, from 0 on."""
    faults: AllFaults | Annotated[FaultRows, Field(min_length=1, strict=False)] = ({},)
    """Faults beside the mission's own, one in each run; {} is a run without."""
    sample: Literal["grid", "random", "latin_hypercube", "sobol"] = "grid"
    samples: Annotated[int, Field(ge=1)] | None = None
    """How often the parameters are drawn."""
    draw_seed: Annotated[int, Field(ge=0)] = 0
    parameter: Annotated[tuple[Varied, ...], Field(strict=False)] = ()
    require: Annotated[tuple[Require, ...], Field(strict=False)] = ()

    @property
    def each_seed(self) -> tuple[int, ...]:
        """The seeds."""
        return tuple(range(self.seeds)) if isinstance(self.seeds, int) else self.seeds

    @model_validator(mode="after")
    def _samples_go_with_draws(self) -> Self:
        if (self.samples is not None) != (self.sample in DRAWN):
            raise ValueError(f"`samples` goes with sample = {', '.join(DRAWN)}, which need it")
        paths = [row.path for row in self.parameter]
        if twice := {path for path in paths if paths.count(path) > 1}:
            raise ValueError(f"given twice: {', '.join(sorted(twice))}")
        if len(set(self.each_seed)) < len(self.each_seed) or min(self.each_seed) < 0:
            raise ValueError("seeds are different numbers from 0 on")
        return self


def parse(text: str, file: str) -> Campaign:
    """Read a campaign from TOML text; CampaignError, which `file` names, with every mistake."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise CampaignError(file, Problem("", f"not valid TOML: {error}")) from error
    try:
        return Campaign.model_validate(table)
    except ValidationError as error:
        raise CampaignError(file, *problems_of(error, Campaign)) from error


def load(path: Path) -> Campaign:
    """Read a campaign file; CampaignError where it is missing, unreadable or wrong."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CampaignError(str(path), Problem("", f"cannot be read: {error}")) from error
    return parse(text, str(path))
