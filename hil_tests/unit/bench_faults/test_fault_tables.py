"""Faults in a mission file: every kind can be named, and each way to get one wrong has a line of its own."""

import pytest
from pydantic import ValidationError

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.faults import Fault, FaultError, FaultKind, kinds, misfits, read
from emulators.bench.mission import Mission, MissionFileError, parse
from firmware_bridge import robot_types
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import NEVER, from_seconds
from hil_tests.rows import every
from hil_tests.unit.capture_driver.capture_bench import table as cameras
from hil_tests.unit.cia402_drives.on_servos import rars
from validation.pages.faults import parameters, target

RARS = robot_types.find("rars")
SERIAL = over_serial(RARS)
ROME = robot_types.find("rome")
ON_A_BOARD = (
    *("board_silent", "board_reset", "board_hangs", "board_brown_out", "line_garbage"),
    *("shaft_blocked", "motor_cable_off", "encoder_cable_off", "load_lifted", "motor_supply_sag"),
    *("board_chatters", "shield_absent", "i2c_stuck", "motor_leads_swapped"),
    *("board_unpowered", "current_limit", "over_temperature"),
)
HEAD = 'title = "t"\nduration_s = 10.0\n[[step]]\nat_s = 1.0\ntitle = "s"\narm = true\n'
LEAST = {
    "grip_lost": 'node = "left"',
    "reception_error": 'node = "left"',
    "receive_overrun": 'node = "left"',
    "bus_off": 'node = "left"',
    "can_cut": 'between = ["left", "right"]',
    "can_swapped": 'node = "left"',
    "nmt_foreign_node": 'command = "stop"',
    "stray_frames": "identifier = 0x80",
    "node_silent": 'node = "bridge"',
    "drive_restart": "node = 4",
    "set_points_ignored": 'node = "left"',
    "supply_sag": "to_v = 9",
    "supply_surge": "to_v = 80.0",
    "logic_supply_sag": 'node = "left"\nto_v = 4.0',
    "gate_supply_sag": 'node = "left"\nto_v = 4.0',
    "overheating": "to_celsius = 100.0",
    "encoder_cut": 'node = "left"',
    "encoder_swapped": 'node = "left"',
    "encoder_counts_lost": 'node = "left"\nshare = 0.01',
    "encoder_frozen": 'node = "left"',
    "index_missing": 'node = "left"',
    "index_spurious": 'node = "left"',
    "datagram_late": "by_ms = 100.0",
    "capture_late": "by_ms = 100.0",
    "motor_cable_off": 'node = "two"',
    "shaft_blocked": 'node = "two"',
    "load_lifted": 'node = "two"',
    "motor_supply_sag": "to_v = 2.0",
    "encoder_cable_off": 'node = "two"',
    "drive_variation": 'node = "left"\nnames = ["late-boot-up"]',
    "motor_leads_swapped": 'node = "two"',
}
"""Required keys of a kind beside its instant."""


def table(kind: str, keys: str = "") -> str:
    return f'\n[[fault]]\nkind = "{kind}"\n{keys}\n'


def mission(text: str, robot: AnyRobot = RARS) -> Mission:
    return parse(HEAD + text, "my.toml", robot, bench_setup_of(robot))


def refusal(text: str, robot: AnyRobot = RARS) -> list[str]:
    with pytest.raises(MissionFileError) as caught:
        mission(text, robot)
    return str(caught.value).splitlines()


SEEN = RARS.with_links({"cameras": cameras()})
ON = {
    "grip_lost": robot_types.find("climber"),
    "drive_variation": rars(),
    "serial_unplugged": SERIAL,
    **dict.fromkeys(("body_hidden", "body_shakes", "markers_swapped", "capture_late", "capture_loss"), SEEN),
    **dict.fromkeys(("imu_frozen", "imu_axes_swapped", "imu_silent"), robot_types.find("rars+imu")),
}
"""Robots of the kinds of fault that RARS cannot have."""


@every("kind", kinds().values(), ids=lambda kind: kind.name)
def test_every_kind_can_be_named_with_the_least_that_it_needs(kind: FaultKind) -> None:
    robot = ON.get(kind.name, ROME if kind.name in ON_A_BOARD else RARS)
    keys = f"at_s = 2.0\n{LEAST.get(kind.name, '')}"
    (fault,) = mission(table(kind.name, keys), robot).fault
    assert type(fault) is kind.fault
    assert fault.begin == from_seconds(2.0)
    assert fault.end == (NEVER if kind.lasts else fault.begin)
    if kind.lasts:
        for ended in ("until_s = 2.5", "for_s = 0.5"):
            (fault,) = mission(table(kind.name, f"{keys}\n{ended}"), robot).fault
            assert fault.end == from_seconds(2.5)
    else:
        for ended in ("until_s", "for_s"):
            (line,) = refusal(table(kind.name, f"{keys}\n{ended} = 2.5"), robot)
            assert line == f"my.toml: fault[0].{ended}: '{kind.name}' is an instant: it has no end"


