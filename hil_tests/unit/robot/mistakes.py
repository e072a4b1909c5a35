"""Mistakes in the robot file of RARS, a row each: the wrong text, the reported key, and the message."""

from dataclasses import dataclass

from firmware_bridge.robot_types import robot_type_named

RARS = robot_type_named("rars").file.read_text(encoding="utf-8")
LINK = RARS[RARS.index("[links.drives]") : RARS.index("[geometry.base]")]
OPERATOR = RARS[RARS.index("[operator]") : RARS.index("[battery]")]
OUTPUT = """
[[outputs]]
name = "{name}"
title = "a lamp"
link = "drives"
settings = {{ axis = "left", output = 1 }}
"""


@dataclass(frozen=True, slots=True)
class Mistake:
    """Wrong text and the text in its place, the key of the report, and words that it must have."""

    title: str
    change: tuple[str, str]
    key: str
    words: tuple[str, ...]

    def made_in(self, text: str) -> str:
        old, new = self.change
        assert old in text, f"{self.title}: the file has no {old!r}"
        return text.replace(old, new, 1)


MISTAKES = (
    Mistake(
        "unknown key", ("cycle_ms = 50", "cycle_ms = 50\ncycel = 3"), "cycel", ("no such key", "'cycle_ms'")
    ),
    Mistake(
        "unknown key of an axis",
        ('title = "left rear wheel"', 'title = "left"\nratoi = 26.0'),
        "axes[0].ratoi",
        ("no such key", "perhaps 'ratio'?"),
    ),
    Mistake("wrong type", ("cycle_ms = 50", 'cycle_ms = "50"'), "cycle_ms", ("must be an integer", "'50'")),
    Mistake("missing table", (OPERATOR, ""), "operator", ("is missing",)),
    Mistake("missing key", ('title = "left rear wheel"\n', ""), "axes[0].title", ("is missing",)),
    Mistake(
        "a driver that does not serve",
        ('driver = "epos2-can"', 'driver = "epos2-cna"'),
        "links.drives.driver",
        ("'epos2-cna'", "perhaps 'epos2-can'?"),
    ),
    Mistake(
        "a driver of another maker",
        ('driver = "epos2-can"', 'driver = "stepper"'),
        "links.drives.driver",
        ("'stepper'", "there are: ar2, ", "epos2-can, epos2-serial"),
    ),
    Mistake(
        "unknown device",
        ('device = "70/10"', 'device = "70/11"'),
        "axes[0].settings.device",
        ("'70/11'", "perhaps '70/10'?"),
    ),
    Mistake(
        "unknown role",
        ('role = "steering"', 'role = "stering"'),
        "axes[2].role",
        ("'stering' is no role of this kind", "perhaps 'steering'?"),
    ),
    Mistake(
        "a role twice",
        ('role = "right_wheel"', 'role = "left_wheel"'),
        "axes[1].role",
        ("'left_wheel' is taken by axes[0]", "'right_wheel' is free"),
    ),
    Mistake(
        "duplicate name", ('name = "right"', 'name = "left"'), "axes[1].name", ("'left' is taken by axes[0]",)
    ),
    Mistake(
        "duplicate node",
        ("node = 2\n", "node = 1\n"),
        "axes[1].settings.node",
        ("1 is the node of axes[0]",),
    ),
    Mistake(
        "the bridge's own node",
        ("node = 2\n", "node = 100\n"),
        "axes[1].settings.node",
        ("the bridge's own node", "links.drives.bridge_node"),
    ),
    Mistake(
        "an axis on an unknown link",
        ('link = "drives"\ncommand', 'link = "drive"\ncommand'),
        "axes[0].link",
        ("no link 'drive'", "perhaps 'drives'?"),
    ),
    Mistake(
        "a link without devices",
        (LINK, LINK + LINK.replace("drives", "far", 1)),
        "links.far",
        ("no axis and no sensor",),
    ),
    Mistake(
        "a table in the place of named links",
        (LINK, "links = 3\n"),
        "links",
        ("must be a table", "3"),
    ),
    Mistake(
        "a bit rate that no drive has",
        ("bit_rate = 1_000_000", "bit_rate = 83_333"),
        "links.drives.bit_rate",
        ("must be one of 1000000, 800000", "83333"),
    ),
    Mistake(
        "unknown sensor of the battery",
        ('sensor = "battery"', 'sensor = "batery"'),
        "battery.sensor",
        ("no sensor 'batery'", "perhaps 'battery'?"),
    ),
    Mistake(
        "a battery low from the start", ("low_v = 21.0", "low_v = 31.0"), "battery", ("low_v must be below",)
    ),
    Mistake(
        "unknown axis of a sensor",
        ('axis = "left", input', 'axis = "lefd", input'),
        "sensors[0].settings.axis",
        ("no axis 'lefd'", "perhaps 'left'?"),
    ),
    Mistake(
        "two outputs at one pin",
        ("[plant]", OUTPUT.format(name="lamp") + OUTPUT.format(name="horn") + "[plant]"),
        "outputs[1].settings.output",
        ("1 is that of outputs[0]",),
    ),
    Mistake(
        "a position axis without travel",
        ("travel = [-2.66647, 2.66647]", ""),
        "axes[2]",
        ("needs travel = [lowest, highest]",),
    ),
    Mistake(
        "a travel that falls",
        ("travel = [-2.66647, 2.66647]", "travel = [2.66647, -2.66647]"),
        "axes[2].travel",
        ("must rise",),
    ),
    Mistake(
        "a travel with one end",
        ("travel = [-2.66647, 2.66647]", "travel = [2.66647]"),
        "axes[2].travel[1]",
        ("is missing",),
    ),
    Mistake(
        "a zero that no one confirms where it does harm",
        ('how = "confirm"', 'how = "at power-on"'),
        "axes[2]",
        ("takes no zero 'at power-on'",),
    ),
    Mistake(
        "a homing that no one describes",
        ('how = "confirm"', 'how = "home"'),
        "axes[2].zero",
        ("how = 'home' and the table homing",),
    ),
    Mistake(
        "a zero from nowhere",
        ('how = "confirm"', 'how = "luck"'),
        "axes[2].zero.how",
        ("there are: confirm, home, at power-on",),
    ),
    Mistake(
        "a wheel that someone confirms",
        ("[axes.settings]", '[axes.zero]\nhow = "confirm"\n\n[axes.settings]'),
        "axes[0]",
        ("without travel has no place to confirm",),
    ),
    Mistake("no direction", ("direction = 1", "direction = 0"), "axes[0].direction", ("must be 1 or -1",)),
    Mistake(
        "a top speed below what the limits ask",
        ("top_speed = 16.0 ", "top_speed = 1.0 "),
        "axes[0].top_speed",
        ("'left' be commanded to 14.8", "the bound is 1 rad/s", "narrow the limits"),
    ),
    Mistake(
        "a position's profile above the top speed",
        ("velocity_rpm = 5_000 ", "velocity_rpm = 6_985 "),
        "axes[2].settings.profile.velocity_rpm",
        ("6985 is above top_speed", "6984.4 rpm of the motor"),
    ),
    Mistake(
        "a speed's profile above the motor's limit",
        ("velocity_rpm = 2_600", "velocity_rpm = 4_001"),
        "axes[0].settings.profile.velocity_rpm",
        ("4001 is above max_velocity_rpm", "4000 rpm of the motor"),
    ),
    Mistake(
        "a profile that stands still",
        ("velocity_rpm = 5_000 ", "velocity_rpm = 0 "),
        "axes[2].settings.profile.velocity_rpm",
        ("greater than or equal to 1",),
    ),
    Mistake(
        "silence within a cycle",
        ("drive_heartbeat_ms = 100\nsilent_ms = 250", "drive_heartbeat_ms = 30\nsilent_ms = 50"),
        "links.drives.silent_ms",
        ("50 is not longer than the link's cycle, 50",),
    ),
    Mistake(
        "a stop that no sample can confirm in time",
        ("silent_ms = 250 ", "stop_confirmed_ms = { quick_stop = 100 }\nsilent_ms = 250 "),
        "links.drives.stop_confirmed_ms.quick_stop",
        ("100 is not longer than two of the link's cycles, 100",),
    ),
    Mistake(
        "a step of a stop that there is not",
        ("silent_ms = 250 ", "stop_confirmed_ms = { quick = 200 }\nsilent_ms = 250 "),
        "links.drives.stop_confirmed_ms.quick",
        ("no such key", "quick_stop"),
    ),
    Mistake(
        "a gateway that is no node",
        ('driver = "epos2-can"', 'driver = "epos2-serial"\ngateway = 9'),
        "links.drives.gateway",
        ("9 is not the node of an axis",),
    ),
    Mistake(
        "a serial link without a gateway",
        ('driver = "epos2-can"', 'driver = "epos2-serial"'),
        "links.drives",
        ("needs gateway",),
    ),
    Mistake(
        "a link that stops an unknown group",
        ("silent_ms = 250 ", 'stops = ["bass"]\nsilent_ms = 250 '),
        "links.drives.stops",
        ("no group 'bass'", "perhaps 'base'?"),
    ),
    Mistake(
        "a link that leaves the group of its own axis going",
        ("silent_ms = 250 ", 'stops = ["base"]\nsilent_ms = 250 '),
        "links.drives.stops",
        ("leaves out the group 'lift'", "'lift' is on this link"),
    ),
    Mistake(
        "a sum with an unknown axis",
        ("of = { left = 0.025,", "of = { lefft = 0.025,"),
        "guard.sums[0].of.lefft",
        ("no such axis", "perhaps 'left'?"),
    ),
    Mistake(
        "a sum of nothing",
        ("of = { left = 0.025, right = 0.025 }", "of = {}"),
        "guard.sums[0].of",
        ("at least 1",),
    ),
    Mistake(
        "a sum with a position",
        ("of = { left = 0.025,", "of = { steer = 0.025,"),
        "guard.sums[0].of.steer",
        ("is commanded by position",),
    ),
    Mistake(
        "one axis on both sides",
        ('other = ["lift"]', 'other = ["lift", "left"]'),
        "guard.exclusive[0].other",
        ("'left'", "exclude itself"),
    ),
    Mistake(
        "a plant that is not installed",
        ('fmu = "rars"', 'fmu = "rasr"'),
        "plant.fmu",
        ("no plant 'rasr' is installed", "perhaps 'rars'?"),
    ),
    Mistake(
        "unknown parameter set",
        ('parameter_set = "A"', 'parameter_set = "A_plausible_jaw"'),
        "plant.parameter_set",
        ("no parameter set", "perhaps 'A_plausible_yaw'?"),
    ),
    Mistake(
        "unknown parameter of the plant",
        ('parameter_set = "A"', "parameters = { gravyti = 1.6 }"),
        "plant.parameters.gravyti",
        ("no parameter 'gravyti'",),
    ),
    Mistake(
        "unknown kind by name", ('name = "rars"', 'name = "rarss"'), "name", ("'rarss'", "perhaps 'rars'?")
    ),
    Mistake(
        "unknown kind",
        ('name = "rars"', 'name = "mine"\nkind = "rasr"'),
        "kind",
        ("no kind of robot 'rasr'", "perhaps 'rars'?"),
    ),
    Mistake("a kind that is no name", ('name = "rars"', "name = [1]"), "name", ("no kind of robot '[1]'",)),
    Mistake(
        "a node that is no number", ("node = 2\n", "node = [2]\n"), "axes[1].settings.node", ("an integer",)
    ),
    Mistake("a name that is no name", ('name = "right"', "name = []"), "axes[1].name", ("must be a string",)),
    Mistake(
        "a number beyond all bounds",
        ("turn_radius_m = 0.415", "turn_radius_m = nan"),
        "geometry.limits.turn_radius_m",
        ("finite",),
    ),
)
BY_TITLE = {mistake.title: mistake for mistake in MISTAKES}
