"""Faults of a motion capture system: what the cameras do not see, or take for something else."""

import math
from collections.abc import Iterator
from typing import Annotated, ClassVar

from numpy.random import Generator
from pydantic import Field

from emulators.bench.faults.fault import Lasting, Positive, Problem, Share, Stations
from emulators.bench.faults.site import Site
from emulators.motion_capture.exposure import Hidden, Shaken, Swapped
from emulators.motion_capture.system import MotionCapture
from emulators.wires import Impairment
from firmware_bridge.families.motion_capture.settings import CaptureLink
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MILLISECOND


class _Seen(Lasting):
    among: ClassVar = Stations.NONE

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Yield the equipment that this robot lacks for it."""
        if not CaptureLink.all_of(robot):
            yield "kind", f"{robot.name} has no link to a capture system"


class BodyHidden(_Seen):
    """No camera sees the robot."""

    kind: ClassVar = "body_hidden"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Hide all bodies of all systems."""
        del chance
        for system in site.devices.nodes(MotionCapture).values():
            for body in system.exposure.bodies:
                system.hide(Hidden(body.id, self.begin, self.end))


class MarkersSwapped(_Seen):
    """The robot's markers are taken for others."""

    kind: ClassVar = "markers_swapped"
    aside_m: Annotated[float, Field(ge=-10, le=10, description="error of the pose ahead, in m")] = 0.3
    turn_deg: Annotated[float, Field(ge=-180, le=180, description="error of the heading to the left")] = 180.0

    def put_on(self, site: Site, chance: Generator) -> None:
        """Let all bodies of all systems be seen elsewhere."""
        del chance
        turn = math.radians(self.turn_deg)
        for system in site.devices.nodes(MotionCapture).values():
            for body in system.exposure.bodies:
                # In the body's own axes: ahead of where it truly is, wherever it looks.
                aside = (self.aside_m, 0.0, 0.0)
                system.hide(Swapped(body.id, self.begin, self.end, aside, turn))


class BodyShakes(_Seen):
    """The robot trembles, as on a floor that is not even: its place is known so much less exactly."""

    kind: ClassVar = "body_shakes"
    noise_mm: Annotated[Positive, Field(description="standard deviation along each axis, in mm")] = 1.0

    def put_on(self, site: Site, chance: Generator) -> None:
        """Shake all bodies of all systems."""
        del chance
        for system in site.devices.nodes(MotionCapture).values():
            for body in system.exposure.bodies:
                system.hide(Shaken(body.id, self.begin, self.end, self.noise_mm / 1_000.0))


class CaptureLate(_Seen):
    """Frames of the capture system come late."""

    kind: ClassVar = "capture_late"
    bench_only: ClassVar = "datagrams are the real network's: tc-netem impairs it"
    by_ms: Annotated[Positive, Field(description="delay beyond the network's own, in ms")]
    share: Share = 1.0

    def put_on(self, site: Site, chance: Generator) -> None:
        """Delay what is sent between the bridge and the systems."""
        late = round(self.by_ms * MILLISECOND)
        for wire in site.datagram_wires.values():
            wire.impair(Impairment(None, self.begin, self.end, self.share, chance, late=late))


class CaptureLoss(_Seen):
    """Frames of the capture system are lost."""

    kind: ClassVar = "capture_loss"
    bench_only: ClassVar = "datagrams are the real network's: tc-netem impairs it"
    share: Share = 1.0

    def put_on(self, site: Site, chance: Generator) -> None:
        """Lose what is sent between the bridge and the systems."""
        for wire in site.datagram_wires.values():
            wire.impair(Impairment(None, self.begin, self.end, self.share, chance, lost=True))