AT = "at_s = 2.0\n"


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("\n[[fault]]\nat_s = 1.0", "fault[0].kind: which fault? there are: frame_error, "),
        (table("frame_los", AT), "fault[0].kind: no such fault as 'frame_los'; perhaps 'frame_loss'?"),
        (table("nonsense", AT), "fault[0].kind: no such fault as 'nonsense'; there are: frame_error, "),
        (
            table("motor_cable_of", AT),
            "fault[0].kind: no such fault as 'motor_cable_of'; rars cannot have 'motor_cable_off'; there a",
        ),
        (table("frame_loss"), "fault[0].at_s: frame_loss needs at_s"),
        (table("frame_loss", "at_s = -1"), "fault[0].at_s: "),
        (table("frame_loss", "at_s = nan"), "fault[0].at_s: "),
        (table("frame_loss", "at_s = 10.0"), "fault 'frame_loss' at 10 s is not before the end"),
        (table("frame_loss", f"{AT}nod = 3"), "fault[0].nod: no such key of 'frame_loss'; perhaps 'node'?"),
        (
            table("frame_loss", f"{AT}node = 9"),
            "fault[0].node: rars has no node '9'; there are: bridge, left",
        ),
        (
            table("frame_loss", f'{AT}node = "ster"'),
            "fault[0].node: rars has no node 'ster'; perhaps 'steer'?",
        ),
        (
            table("frame_loss", f"{AT}node = []"),
            "fault[0].node: Input should be a valid string, but it is []",
        ),
        (table("frame_loss", f"{AT}share = 0.0"), "fault[0].share: "),
        (table("frame_loss", f"{AT}share = 1.1"), "fault[0].share: "),
        (table("frame_loss", f"{AT}for_s = 0"), "fault[0].for_s: "),
        (table("frame_loss", f"{AT}until_s = 2.0"), "fault[0]: until_s = 2 is not after at_s = 2"),
        (
            table("frame_loss", f"{AT}until_s = 3.0\nfor_s = 1.0"),
            "fault[0]: until_s and for_s are alternatives",
        ),
        (table("frame_error", f"{AT}count = 0"), "fault[0].count: "),
        (
            table("drive_restart", f'{AT}node = "bridge"'),
            "fault[0].node: 'bridge' is not a drive; there are: left",
        ),
        (
            table("drive_restart", AT),
            "fault[0].node: drive_restart needs node: left or right or steer or lift",
        ),
        (
            table("can_cut", f'{AT}between = ["left", "steer"]'),
            "fault[0].between: these two are not neighbors",
        ),
        (
            table("can_cut", f'{AT}between = ["left", "left"]'),
            "fault[0].between: these two are not neighbors",
        ),
        (
            table("can_cut", f'{AT}between = ["left", "rigth"]'),
            "fault[0].between: rars has no node 'rigth'; perhaps",
        ),
        (table("can_cut", f'{AT}between = ["left"]'), "fault[0].between: "),
        (
            table("nmt_foreign_node", f'{AT}command = "halt"'),
            "fault[0].command: Input should be 'start', 'stop'",
        ),
        (table("supply_sag", f"{AT}to_v = 24.0"), "fault[0].to_v: 24 V is no sag of a supply of 24 V"),
        (table("supply_surge", f"{AT}to_v = 20.0"), "fault[0].to_v: 20 V is no surge of a supply of 24 V"),
        (table("logic_supply_sag", f"{AT}node = 1\nto_v = 5.0"), "fault[0].to_v: "),
        (table("datagram_late", AT), "fault[0].by_ms: datagram_late needs by_ms"),
        (table("datagram_loss", f'{AT}sender = "robot"'), "fault[0].sender: "),
        (table("serial_unplugged", AT), "fault[0].kind: rars is not on a serial line"),
        (
            table("grip_lost", f"{AT}node = 1"),
            "fault[0].kind: nothing holds rars on a wall: its plant has no",
        ),
    ],
)
def test_a_wrong_fault_is_refused_with_file_key_and_a_near_name(text: str, complaint: str) -> None:
    (line,) = refusal(text)
    assert line.startswith(f"my.toml: {complaint}")


