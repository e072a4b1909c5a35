"""The EPOS2 as a family of emulated devices: drives above a plant, their CAN bus and their serial line."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Final

from emulators.epos2.drive import Epos2
from emulators.epos2.mounted import Comparison, Mounted
from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.device_profile import DeviceProfile, numbered, realistic
from emulators.epos2.options import Epos2Options
from emulators.epos2.presence import DeviceTypeRead
from emulators.epos2.serial.serial_drive import SerialEpos2
from emulators.family import (
    BridgeLink,
    BuildOrder,
    Built,
    CanBus,
    Devices,
    EmulatedFamily,
    Lane,
    Line,
    LineRun,
    Plan,
    Station,
    TimedLink,
    Trait,
    Way,
)
from emulators.parameter_files import Storages
from emulators.servo.axis import TICK, ServoAxis
from emulators.servo.fmu_axes import SUPPLY, axis_needs, fmu_bank, set_motor
from emulators.servo.pins import SWITCHES, input_lines
from emulators.wires import PlayedLine, SerialWire, usb
from emulators.wires.adapter import Adapter
from emulators.wires.serial import Inbox
from firmware_bridge.families.epos2.driver.serial.line import MaxonLine
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.settings import Epos2AnalogueInput, Epos2Axis, Epos2Driver, Epos2Link
from firmware_bridge.node import CAN, SERIAL, Node
from firmware_bridge.robot import AnyRobot, Axis, Problem, RobotFileError
from firmware_bridge.units import MICROSECOND, MILLISECOND, Nanoseconds
from fmu.plant import FmuPlant

if TYPE_CHECKING:
    from emulators.cli.emulate_robot import RobotOptions
    from emulators.cli.emulation import Emulation
    from emulators.new_drive import AxisDrive, AxisTable


def _plans(order: BuildOrder) -> tuple[Plan, ...]:
    axes, turned = _axes(order.robot), _turned(order.robot)
    needs = axis_needs([axis.name for axis in axes], (SUPPLY,), mirrored=turned)
    return (Plan(title="EPOS2 drives", needs=needs, build=partial(_built, order), every=TICK, follows=False),)


def _built(order: BuildOrder, plant: FmuPlant, _leads: bool) -> Built:  # noqa: FBT001 - it always leads
    robot, options = order.robot, order.option(Epos2Options) or Epos2Options()
    _have_switches(robot, plant)
    axes = _axes(robot)
    mounted = [Mounted.of(Epos2Axis.of(axis)) for axis in axes]
    servos = [ServoAxis(axis.name, one.counts) for axis, one in zip(axes, mounted, strict=True)]
    for servo, one in zip(servos, mounted, strict=True):
        one.mount(servo)
        set_motor(plant, servo)
    bank = fmu_bank(plant, servos, plant.output_names.index(SUPPLY), _supply_input(robot), _turned(robot))
    kept = order.option(Storages)
    storages = {} if kept is None else kept.by_axis
    serial = options.serial
    if serial is None:
        serial = _served(robot) if order.on_lines else {}
    stations: dict[str, Station] = {}
    for axis, servo, one in zip(axes, servos, mounted, strict=True):
        name, node = axis.name, Epos2Axis.of(axis).node
        profile = _profile(axis, realistic_latency=order.realistic_latency)
        storage = storages.get(name)
        if name in serial:
            drive: Epos2 = SerialEpos2(node, servo, profile, generation=serial[name], storage=storage)
        else:
            drive = Epos2(node, servo, profile, storage=storage)
        ways = {CAN: Way.BUS, **({SERIAL: Way.LINE} if name in serial else {})}
        stations[name] = Station(drive, axis.link, ways)
        if order.report is not None:
            # It hooks the store, which keeps it alive.
            Comparison(one, drive.store, partial(_named, name, order.report))
    return Built(stations, bank)


def _named(name: str, report: Callable[[str], None], text: str) -> None:
    report(f"'{name}': {text}")


def _axes(robot: AnyRobot) -> list[Axis]:
    links = Epos2Link.all_of(robot)
    return [axis for axis in robot.axes if axis.link in links]


def _turned(robot: AnyRobot) -> list[str]:
    """Return the axes whose motor is mounted the other way round: its forwards is the axis's backwards."""
    return [axis.name for axis in _axes(robot) if axis.direction < 0]


def _served(robot: AnyRobot) -> dict[str, Generation]:
    """Return the axes whose drive has the bridge on its serial port."""
    links = Epos2Link.all_of(robot)
    return {
        axis.name: links[axis.link].protocol
        for axis in _axes(robot)
        if links[axis.link].driver is Epos2Driver.SERIAL
        and Epos2Axis.of(axis).node == links[axis.link].gateway
    }


