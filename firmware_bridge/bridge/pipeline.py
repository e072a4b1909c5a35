"""One cycle, top to bottom: known, holds, twist, wheel speeds, demands, pose, report (thesis 4.2).

It refuses to know the bus's timing and start-up: `firmware_bridge.bridge.bridge` calls it when the drives
have told where they are.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from firmware_bridge.bridge.lift_aim import LiftAim
from firmware_bridge.bridge.permission import Permission, at_rest
from firmware_bridge.drivers.drive import Demand, Drive, Position, Speed, Stop
from firmware_bridge.drivers.fleet import Fleet
from firmware_bridge.intent import NEVER_HEARD, Request, ResetOdometry, Verdict
from firmware_bridge.motion import davis, lift
from firmware_bridge.motion.odometry import Odometry
from firmware_bridge.motion.ramp import Ramp
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Robot, Role
from firmware_bridge.safety.gate import Gate, Ruling
from firmware_bridge.safety.snapshot import DriveSnapshot, Hold, Snapshot
from firmware_bridge.teleop.operator import Operator
from firmware_bridge.units import NEVER, Nanoseconds

MILLIVOLTS_PER_VOLT: Final = 1000.0


class Pipeline:
    """What the bridge does in every cycle, and what it remembers from one to the next."""

    __slots__ = (
        "_counted_at",
        "_demanded_mps",
        "_fleet",
        "_gate",
        "_left",
        "_lift",
        "_lifting",
        "_odometry",
        "_operator",
        "_permission",
        "_ramp",
        "_ran_at",
        "_right",
        "_robot",
        "_steering",
        "gate_deadline",
        "holds",
        "seen",
    )

    def __init__(self, robot: Robot, fleet: Fleet, operator: Operator, permission: Permission) -> None:
        self._robot = robot
        self._fleet = fleet
        self._operator = operator
        self._permission = permission
        drives: Mapping[Role, Drive] = {drive.axis.role: drive for drive in fleet.drives}
        self._left = drives[Role.LEFT_WHEEL]
        self._right = drives[Role.RIGHT_WHEEL]
        self._steering = drives[Role.STEERING]
        self._lifting = drives[Role.LIFT]
        self._gate = Gate(robot)
        self._ramp = Ramp.of(robot)
        self._lift = LiftAim(robot)
        self._odometry = Odometry(robot)
        self._counted_at: Nanoseconds = NEVER_HEARD
        self._demanded_mps = 0.0
        self._ran_at: Nanoseconds | None = None
        self.gate_deadline: Nanoseconds = NEVER
        """When a silence will trip an interlock if nothing is heard."""
        self.seen: Snapshot = self.known(0)
        """What the newest cycle knew and did."""
        self.holds: tuple[Hold, ...] = ()
        """What held in the newest cycle."""

    def run(self, now: Nanoseconds) -> tuple[tuple[Packet, ...], tuple[bytes, ...]]:
        """Do one cycle; return what goes to the drives and what to the operator."""
        known = self.known(now)
        ruling = self._gate.rule(known)
        self._permission.watch(ruling.holds)
        self.gate_deadline = self._gate.next_deadline(known)
        elapsed = self._elapsed(now)
        self._demanded_mps = self._twist(known, ruling.speed_mps, elapsed)
        sent = self._fleet.command(self._demands(known, ruling, elapsed))
        self._count()
        self.seen = replace(known, pose=self._odometry.pose, demanded_speed_mps=self._demanded_mps)
        self.holds = ruling.holds
        return sent, self._operator.report(self.seen, self.holds, now)

    def come_to_rest(self, now: Nanoseconds) -> tuple[tuple[Packet, ...], bool]:
        """Ramp down without asking anybody; return what goes to the drives, and whether the robot stands."""
        known = self.known(now)
        self._demanded_mps = self._twist(known, 0.0, self._elapsed(now))
        return self._fleet.command(self._wheels(known)), at_rest(known) and self._demanded_mps == 0.0

    def decide(self, request: Request, now: Nanoseconds) -> Verdict:
        """Answer one request of the operator."""
        if isinstance(request, ResetOdometry):
            self._odometry.reset()
            return Verdict(accepted=True, reason="the present place is the origin")
        known = self.known(now)
        return self._permission.decide(request, known, self._gate.rule(known).holds)

    def known(self, now: Nanoseconds) -> Snapshot:
        """Return everything known now."""
        robot, permission = self._robot, self._permission
        left = self._left.heard.speed_rad_s * robot.base.wheel_radius_m
        right = self._right.heard.speed_rad_s * robot.base.wheel_radius_m
        return Snapshot(
            now=now,
            intent=self._operator.intent,
            armed=permission.armed,
            emergency_stopped=permission.emergency_stopped,
            drives=tuple([_told(drive) for drive in self._fleet.drives]),
            steer_rad=self._steer(),
            lift_m=self._height(),
            speed_mps=(left + right) / 2.0,
            yaw_rate_rad_s=(right - left) / robot.base.rear_track_m,
            pose=self._odometry.pose,
            demanded_speed_mps=self._demanded_mps,
            battery_v=self._battery(),
            link_lost=self._fleet.link.lost,
        )

    def told(self, holds: tuple[Hold, ...], now: Nanoseconds) -> tuple[bytes, ...]:
        """Report without judging: before the drives are ready, and after they failed."""
        self.seen, self.holds = self.known(now), holds
        return self._operator.report(self.seen, self.holds, now)

    def _twist(self, known: Snapshot, target_mps: float, elapsed: Nanoseconds) -> float:
        """Return the base speed to demand now, on the ramp to the target in the turn actually steered."""
        bend = davis.curvature(self._robot.base, known.steer_rad or 0.0)
        return self._ramp.step(self._demanded_mps, target_mps, bend, elapsed)

    def _demands(self, known: Snapshot, ruling: Ruling, elapsed: Nanoseconds) -> Mapping[str, Demand]:
        """Return each axis's demand; the steering's first, as the thesis orders them."""
        if self._permission.powered_off:
            return self._all(Stop.POWER_OFF)
        if known.emergency_stopped and at_rest(known) and self._demanded_mps == 0.0:
            return self._all(Stop.QUICK_STOP)
        return {
            self._steering.axis.name: self._steered(ruling),
            **self._wheels(known),
            self._lifting.axis.name: self._lift.demand(ruling, known.lift_m, elapsed),
        }

    def _steered(self, ruling: Ruling) -> Demand:
        if ruling.stopped:
            return Stop.REST
        return Position(davis.steer_quadcounts(self._robot.base, self._steering.axis, ruling.steer_rad))

    def _wheels(self, known: Snapshot) -> dict[str, Demand]:
        """Return both wheels' speeds for the steer angle that the robot has, not the one it shall have."""
        left, right = davis.wheel_speeds(self._robot.base, self._demanded_mps, known.steer_rad or 0.0)
        return {self._left.axis.name: Speed(left), self._right.axis.name: Speed(right)}

    def _all(self, demand: Demand) -> Mapping[str, Demand]:
        return {drive.axis.name: demand for drive in self._fleet.drives}

    def _count(self) -> None:
        """Carry the pose on where both wheels were sampled at one new SYNC."""
        left, right = self._left.heard, self._right.heard
        if NEVER_HEARD in (left.sampled_at, right.sampled_at):
            self._odometry.rebase()
        elif left.sampled_at == right.sampled_at != self._counted_at:
            self._counted_at = left.sampled_at
            self._odometry.advance(left.position_qc, right.position_qc)

    def _elapsed(self, now: Nanoseconds) -> Nanoseconds:
        before, self._ran_at = self._ran_at, now
        return 0 if before is None else now - before

    def _steer(self) -> float | None:
        drive = self._steering
        if drive.heard.heard_at == NEVER_HEARD:
            return None
        return davis.steer_from_quadcounts(self._robot.base, drive.axis, drive.heard.position_qc)

    def _height(self) -> float | None:
        drive = self._lifting
        if drive.heard.heard_at == NEVER_HEARD:
            return None
        return lift.height_from_quadcounts(self._robot.lift, drive.axis, drive.heard.position_qc)

    def _battery(self) -> float | None:
        battery = self._robot.battery
        for drive in self._fleet.drives:
            if drive.axis.name == battery.axis and drive.heard.analogue_mv is not None:
                return drive.heard.analogue_mv * battery.divider / MILLIVOLTS_PER_VOLT
        return None


def _told(drive: Drive) -> DriveSnapshot:
    axis, heard = drive.axis, drive.heard
    return DriveSnapshot(
        axis=axis.name,
        node=axis.node,
        state=heard.state,
        heard_at=heard.heard_at,
        position_qc=heard.position_qc,
        speed_rad_s=heard.speed_rad_s,
        current_ma=heard.current_ma,
        fault=heard.fault,
    )