def test_a_bridge_on_a_serial_line_is_not_on_the_bus() -> None:
    (line,) = refusal(table("frame_loss", f'{AT}node = "bridge"'), SERIAL)
    assert line.startswith("my.toml: fault[0].node: 'bridge' is not a node on the CAN bus; there are: left")


def test_the_line_of_cameras_is_no_bus() -> None:
    (line,) = refusal(table("frame_loss", f'{AT}link = "cameras"'), robot_types.find("climber+cameras"))
    assert line.startswith("my.toml: fault[0].link: climber has no bus 'cameras'; there are: drives")


def test_all_that_is_wrong_is_stated_at_once() -> None:
    lines = refusal(
        table("frame_los", AT)
        + table("frame_loss", f"{AT}nod = 3\nshare = 7.0")
        + table("nmt_foreign_node", 'at_s = 1.0\ncommand = "stop"\nfor_s = 1.0')
    )
    assert [line.split(":")[1].strip() for line in lines] == [
        "fault[0].kind",
        "fault[1].share",
        "fault[1].nod",
        "fault[2].for_s",
    ]
    lines = refusal(table("frame_loss", f"{AT}node = 9") + table("supply_sag", f"{AT}to_v = 30.0\nnode = 8"))
    assert [line.split(":")[1].strip() for line in lines] == [
        "fault[0].node",
        "fault[1].node",
        "fault[1].to_v",
    ]


@pytest.mark.parametrize(
    ("one", "other", "together"),
    [
        (("supply_sag", {"to_v": 9.0}), ("supply_surge", {"to_v": 80.0, "node": "left"}), True),
        (("supply_sag", {"to_v": 9.0, "node": 2}), ("supply_surge", {"to_v": 80.0, "node": "left"}), False),
        (("node_silent", {"node": "left"}), ("drive_restart", {"node": 1}), True),
        (("node_silent", {"node": "left"}), ("drive_restart", {"node": 2}), False),
        (("can_cut", {"between": ["left", "right"]}), ("can_swapped", {"node": "lift"}), True),
        (("babbling_node", {}), ("babbling_node", {"identifier": 2}), True),
        (("frame_loss", {"node": 1}), ("frame_loss", {"node": 1}), False),
        (("encoder_cut", {"node": 1}), ("encoder_swapped", {"node": 1}), False),
        (("datagram_late", {"by_ms": 5.0}), ("datagram_late", {"by_ms": 5.0}), False),
    ],
)
def test_two_faults_of_one_thing_may_not_overlap(
    one: tuple[str, dict[str, object]], other: tuple[str, dict[str, object]], *, together: bool
) -> None:
    def faults(later: float) -> list[Fault]:
        return [
            read({"kind": one[0], "at_s": 1.0, "for_s": 1.0, **one[1]}),
            read({"kind": other[0], "at_s": later, **other[1]}),
        ]

    assert bool(list(misfits(faults(1.999), RARS))) is together
    assert not list(misfits(faults(2.0), RARS)), "one after the other"


def test_a_fault_from_python_is_checked_alike() -> None:
    fault = kinds()["frame_loss"].fault.model_validate({"at_s": 1.0, "node": "steer", "for_s": 0.4})
    assert read(fault) is fault
    assert fault == read({"kind": "frame_loss", "at_s": 1.0, "node": "steer", "for_s": 0.4})
    with pytest.raises(ValidationError, match="no such key of 'frame_loss'"):
        read({"kind": "frame_loss", "at_s": 1.0, "nod": "steer"})
    with pytest.raises(ValidationError, match="a fault is a table"):
        Mission.model_validate({"title": "t", "duration_s": 1, "step": [], "fault": [3]})
    assert (
        str(FaultError([("fault[0].node", "no"), ("fault[1]", "neither")]))
        == "fault[0].node: no\nfault[1]: neither"
    )


FREE = frozenset({"`node`", "`between`", "`link`", "`data`", "`names`"})
"""Keys whose values no table can list."""


@every("kind", kinds().values(), ids=lambda kind: kind.name)
def test_every_key_of_every_kind_is_explained(kind: FaultKind) -> None:
    keys = {key: (text, values) for key, text, values, _ in parameters(kind)}
    assert all(text for text, _ in keys.values())
    assert all(values for key, (_, values) in keys.items() if key not in FREE)
    assert kind.happens.endswith(".")
    assert kind.does.endswith(".")
    assert target(kind)
