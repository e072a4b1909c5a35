"""A mission along a path of someone's own: arm, start the path follower, take over behind its end."""

from typing import Final

from firmware_bridge.robot.path_file import Point

BEGINS_S: Final = 5.0
SETTLES_S: Final = 2.0
"""Time from the path's end until the operator takes over, and then until the run ends."""
TEXT: Final = """title = "Along a path from a file"
duration_s = {ends}
settled_after_s = {settled}
[[step]]
at_s = 4.0
title = "arm"
arm = true
[[step]]
at_s = {begins}
title = "start the path follower"
path_follower = "points"
[[step]]
at_s = {over}
title = "take over, at standstill"
path_follower = ""
"""


def along_mission(points: tuple[Point, ...]) -> str:
    """Return the mission as a file's text."""
    over = BEGINS_S + points[-1][0] + SETTLES_S
    settled = min(10.0, points[-1][0] / 2)
    return TEXT.format(begins=BEGINS_S, over=over, ends=over + SETTLES_S, settled=settled)
