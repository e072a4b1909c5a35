"""An Arduino with a motor shield in a robot file: its serial line, and one motor at its terminals."""

import math
from enum import StrEnum
from typing import Annotated, Final, Self

from pydantic import Field, model_validator

from firmware_bridge.robot.table import AxisTable, NonNegative, Positive, RequestTable, Table
from firmware_bridge.units import MILLISECOND, RPM_PER_RAD_S, Nanoseconds

FULL_PWM: Final = 255
"""Of the shield's library and of all four firmwares."""


RUNS_ON: Final = "its motors run on as commanded when the bridge ends, is killed, or the line is cut"
SKETCH: Final = (
    "flash this project's sketch (emulators/arduino_omni/sketch, protocol ros-arduino-bridge), which stops "
    "them after 2 s"
)


class ShieldDriver(StrEnum):
    """The bridge's connection to the motors."""

    MOTOR_SHIELD = "motor-shield"


class ShieldProtocol(StrEnum):
    """The protocol of the board's firmware."""

    MW = "mw"
    """MWProtocol, of MATLAB's package."""
    ROS_ARDUINO_BRIDGE = "ros-arduino-bridge"
    """With a third motor, and a speed loop on the board."""
    ARDUINOIO = "arduinoio"
    """MATLAB's older package, sketch motor_v2."""
    FIRMATA = "firmata"
    """The shield's chip by I2C, and ConfigurableFirmata's encoders."""


BAUDS: Final = {
    ShieldProtocol.MW: 115_200,
    ShieldProtocol.ROS_ARDUINO_BRIDGE: 57_600,
    ShieldProtocol.ARDUINOIO: 115_200,
    ShieldProtocol.FIRMATA: 57_600,
}
"""As each firmware is published."""
BOOTS_MS: Final = {
    ShieldProtocol.MW: 1_200,
    ShieldProtocol.ROS_ARDUINO_BRIDGE: 1_200,
    ShieldProtocol.ARDUINOIO: 1_200,
    ShieldProtocol.FIRMATA: 3_300,
}
"""From a reset until a firmware listens: its loader's second, and the version that Firmata blinks."""
CYCLES_MS: Final = {
    ShieldProtocol.MW: 100,
    ShieldProtocol.ROS_ARDUINO_BRIDGE: 50,
    ShieldProtocol.ARDUINOIO: 50,
    ShieldProtocol.FIRMATA: 50,
}
"""Shortest cycle of a line with three motors: MWProtocol answers each command before it takes the next."""
ENCODERS: Final = {
    ShieldProtocol.MW: 2,
    ShieldProtocol.ROS_ARDUINO_BRIDGE: 3,
    ShieldProtocol.ARDUINOIO: 2,
    ShieldProtocol.FIRMATA: 2,
}
"""Encoders that a firmware reads: as published, but forks have added ros_arduino_bridge's third motor."""


class ShieldDevice(StrEnum):
    """The driver board of the motor."""

    MOTOR_SHIELD_V2 = "motor-shield-v2"


class BoardGains(Table):
    """Of the loop on the board (ros_arduino_bridge's `u`): whole numbers, Ko divides the others."""

    kp: Annotated[int, Field(ge=0, le=1_000)] = 20
    kd: Annotated[int, Field(ge=0, le=1_000)] = 12
    ki: Annotated[int, Field(ge=0, le=1_000)] = 0
    ko: Annotated[int, Field(ge=1, le=1_000)] = 50


