"""The requests and answers of MWProtocol's commands: one value class each."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class GetServerInfo:
    """Ask who is there; it puts the lamp on pin 13 on."""


@dataclass(frozen=True, slots=True)
class ResetPins:
    """Make all pins inputs."""


@dataclass(frozen=True, slots=True)
class GetFreeRam:
    """Ask for the bytes between heap and stack."""


@dataclass(frozen=True, slots=True)
class WriteDigital:
    """Set a pin; `analog` 1 counts pins from A0."""

    analog: int
    pin: int
    level: int


@dataclass(frozen=True, slots=True)
class ReadDigital:
    """Ask for a pin's level."""

    analog: int
    pin: int


@dataclass(frozen=True, slots=True)
class ConfigureDigital:
    """Make a pin an input (0), an output (1), or an input with pull-up (2)."""

    analog: int
    pin: int
    mode: int


@dataclass(frozen=True, slots=True)
class WriteDuty:
    """Put a PWM of 0 to 255 on a pin."""

    pin: int
    value: int


@dataclass(frozen=True, slots=True)
class WriteVoltage:
    """Put a PWM of 0 to 255 on a pin, requested as a voltage."""

    pin: int
    value: int


@dataclass(frozen=True, slots=True)
class PlayTone:
    """Sound a pin, in Hz and ms."""

    pin: int
    frequency: int
    duration: int


@dataclass(frozen=True, slots=True)
class ReadVoltage:
    """Ask for an analog input, counted from A0."""

    pin: int


@dataclass(frozen=True, slots=True)
class CreateShield:
    """Set a motor shield up, at an I2C address, with a PWM frequency in Hz."""

    shield: int
    address: int
    frequency: int


@dataclass(frozen=True, slots=True)
class DeleteShield:
    """Forget a shield."""

    shield: int


@dataclass(frozen=True, slots=True)
class CreateMotor:
    """Make a motor 0 to 3 usable."""

    shield: int
    motor: int


@dataclass(frozen=True, slots=True)
class StartMotor:
    """Set a motor's speed 0 to 255 and direction: 1 forwards, 2 back."""

    shield: int
    motor: int
    speed: int
    direction: int


@dataclass(frozen=True, slots=True)
class StopMotor:
    """Release a motor."""

    shield: int
    motor: int


@dataclass(frozen=True, slots=True)
class SetMotorSpeed:
    """Set a motor's speed and direction, as `StartMotor`."""

    shield: int
    motor: int
    speed: int
    direction: int


@dataclass(frozen=True, slots=True)
class AttachEncoder:
    """Count on two pins, from 0."""

    encoder: int
    pin_a: int
    pin_b: int


@dataclass(frozen=True, slots=True)
class DetachEncoder:
    """Count no longer."""

    encoder: int


@dataclass(frozen=True, slots=True)
class SetDelay:
    """Set the time for which edges are ignored."""

    encoder: int
    delay: int


@dataclass(frozen=True, slots=True)
class ReadCount:
    """Ask for a count, and set it to 0 where `reset` is not 0."""

    encoder: int
    reset: int


@dataclass(frozen=True, slots=True)
class ReadSpeed:
    """Ask for the counts of 20 ms, of several encoders: one byte each."""

    encoders: bytes


@dataclass(frozen=True, slots=True)
class WriteCount:
    """Set a count."""

    encoder: int
    count: int


@dataclass(frozen=True, slots=True)
class Done:
    """An answer without data."""


@dataclass(frozen=True, slots=True)
class ServerInfo:
    """The board's identity: version, board, tracing, and its libraries in the order of their numbers."""

    major: int
    minor: int
    board: bytes
    traces: int
    libraries: tuple[bytes, ...]


@dataclass(frozen=True, slots=True)
class FreeRam:
    """Free memory in bytes."""

    free: int


@dataclass(frozen=True, slots=True)
class Level:
    """Of a pin: 0 or 1."""

    level: int


@dataclass(frozen=True, slots=True)
class Voltage:
    """Of an analog input: 0 to 1023."""

    raw: int


@dataclass(frozen=True, slots=True)
class Count:
    """Of an encoder, with the board's milliseconds, and how often the count has gone over its end."""

    count: int
    millis: int
    overflow: int


@dataclass(frozen=True, slots=True)
class Speeds:
    """Encoder counts of 20 ms, three bytes an encoder: overflow, and the difference, low byte first."""

    raw: bytes
