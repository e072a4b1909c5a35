"""The operator's side of the bridge, whole: datagrams to intent and answers, snapshots to telemetry.

It opens no socket, reads no clock and judges nothing: requests go to the bridge through `decide`, limits are
the interlocks'. Every station that speaks to us is obeyed and the newest word counts; an echo of our own
words and messages for other systems are left alone.
"""

from typing import Final

from firmware_bridge.intent import Intent
from firmware_bridge.robot import Robot
from firmware_bridge.safety.snapshot import Hold, Snapshot
from firmware_bridge.teleop.conversation import HEARD, Conversation, Decide
from firmware_bridge.teleop.mavlink import Codec, Counters, Message, concerns
from firmware_bridge.teleop.parameters import PARAMETERS, Store
from firmware_bridge.teleop.schedule import Schedule
from firmware_bridge.teleop.session import LISTING_GAP, Dropped, Peer, Session
from firmware_bridge.teleop.texts import Severity
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

SEVERITIES: Final = {
    "not armed": Severity.NOTICE,
    "emergency stop": Severity.CRITICAL,
    "drive silent": Severity.CRITICAL,
    "drive fault": Severity.CRITICAL,
    "steer angle unknown": Severity.ERROR,
    "lift height unknown": Severity.ERROR,
}
"""How loud a hold is; a name's part behind a colon tells the axis. All others are warnings."""


class Operator:
    """One robot's place on MAVLink."""

    __slots__ = ("_faults", "_holds", "_session")

    def __init__(self, robot: Robot) -> None:
        self._session = Session(
            robot=robot,
            codec=Codec(robot.operator.system_id, robot.operator.component_id),
            store=Store(robot),
            schedule=Schedule(robot.bus.cycle_ms * MILLISECOND),
        )
        self._holds: dict[str, Hold] = {}
        self._faults: dict[str, int] = {}

    @property
    def intent(self) -> Intent:
        """What the operator wants now."""
        return self._session.intent

    @property
    def counters(self) -> Counters:
        """Frames heard, corrupt and unknown."""
        return self._session.codec.counters

    @property
    def dropped(self) -> Dropped:
        """Messages that were understood and not obeyed."""
        return self._session.dropped

    @property
    def next_due(self) -> Nanoseconds:
        """The instant at which `report` has something to send, whatever happens until then."""
        session = self._session
        return min(session.schedule.next_due, session.list_due)

    def hear(self, datagram: bytes, now: Nanoseconds, decide: Decide) -> tuple[bytes, ...]:
        """Take one datagram, ask `decide` for what only the bridge can grant, and return the answers.

        No bytes make it raise: what is no MAVLink is counted and skipped.
        """
        session = self._session
        codec = session.codec
        replies: list[Message] = []
        for message in codec.decode(datagram):
            peer = Peer(message.get_srcSystem(), message.get_srcComponent())
            if peer == (codec.system, codec.component):
                session.dropped.echoed += 1
            elif not concerns(message, codec.system, codec.component):
                session.dropped.foreign += 1
            elif (row := HEARD.get(message.get_msgId())) is not None:
                row(Conversation(session, message, peer, now, decide, replies))
        return tuple(codec.encode(message) for message in replies)

    def report(self, snapshot: Snapshot, holds: tuple[Hold, ...], now: Nanoseconds) -> tuple[bytes, ...]:
        """Return what is due now, in order: texts of what began or ended, telemetry, listed parameters."""
        session = self._session
        session.snapshot = snapshot
        messages = self._told_holds(holds) + self._told_faults(snapshot)
        due = session.schedule.due(now)
        if due:
            scene = session.scene(snapshot)
            for stream in due:
                messages += stream.encode(scene)
        messages += self._listed(now)
        return tuple(session.codec.encode(message) for message in messages)

    def _told_holds(self, holds: tuple[Hold, ...]) -> list[Message]:
        current = {hold.name: hold for hold in holds}
        if current.keys() == self._holds.keys():
            return []
        say = self._session.speaker.say
        messages: list[Message] = []
        for name in self._holds:
            if name not in current:
                messages += say(Severity.INFO, f"released: {name}")
        for name, hold in current.items():
            if name not in self._holds:
                remedy = f"; {hold.remedy}" if hold.remedy else ""
                messages += say(
                    SEVERITIES.get(name.split(":")[0], Severity.WARNING), f"{hold.reason}{remedy}"
                )
        self._holds = current
        return messages

    def _told_faults(self, snapshot: Snapshot) -> list[Message]:
        messages: list[Message] = []
        say = self._session.speaker.say
        for drive in snapshot.drives:
            before = self._faults.get(drive.axis, 0)
            if drive.fault == before:
                continue
            self._faults[drive.axis] = drive.fault
            if drive.fault:
                messages += say(Severity.CRITICAL, f"EPOS {drive.node} 0x{drive.fault:04X} ({drive.axis})")
            else:
                messages += say(Severity.INFO, f"EPOS {drive.node} fault cleared ({drive.axis})")
        return messages

    def _listed(self, now: Nanoseconds) -> list[Message]:
        session = self._session
        messages: list[Message] = []
        while session.list_due <= now:
            messages.append(session.store.message(session.listed))
            session.listed += 1
            session.list_due = session.list_due + LISTING_GAP if session.listed < len(PARAMETERS) else NEVER
        return messages