class ShieldLink(RequestTable):
    """The serial line to a board, and the time-outs."""

    driver: Annotated[ShieldDriver, Field(strict=False)]
    protocol: Annotated[ShieldProtocol, Field(strict=False)]
    encoders: Annotated[int, Field(ge=0, le=4)] | None = None
    """Number of encoders that the firmware reads; None: as published."""
    boots_ms: Annotated[int, Field(ge=0, le=10_000)] | None = None
    """Silence after a reset; None: as the firmware is published.

    A byte in its first second keeps a Mega's boot loader for 9 s.
    """
    boots_within_ms: Annotated[int, Field(ge=100, le=20_000)] = 5_000
    """From a reset, which opening the port may be, to the first answer."""
    stop_confirmed_ms: Annotated[int, Field(ge=10, le=10_000)] | None = None
    """Longest time of the board's or encoders' report of a stop stage; None: three of the link's cycles."""
    auto_stop_ms: Annotated[int, Field(ge=10, le=32_767)] = 2_000
    """Timeout after which ros_arduino_bridge stops its motors; as it was compiled."""
    gains: BoardGains = BoardGains()
    accept_no_watchdog: bool = False
    """The robot may be driven though nothing stops its motors when the bridge ends or the line is cut."""

    @property
    def kind(self) -> str:
        """The firmware's protocol."""
        return self.protocol

    @property
    def described(self) -> str:
        """Firmware and rate."""
        return f"({self.protocol.value}, {self.rate} Bd)"

    @property
    def silent_hint(self) -> str:
        """Power and firmware of the board."""
        return (
            f"nothing was received on the line at {self.rate} Bd: is the board on, and was it flashed "
            f"with {self.protocol.value} (--protocol)?"
        )

    @property
    def unwatched(self) -> str:
        """Its motors run on when the bridge falls silent, where the firmware has no auto-stop."""
        return "" if self.stops_itself else f"a board with {self.protocol.value} has no watchdog: {RUNS_ON}"

    @property
    def unwatched_remedy(self) -> str:
        """Another firmware."""
        return SKETCH

    @property
    def accepts_unwatched(self) -> bool:
        """True where the robot file permits it."""
        return self.accept_no_watchdog

    @property
    def rate(self) -> int:
        """Bit rate of the line, bit/s."""
        return BAUDS[self.protocol]

    @property
    def boots(self) -> int:
        """Milliseconds from a reset until it may be spoken to."""
        return BOOTS_MS[self.protocol] if self.boots_ms is None else self.boots_ms

    @property
    def counted(self) -> int:
        """Number of encoders that are read."""
        return ENCODERS[self.protocol] if self.encoders is None else self.encoders

    @property
    def stock(self) -> bool:
        """True where the firmware reads so many as it is published."""
        return self.counted <= ENCODERS[self.protocol]

    @property
    def stops_itself(self) -> bool:
        """True where the board stops its motors when it receives nothing."""
        return self.protocol is ShieldProtocol.ROS_ARDUINO_BRIDGE

    def confirmed(self, cycle: Nanoseconds) -> Nanoseconds:
        """Return the time for the confirmation of a stop stage; `cycle` is the robot's."""
        own = self.stop_confirmed_ms
        return super().confirmed(cycle) if own is None else own * MILLISECOND

    def over(self, protocol: ShieldProtocol, cycle_ms: int, encoders: int | None) -> Self:
        """Return this line to a board with another firmware; the robot's cycle is `cycle_ms`."""
        # Rounded up: a line that needs 100 ms takes every second cycle of 50 ms.
        every = max(1, -(-CYCLES_MS[protocol] // cycle_ms))
        return self.model_copy(update={"protocol": protocol, "every": every, "encoders": encoders})


class Regulator(Table):
    """The bridge's own loop of a motor's speed, for firmwares without one; PWM counts of 255."""

    p: NonNegative
    """PWM for each rad/s that the axis is too slow."""
    i: NonNegative
    """... and for each rad that it is behind."""
    start: NonNegative
    """PWM at which the motor overcomes its friction."""


class ShieldAxis(AxisTable):
    """One motor and its encoder."""

    port: Annotated[int, Field(ge=1, le=4)]
    """The shield's terminals, M1 to M4; the encoder of the first is the board's first."""
    device: Annotated[ShieldDevice, Field(strict=False)]
    motor: str
    encoder_pins: Annotated[tuple[int, int], Field(strict=False)]
    """Pins of channels A and B."""
    counts_per_turn: Annotated[int, Field(ge=4, le=100_000)]
    """Of the motor's shaft, all edges."""
    full_speed_rpm: Positive
    """Of the motor at full PWM, without load."""
    max_pwm: Annotated[int, Field(ge=1, le=FULL_PWM)] = FULL_PWM
    """Largest PWM of a command."""
    slope_pwm_s: Positive
    """The PWM changes no faster, in counts a second."""
    acceleration: Positive
    """With which the axis follows the least, in its unit a second squared."""
    continuous_current_ma: Annotated[int, Field(ge=1, le=100_000)]
    peak_current_ma: Annotated[int, Field(ge=1, le=100_000)]
    regulator: Regulator

    @model_validator(mode="after")
    def _the_peak_is_the_peak(self) -> Self:
        if self.peak_current_ma < self.continuous_current_ma:
            raise ValueError("peak_current_ma must not be below continuous_current_ma")
        return self

    @property
    def number(self) -> int:
        """The number by which the motor is called on its link."""
        return self.port

    @property
    def address(self) -> str:
        """The motor as text."""
        return f"motor M{self.port}"

    def slowest_ramp(self, ratio: float) -> float:
        """Return the gentlest acceleration of the axis; the regulator's, whatever the gear of `ratio`."""
        del ratio
        return self.acceleration

    def cruise(self, ratio: float) -> float:
        """Return its top speed behind a gear of `ratio`; it goes to no position by itself."""
        return self.full_speed_rpm / RPM_PER_RAD_S / ratio

    def furthest(self, ratio: float) -> float:
        """Return how far from 0 a travel may go: not at all, nothing on the board keeps to one."""
        del ratio
        return 0.0

    def counts_per_unit(self, ratio: float) -> float:
        """Return the counts for each unit of the axis, with `ratio` rad of the motor for each."""
        return self.counts_per_turn * ratio / math.tau
