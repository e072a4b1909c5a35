"""Every key of a robot file that describes the machine is followed by the bench, or refused by it."""

import math
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, Final

import pytest

from emulators.arduino_omni.board import Board
from emulators.devices import devices
from emulators.servo.axis import ServoAxis
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot_types import find, names
from firmware_bridge.units import MILLISECOND

MACHINE: Final = {
    "axes.*.ratio",
    "axes.*.direction",
    "axes.*.settings.encoder_lines",
    "axes.*.settings.counts_per_turn",
    "axes.*.settings.encoder_counts",
    "axes.*.settings.speed_units_per_rpm",
    "axes.*.settings.encoder_pins.*",
    "axes.*.settings.port",
    "battery.nominal_v",
    "sensors.battery.settings.per_volt",
    "sensors.joint.settings.per_volt",
    *(f"geometry.base.{key}" for key in ("wheel_radius_m", "wheel_distance_m", "track_m", "rear_track_m")),
    *(f"geometry.base.{key}" for key in ("wheelbase_m", "kingpin_distance_m", "davis_h_m", "crown_radius_m")),
    *(f"geometry.base.{key}" for key in ("pinion_diameter_m", "centre_of_gravity_height_m")),
    "geometry.base.centre_offset_m",
    *(f"geometry.base.base.{key}" for key in ("wheel_radius_m", "wheel_distance_m")),
    *(f"geometry.lift.{key}" for key in ("stages", "link_length_m", "screw_pitch_m")),
    *(f"geometry.lift.{key}" for key in ("collapsed_angle_deg", "extended_angle_deg")),
    *(f"geometry.balance.{key}" for key in ("base_kg", "base_height_m", "arm_height_m", "link_kg.*")),
    *(f"geometry.wall.{key}" for key in ("wheel_n", "caster_n", "friction", "mass_kg", "mass_height_m")),
    *(f"geometry.start.{key}" for key in ("heading_deg", "height_m")),
    "geometry.tank.radius_m",
}
"""Keys of what is built."""
WIDENED: Final = {"axes.*.travel.0": -1.0, "axes.*.travel.1": 1.0}
"""Ends of a way: beyond the plant's own stop they are refused, where it has one."""
OTHERS: Final = (
    *(
        "axes.*.plausibility.",
        "axes.*.settings.gains.",
        "axes.*.settings.profile.",
        "axes.*.settings.regulator.",
    ),
    *("axes.*.top_speed", "axes.*.settings.acceleration", "axes.*.settings.max_pwm"),
    *("axes.*.settings.slope_pwm_s", "axes.*.settings.full_steps_s", "axes.*.settings.full_speed_rpm"),
    *("axes.*.settings.continuous_current_ma", "axes.*.settings.peak_current_ma"),
    *(
        "axes.*.settings.motor_type",
        "axes.*.settings.pole_pairs",
        "axes.*.settings.thermal_time_constant_100ms",
    ),
    *(
        "axes.*.settings.node",
        "axes.*.settings.position_",
        "axes.*.settings.joint",
        "axes.*.settings.product_code",
        "axes.*.settings.vendor_id",
        "axes.*.settings.tuned_for_kg_m2",
        "axes.*.settings.current_object",
        "axes.*.settings.counts_from_deg",
    ),
    *("battery.low_v", "battery.stops_after_s", "cycle_ms", "operator.", "links.", "guard.", "outputs."),
    *("sensors.wall.", "sensors.battery.", "sensors.joint.", "plant."),
    *(f"geometry.{table}." for table in ("limits", "degraded", "control", "paths", "courses", "workspace")),
    *(f"geometry.{table}." for table in ("arm", "base.limits", "base.control", "base.paths", "formation")),
    *(f"geometry.{table}." for table in ("orbit", "pose", "joint")),
    *("geometry.balance.margin_m", "geometry.balance.tool_distance_m", "geometry.base.half_support_width_m"),
    *("geometry.tank.axis_x_m", "geometry.tank.axis_y_m", "geometry.wall.cable", "geometry.wall.l"),
)
"""Prefixes of keys for the bridge's own behavior: set-points, limits, gains, times, and assumptions.

The assumptions are on a motor, on a joint's sensor, on the way to a tipping edge, on a cable.
"""


