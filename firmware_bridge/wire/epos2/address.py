"""Names for the objects that code refers to; every object stands in the object table."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True, order=True)
class Address:
    """Where an object lives in the dictionary."""

    index: int
    subindex: int = 0

    def __str__(self) -> str:
        """Write it as the manuals do: 0x6040 or 0x1018:01."""
        return f"0x{self.index:04X}" if self.subindex == 0 else f"0x{self.index:04X}:{self.subindex:02X}"


DEVICE_TYPE: Final = Address(0x1000)
ERROR_REGISTER: Final = Address(0x1001)
ERROR_HISTORY_COUNT: Final = Address(0x1003)
COB_ID_SYNC: Final = Address(0x1005)
DEVICE_NAME: Final = Address(0x1008)
COB_ID_EMERGENCY: Final = Address(0x1014)
CONSUMER_HEARTBEAT_1: Final = Address(0x1016, 1)
CONSUMER_HEARTBEAT_2: Final = Address(0x1016, 2)
PRODUCER_HEARTBEAT: Final = Address(0x1017)
VENDOR_ID: Final = Address(0x1018, 1)
PRODUCT_CODE: Final = Address(0x1018, 2)
REVISION: Final = Address(0x1018, 3)
SERIAL_NUMBER: Final = Address(0x1018, 4)
ENCODER_COUNTER: Final = Address(0x2020)
CURRENT_AVERAGED: Final = Address(0x2027)
VELOCITY_AVERAGED: Final = Address(0x2028)
CURRENT_MODE_SETTING: Final = Address(0x2030)
CURRENT_DEMAND: Final = Address(0x2031)
POSITION_MODE_SETTING: Final = Address(0x2062)
VELOCITY_MODE_SETTING: Final = Address(0x206B)
ANALOGUE_INPUT_1: Final = Address(0x207C, 1)
ANALOGUE_INPUT_2: Final = Address(0x207C, 2)
FOLLOWING_ERROR: Final = Address(0x20F4)
ENCODER_PULSES: Final = Address(0x2210, 1)
SENSOR_TYPE: Final = Address(0x2210, 2)
ABORT_CONNECTION_OPTION: Final = Address(0x6007)
CONTROLWORD: Final = Address(0x6040)
STATUSWORD: Final = Address(0x6041)
SHUTDOWN_OPTION: Final = Address(0x605B)
DISABLE_OPTION: Final = Address(0x605C)
FAULT_REACTION_OPTION: Final = Address(0x605E)
MODE: Final = Address(0x6060)
MODE_DISPLAY: Final = Address(0x6061)
POSITION_DEMAND: Final = Address(0x6062)
POSITION_ACTUAL: Final = Address(0x6064)
MAX_FOLLOWING_ERROR: Final = Address(0x6065)
POSITION_WINDOW: Final = Address(0x6067)
POSITION_WINDOW_TIME: Final = Address(0x6068)
VELOCITY_DEMAND: Final = Address(0x606B)
VELOCITY_ACTUAL: Final = Address(0x606C)
VELOCITY_WINDOW: Final = Address(0x606D)
VELOCITY_WINDOW_TIME: Final = Address(0x606E)
CURRENT_ACTUAL: Final = Address(0x6078)
TARGET_POSITION: Final = Address(0x607A)
MIN_POSITION_LIMIT: Final = Address(0x607D, 1)
MAX_POSITION_LIMIT: Final = Address(0x607D, 2)
MAX_PROFILE_VELOCITY: Final = Address(0x607F)
PROFILE_VELOCITY: Final = Address(0x6081)
PROFILE_ACCELERATION: Final = Address(0x6083)
PROFILE_DECELERATION: Final = Address(0x6084)
QUICK_STOP_DECELERATION: Final = Address(0x6085)
MOTION_PROFILE_TYPE: Final = Address(0x6086)
MAX_ACCELERATION: Final = Address(0x60C5)
CURRENT_P: Final = Address(0x60F6, 1)
CURRENT_I: Final = Address(0x60F6, 2)
VELOCITY_P: Final = Address(0x60F9, 1)
VELOCITY_I: Final = Address(0x60F9, 2)
VELOCITY_FEEDFORWARD: Final = Address(0x60F9, 4)
VELOCITY_ACCELERATION_FEEDFORWARD: Final = Address(0x60F9, 5)
POSITION_P: Final = Address(0x60FB, 1)
POSITION_I: Final = Address(0x60FB, 2)
POSITION_D: Final = Address(0x60FB, 3)
POSITION_VELOCITY_FEEDFORWARD: Final = Address(0x60FB, 4)
POSITION_ACCELERATION_FEEDFORWARD: Final = Address(0x60FB, 5)
TARGET_VELOCITY: Final = Address(0x60FF)
MOTOR_TYPE: Final = Address(0x6402)
CONTINUOUS_CURRENT_LIMIT: Final = Address(0x6410, 1)
OUTPUT_CURRENT_LIMIT: Final = Address(0x6410, 2)
MAX_MOTOR_SPEED: Final = Address(0x6410, 4)
THERMAL_TIME_CONSTANT: Final = Address(0x6410, 5)
SUPPORTED_MODES: Final = Address(0x6502)
