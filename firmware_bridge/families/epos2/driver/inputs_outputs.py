"""Sensors and outputs at the pins of an EPOS2: its objects read and written beside the drive's tasks."""

from collections.abc import Iterable, Mapping
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.sdo_client import SdoError, Transfer
from firmware_bridge.canopen_drive.driver.object_request import ObjectRequest
from firmware_bridge.canopen_drive.driver.object_sensor import IoDrive, MeasuredObject, ObjectSensor
from firmware_bridge.drivers.driver import Level
from firmware_bridge.drivers.life_cycle import DriverState
from firmware_bridge.families.epos2.driver.product import general_purpose
from firmware_bridge.families.epos2.settings import Epos2AnalogueInput, Epos2DigitalOutput
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.functions import OUTPUT_STATE
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Axis, Output, Sensor
from firmware_bridge.units import Nanoseconds

MILLIVOLTS: Final = 1000.0
_STATE: Final = DataType.UNSIGNED16


class DigitalOutputs:
    """The outputs of one drive (0x2078); a `firmware_bridge.drivers.driver.OutputDriver`.

    Leaving, the bridge does not touch them: whether a magnet or a lamp goes out then is for the robot.
    """

    def __init__(self, outputs: tuple[Output, ...], drive: IoDrive) -> None:
        self.outputs: Final = outputs
        self._drive: Final = drive
        self._bits: Final = {
            output.name: general_purpose(Epos2DigitalOutput.of(output).output).bit for output in outputs
        }
        self._wanted = 0
        self._confirmed: int | None = None
        """The value that the drive has accepted last; None where that is not known."""
        self._set_up = 0
        """In which set-up of the drive that was."""
        self._request: ObjectRequest | None = None

    def switch(self, levels: Mapping[str, Level], now: Nanoseconds) -> tuple[Packet, ...]:
        """Write the outputs' state where the drive has not confirmed it; one that is left out stays."""
        for name, bit in self._bits.items():
            level = levels.get(name)
            if level is not None:
                self._wanted = self._wanted | bit if level.on else self._wanted & ~bit
        self._take()
        if self._drive.state not in (DriverState.INACTIVE, DriverState.ACTIVE):
            return ()
        if self._set_up != self._drive.set_ups:
            # The drive may have restarted before: its pins are as it makes them then.
            self._set_up, self._confirmed = self._drive.set_ups, None
        if self._request is not None or self._wanted == self._confirmed:
            return ()
        raw = _STATE.encode(self._wanted)
        self._request = ObjectRequest(Transfer(OUTPUT_STATE, raw, attempts=1))
        return self._drive.request(self._request, now)

    def _take(self) -> None:
        request = self._request
        if request is None or not request.over:
            return
        self._request = None
        # Over without an outcome: it may have left or not, so the level is written again.
        taken = request.outcome is not None and not isinstance(request.outcome, SdoError)
        raw = request.transfer.raw
        self._confirmed = _STATE.decode(raw) if taken and raw is not None else None


def inputs_of(robot: AnyRobot, link: str, drives: Iterable[IoDrive]) -> tuple[ObjectSensor, ...]:
    """Return the sensors on a link, in the robot file's order."""
    by_axis = {drive.axis.name: drive for drive in drives}
    return tuple(
        ObjectSensor(sensor, by_axis[Epos2AnalogueInput.of(sensor).axis], _measured(sensor))
        for sensor in robot.sensors
        if sensor.link == link
    )


def _measured(sensor: Sensor) -> MeasuredObject:
    """Return the analog input of a sensor (0x207C, EDS), in mV."""
    settings = Epos2AnalogueInput.of(sensor)
    address = Address(at.ANALOGUE_INPUT_1.index, settings.input)
    return MeasuredObject(address, DataType.INTEGER16, settings.per_volt, MILLIVOLTS)


def outputs_of(robot: AnyRobot, drives: Iterable[IoDrive]) -> tuple[DigitalOutputs, ...]:
    """Return the outputs of these drives, a group for each drive that has any."""
    return tuple(
        DigitalOutputs(outputs, drive) for drive in drives if (outputs := outputs_at(robot, drive.axis))
    )


def outputs_at(robot: AnyRobot, axis: Axis) -> tuple[Output, ...]:
    """Return the outputs at the drive of one axis, in the robot file's order."""
    return tuple(
        output
        for output in robot.outputs
        if output.link == axis.link and Epos2DigitalOutput.of(output).axis == axis.name
    )