def leaves(value: object, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], float]]:
    """Yield every number below, with its path."""
    if isinstance(value, Mapping):
        for key, below in value.items():
            yield from leaves(below, (*path, str(key)))
    elif isinstance(value, (list, tuple)):
        for place, below in enumerate(value):
            yield from leaves(below, (*path, str(place)))
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, value


def key_of(robot: AnyRobot, path: tuple[str, ...]) -> str:
    """Return a path with a star for each row; sensors have their names, the ends of a travel their places."""
    if path[-2:-1] == ("travel",):
        return ".".join(("axes", "*", *path[2:]))
    if path[0] == "sensors":
        return ".".join((path[0], robot.sensors[int(path[1])].name, *path[2:]))
    return ".".join("*" if part.isdigit() else part for part in path)


def changed(value: Any, path: tuple[str, ...], new: float) -> Any:
    """Return what has this number there, and all else as before; nothing is checked."""
    if not path:
        return new
    head, rest = path[0], path[1:]
    if isinstance(value, tuple):
        place = int(head)
        return (*value[:place], changed(value[place], rest, new), *value[place + 1 :])
    if isinstance(value, Mapping):
        return {**value, head: changed(value[head], rest, new)}
    return value.model_copy(update={head: changed(getattr(value, head), rest, new)})


def built(robot: AnyRobot) -> object:
    """Return what the bench has made of a file: its plant's parameters, encoders, wires and signs."""
    made = devices(robot)
    made.physics.advance(2 * MILLISECOND)
    drives = made.motors(ServoAxis).values()
    with made.plant as plant:
        numbers = {
            it.name: plant.read(it.name) for it in plant.variables.values() if it.causality == "parameter"
        }
        record = plant.record
        signs = [record.mirrored_input_count, record.mirrored_output_count]
        axes = [(axis.encoder_resolution, axis.analogue_1_mv) for axis in drives]
        wires = [board.motors.wiring for board in made.nodes(Board).values()]
    return numbers, signs, axes, wires


@cache
def as_it_stands(name: str) -> object:
    return built(find(name))


CASES: Final = [
    pytest.param(name, path, id=f"{name}-{'.'.join(path)}")
    for name in names()
    for path, _ in leaves(find(name).model_dump())
    if key_of(find(name), path) in MACHINE
]


def test_every_number_of_a_file_is_the_machines_or_the_bridges() -> None:
    keys = {key_of(find(name), path) for name in names() for path, _ in leaves(find(name).model_dump())}
    assert {key for key in keys - MACHINE - WIDENED.keys() if not key.startswith(OTHERS)} == set()


@pytest.mark.parametrize(("name", "path"), CASES)
def test_a_machine_that_is_built_otherwise_is_so_on_the_bench(name: str, path: tuple[str, ...]) -> None:
    robot = find(name)
    old = dict(leaves(robot.model_dump()))[path]
    new = -old if path[-1] == "direction" else old + 1 if isinstance(old, int) else 1.1 * old or 0.1
    refused, other = "", None
    try:
        other = built(changed(robot, path, new))
    except RobotFileError as error:
        refused = str(error)
    assert path[-1] in refused or (other is not None and other != as_it_stands(name))


@pytest.mark.parametrize("name", ["ar2", "rome_arm"])
@pytest.mark.parametrize(("place", "beyond"), [(0, -0.1), (1, 0.1)])
def test_a_way_beyond_the_plants_stop_is_refused_with_what_to_say(
    name: str, place: int, beyond: float
) -> None:
    robot = find(name)
    number, axis = next((it, axis) for it, axis in enumerate(robot.axes) if axis.travel is not None)
    assert axis.travel is not None
    far = changed(robot, ("axes", str(number), "travel", str(place)), axis.travel[place] + beyond)
    with pytest.raises(
        RobotFileError, match=rf"axes\[{number}\].travel.*the plant's stop.*use plant.parameters"
    ):
        devices(far)


def test_two_gears_for_one_of_the_plant_are_refused() -> None:
    climber = find("climber")
    with pytest.raises(
        RobotFileError, match=r"one 'gear_wheel' for axes\.left\.ratio = 84 and axes\.right\.ratio = 90"
    ):
        devices(changed(climber, ("axes", "1", "ratio"), 90.0))


def test_both_gears_changed_are_followed() -> None:
    climber = changed(changed(find("climber"), ("axes", "1", "ratio"), 90.0), ("axes", "0", "ratio"), 90.0)
    with devices(climber).plant as plant:
        assert math.isclose(plant.read("gear_wheel"), 90.0)
