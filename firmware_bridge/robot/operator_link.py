"""The operator's link in a robot file: timeout, age of commands, identity on MAVLink."""

from enum import StrEnum
from typing import Annotated, Final, Self

from pydantic import Field, field_validator

from firmware_bridge.robot.problems import Problem, RobotFileError
from firmware_bridge.robot.table import Table

MILLISECONDS: Final = 1000.0
LEAST_AGE_MS: Final = 50


class UnknownAge(StrEnum):
    """Treatment of a motion command of unknown age."""

    DRIVE = "drive"
    """It is obeyed, under the rule of silence; so it is where no key is set."""
    REFUSE = "refuse"
    """It moves nothing; so it is where only signed commands are accepted."""


class TelemetryProfile(StrEnum):
    """Periods of the robot's telemetry."""

    USUAL = "usual"
    """Each message as often as a ground station needs it."""
    THESIS = "thesis"
    """Each field of the packet of A. P. Das, PhD thesis, IIT Delhi, 2018, Fig. 4.3, at its 20 Hz."""


class Telemetry(Table):
    """The telemetry to ground stations: how often each message is sent without a request."""

    profile: Annotated[TelemetryProfile, Field(strict=False)] = TelemetryProfile.USUAL
    """`thesis`: pose, the robot's own values, axis speeds, motor currents and battery, all at 20 Hz.

    On a link too narrow for that, by `bandwidth_bit_s`, its slower periods count.
    """


class OperatorLink(Table):
    """The operator's link: its timeout, the age limit of commands, the identity on MAVLink."""

    silent_ms: Annotated[int, Field(ge=50, le=10_000)]
    lost_ms: Annotated[int, Field(ge=1_000, le=60_000)] = 10_000
    """After so long a silence the robot is disarmed."""
    max_age_ms: Annotated[int, Field(ge=50, le=2_000)] = 500
    """No older motion command is obeyed; a stop command is, however old."""
    max_age_ceiling_ms: Annotated[int, Field(ge=50, le=2_000)] = 2_000
    """So far an order for a session may widen that; the robot is slower then."""
    agreed_ms: int | None = None
    """The age of such an order."""
    unknown_age: Annotated[UnknownAge, Field(strict=False)] | None = None
    """Treatment of motion commands of unknown age; without it the key decides."""
    bandwidth_bit_s: Annotated[int, Field(ge=4_800, le=1_000_000_000)] | None = None
    """Bit rate of the link, as of a telemetry radio's serial line; without it the link counts as a network.

    Telemetry takes at most half of it.
    """
    telemetry: Telemetry = Telemetry()
    system_id: Annotated[int, Field(ge=1, le=255)]
    component_id: Annotated[int, Field(ge=1, le=255)]

    @field_validator("agreed_ms")
    @classmethod
    def _is_agreed_in_a_session(cls, given: int | None) -> int | None:
        if given is None:
            return None
        raise ValueError("is agreed on for one session: use --max-delay, or max_delay_s in a mission")

    @property
    def age_limit_ms(self) -> int:
        """Age limit of a motion command in this session."""
        return self.max_age_ms if self.agreed_ms is None else self.agreed_ms

    @property
    def speed_share(self) -> float:
        """Permitted share of the robot's top speed in this session."""
        # Speed times age stays constant; a delay that is agreed to be shorter makes no robot faster.
        return min(self.max_age_ms / self.age_limit_ms, 1.0)

    def agreed_on(self, max_delay_s: float, robot: str) -> Self:
        """Return the same link in a session with commands of this age; RobotFileError above the ceiling."""
        agreed, ceiling = MILLISECONDS * max_delay_s, self.max_age_ceiling_ms
        if not LEAST_AGE_MS <= agreed <= ceiling:
            problem = f"a delay of {max_delay_s:g} s was requested; {LEAST_AGE_MS} to {ceiling} ms may be"
            raise RobotFileError(robot, Problem("operator.max_age_ceiling_ms", problem))
        return self.model_copy(update={"agreed_ms": round(agreed)})