def _have_switches(robot: AnyRobot, plant: FmuPlant) -> None:
    """Check that the plant has the switches by which axes are homed; RobotFileError."""
    axes = _axes(robot)
    # With mirrored axes: the plant's negative switch ends the drive's positive direction.
    wired = input_lines(plant.output_names, [axis.name for axis in axes], _turned(robot))
    closed = {(axes[line.axis].name, line.mask) for line in wired}
    for index, axis in enumerate(robot.axes):
        if axis not in axes or axis.zero.homing is None:
            continue
        switch = axis.zero.homing.goes_by.switch
        if switch is not None and (axis.name, 1 << SWITCHES[switch] - 1) not in closed:
            problem = f"goes by a switch; the plant has no output '{switch}_{axis.name}'"
            raise RobotFileError(robot.name, Problem(f"axes[{index}].zero.homing.method", problem))


def _supply_input(robot: AnyRobot) -> tuple[str, float] | None:
    """Return the axis whose first analog input sees the supply, and the divider before that input."""
    if robot.battery is None:
        return None
    sensor = next(sensor for sensor in robot.sensors if sensor.name == robot.battery.sensor)
    settings = sensor.settings
    return (settings.axis, settings.per_volt) if isinstance(settings, Epos2AnalogueInput) else None


def _profile(axis: Axis, *, realistic_latency: bool) -> DeviceProfile:
    """Return the type of drive that the file names, with a serial number of its own: no two are the same."""
    settings = Epos2Axis.of(axis)
    # The type decides currents, supply and objects; the number in its serial number is the node's.
    kind = PROFILES[settings.device.value]
    kind = realistic(kind) if realistic_latency else kind
    return numbered(kind, settings.node)


@dataclass(frozen=True, slots=True)
class MaxonSerialLine:
    """The serial line between the bridge and the port of one drive."""

    wire: SerialWire
    adapter: Adapter
    end: MaxonLine
    link: TimedLink

    def lane(self, kind: str, player: str) -> Lane:
        """Return a line on which a recording's bytes arrive as they did: only it has their times."""
        played = PlayedLine(self.wire.baud, player, self.link.name)
        return Lane(kind, played, played.duration)

    def carried(self, robot: AnyRobot, duration: Nanoseconds, devices: Devices) -> LineRun:
        """Return what the line has carried in a run so long."""
        del devices
        table = Epos2Link.of_link(robot, self.link.name)
        return LineRun(
            link=self.link.name,
            protocol=table.protocol.value,
            baud=table.line_rate,
            bytes=self.wire.bytes,
            commands=self.end.commands,
            busy_percent=round(100.0 * self.end.busy / duration, 3),
            cycle_ms=float(robot.cycle_ms),
            longest_cycle_ms=self.link.longest_cycle / MILLISECOND,
            late_cycles=self.link.late,
        )


def _line(
    robot: AnyRobot, node: Node, link: BridgeLink, host: str, before: Line | None
) -> MaxonSerialLine | None:
    table = Epos2Link.of_link(robot, link.name)
    if table.driver is not Epos2Driver.SERIAL or not isinstance(link, TimedLink):
        return None
    latency = table.port_latency_us * MICROSECOND
    # Without a latency bytes are handed over one by one, as on a plain UART.
    inboxes = {host: Inbox(usb.BUFFER, latency)} if latency else {}
    end = MaxonLine(node, table.protocol, link.name)
    adapter = Adapter(end, link.name)
    if not isinstance(before, MaxonSerialLine):
        return MaxonSerialLine(SerialWire(table.line_rate, inboxes), adapter, end, link)
    # The cable outlives the process: its plug and its counts go on.
    adapter.plugged, end.commands, end.busy = before.adapter.plugged, before.end.commands, before.end.busy
    return MaxonSerialLine(before.wire, adapter, end, link)


def _bus(robot: AnyRobot, link: str) -> CanBus:
    table = Epos2Link.of_link(robot, link)
    return CanBus(table.bit_rate, table.bridge_node)


def _on_ports(robot: AnyRobot, given: "RobotOptions") -> "Emulation":
    from emulators.epos2.commands.robot import emulate_drives  # noqa: PLC0415 - a command's own

    return emulate_drives(robot, given)


def _axis_table(drive: "AxisDrive") -> "AxisTable":
    from emulators.epos2.starter.axis import axis_table  # noqa: PLC0415 - only `new` needs it

    return axis_table(drive)


def _alone() -> AnyRobot:
    from emulators.epos2.commands.emulate import alone_on_bus  # noqa: PLC0415 - a command's own

    return alone_on_bus({"motor1": 1})


FAMILY: Final = EmulatedFamily(
    links=(Epos2Link,),
    plans=_plans,
    bus=_bus,
    line=_line,
    traits=frozenset({Trait.DRIVE, Trait.ENCODER}),
    alone=_alone,
    on_ports=_on_ports,
    axis_table=_axis_table,
    presence=DeviceTypeRead,
)
