"""Robot files with CiA 402 drives: what is wrong with one is reported by key, with what there is instead."""

import pytest

from firmware_bridge.robot import RobotFileError
from hil_tests.unit.cia402_drives.on_servos import rars

LIFT = (
    '[axes.zero]\nhow = "confirm"                 # its drive counts from its position at power-on\n\n'
    "[axes.settings]\nnode = 4"
)
HOMED = """[axes.zero]
how = "home"

[axes.zero.homing]
method = METHOD
speed = 2.0
zero_speed = 1.0
acceleration = 10.0
within_s = 300
MORE

[axes.settings]
node = 4"""


def homed(method: int, more: str = "") -> tuple[str, str]:
    return LIFT, HOMED.replace("METHOD", str(method)).replace("MORE", more)


@pytest.mark.parametrize(
    ("change", "stated"),
    [
        (homed(-3, "current_a = 0.5"), "axes[3].zero.homing.method: -3 is a method of maxon's EPOS"),
        (homed(-3, "current_a = 0.5"), "of CiA 402 there are 1, 2, 7, 11, 17, 18, 23, 27, 33 and 34"),
        (
            homed(17, "offset = 2.0"),
            "axes[3].zero.homing.offset: 2: a CiA 402 drive stays where it has found",
        ),
        (("node = 2\n", "node = 1\n"), "axes[1].settings.node: 1 is the node of axes[0], too"),
        (("node = 2\n", "node = 100\n"), "axes[1].settings.node: 100 is the bridge's own node"),
        (("encoder_counts = 2_000", "encoder_counts = 3"), "axes[0].settings.encoder_counts"),
        (
            ("node = 3\n", "node = 3\ncurrent_object = 0x6079\n"),
            "axes[2].settings: current_object = 0x6079: must be 0x6077 or 0x6078",
        ),
        (
            ("peak_current_ma = 3_000", "peak_current_ma = 100_000"),
            "axes[2].settings: peak_current_ma = 100000: 0x6073 holds 78642 mA at most",
        ),
        (
            ("node = 3\n", "node = 3\nspeed_units_per_rpm = 1e-6\n"),
            "axes[2].settings: speed_units_per_rpm = 1e-06: a ramp is below 1 unit",
        ),
        (
            ("node = 3\n", "node = 3\nfactors = { encoder_counts = 2_000, feed = 3_600 }\n"),
            "axes[2].settings: encoder_counts = 2000: by factors a turn of the motor has 3600 units of",
        ),
        (
            ("node = 3\n", "node = 3\nfactors = { encoder_counts = 2_000, feed = 0 }\n"),
            "axes[2].settings.factors.feed",
        ),
        (
            ('measures = "supply"', "input = 1, per_volt = 6.0"),
            "sensors[0]",
        ),
        (('measures = "supply"', 'measures = "suply"'), "sensors[0].settings.measures"),
        (("bit_rate = 1_000_000", "bit_rate = 10_000"), "links.drives.bit_rate"),
        (("silent_ms = 250", "silent_ms = 100"), "silent_ms must be longer than drive_heartbeat_ms"),
    ],
)
def test_what_is_wrong_is_reported_by_key(change: tuple[str, str], stated: str) -> None:
    with pytest.raises(RobotFileError) as caught:
        rars(change)
    assert stated in str(caught.value)


@pytest.mark.parametrize("method", [1, 2, 17, 18, 33])
def test_a_method_of_the_standard_is_one(method: int) -> None:
    rars(homed(method))
