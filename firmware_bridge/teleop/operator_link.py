"""The operator's link of one robot: datagrams to intent and answers, snapshots to telemetry.

It opens no socket, reads no clock and judges nothing: requests go to the bridge through `decide`, limits are
the interlocks'. An echo of our own messages, and messages for other systems, are ignored. A robot's own use
of them is in its station's rows. A message passes `receive`, the handler of its number in
`firmware_bridge.teleop.messages`, and for a motion command `Driving.take`.
"""

from typing import Any, Final

from firmware_bridge.intent import NEVER_RECEIVED, AgeLimit, Intent
from firmware_bridge.mavlink.audience import Audience
from firmware_bridge.mavlink.frames import (
    Codec,
    Counters,
    Message,
    concerns,
    dialect,
    speaks_mavlink_1,
    target_of,
)
from firmware_bridge.mavlink.injection import Injection
from firmware_bridge.mavlink.parameters import GAP, Store
from firmware_bridge.mavlink.schedule import Schedule
from firmware_bridge.mavlink.trust import ANY_STATION, Signatures, Stamps, Trust, is_signed
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.snapshot import ActiveInterlock, AnySnapshot
from firmware_bridge.teleop.commands import requests_stop
from firmware_bridge.teleop.driving import Driving, Dropped
from firmware_bridge.teleop.incoming import Decide, Incoming, Sender, Station
from firmware_bridge.teleop.messages import HANDLERS, LATER, stop_for_anybody
from firmware_bridge.teleop.station import AnyStation
from firmware_bridge.teleop.stations import MOST_STATIONS, Stations
from firmware_bridge.teleop.status import Status
from firmware_bridge.teleop.streams import Telemetry, parameters_of, streams_of
from firmware_bridge.teleop.texts import LinkState, Texts
from firmware_bridge.units import SECOND, Nanoseconds

RADIO_STATUS: Final = dialect.MAVLINK_MSG_ID_RADIO_STATUS
HEARTBEAT: Final = dialect.MAVLINK_MSG_ID_HEARTBEAT
LISTED_BITS: Final = 1_500
"""Bits of bandwidth for one parameter of a list: a quarter of it for 37 bytes."""


class OperatorLink:
    """One robot's place on MAVLink."""

    def __init__(
        self,
        robot: AnyRobot,
        rows: AnyStation,
        rest: Any,
        *,
        rolling: tuple[str, ...],
        modes: tuple[str, ...] = (),
        path_followers: tuple[str, ...] = (),
        trust: Trust = ANY_STATION,
        injects: bool = False,
    ) -> None:
        """Take the robot, its type's rows, standstill, its rolling axes, modes and path followers.

        `trust` decides whose frames are accepted; `injects` allows a station to inject failures.
        """
        self.robot: Final = robot
        self.rows: Final = rows
        self.path_followers: Final = ("", *path_followers)
        """Path followers by custom submode; the first is the operator."""
        self.codec: Final = Codec(robot.operator.system_id, robot.operator.component_id)
        self.streams: Final = streams_of(robot, rows)
        self.schedule: Final = Schedule(tuple((row.number, row.period) for row in self.streams), robot.cycle)
        bandwidth = robot.operator.bandwidth_bit_s
        gap = GAP if bandwidth is None else max(GAP, LISTED_BITS * SECOND // bandwidth)
        self.store: Final = Store(parameters_of(robot, rows.parameters, self.schedule), gap)
        signed = trust.key is not None
        self.stations: Final = Stations(signed=signed)
        battery = None if robot.battery is None else robot.battery.sensor
        self.injection: Final = Injection(battery, allowed=injects)
        self.driving: Final = Driving(
            robot, rows, rest, self.stations, signed=signed, injection=self.injection
        )
        self.status: Final = Status(
            self.driving, self.codec.counters, self.streams, rolling=rolling, modes=modes
        )
        self.texts: Final = Texts(robot)
        self.trust: Final = trust
        self._doubts: Final = signed or bool(trust.allowed)
        self.signatures: Final = Signatures(trust)
        self.audience: Final = Audience(self.codec.system, self.codec.component, trust, self.signatures.stamp)
        self.notes: tuple[str, ...] = ()
        """Findings of the start for the station in control."""
        self.stop_answered_at: Nanoseconds = NEVER_RECEIVED
        """Time of the answer to an untrusted sender's emergency stop."""
        self._reported: Final[dict[int, object]] = {}
        """The last values of the streams that are sent as soon as they change, by their place."""
        self._reported_once: Final[set[str]] = set()
        self._doubted_before: Final[set[Sender]] = set()
        self._foreign_nodes: list[str] = []

    @property
    def intent(self) -> Intent:
        """The operator's command now."""
        return self.driving.intent

    @property
    def age_limit(self) -> AgeLimit:
        """Age limit of a motion command."""
        return self.driving.age_limit

    @property
    def driver(self) -> Sender | None:
        """The station in control; None without one."""
        return None if self.stations.in_control is None else self.stations.in_control.sender

    @property
    def counters(self) -> Counters:
        """Count of frames received, corrupt and unknown."""
        return self.codec.counters

    @property
    def dropped(self) -> Dropped:
        """Messages that were understood and not obeyed."""
        return self.driving.dropped

    @property
    def next_due(self) -> Nanoseconds:
        """The instant at which `report` has something to send, whatever happens until then."""
        return min(self.schedule.next_due, self.audience.next_due, self.store.list_due)

    def stamps(self, now: Nanoseconds) -> Stamps:
        """Return which signatures' time stamps must outlive this run."""
        return self.signatures.kept(now)

    def receive(
        self, datagram: bytes, now: Nanoseconds, decide: Decide, source: int = 0
    ) -> tuple[Packet, ...]:
        """Take one datagram, have `decide` judge the requests that only the bridge grants; return answers.

        `source` is its origin: the packet's address. No bytes make it raise: bytes that are no MAVLink are
        counted and skipped.
        """
        stations = self.stations
        replies: list[Message] = []
        good = beats = old = False
        for message in self.codec.decode(datagram):
            # The place belongs to it: two stations may have the same system and component.
            sender = Sender(source, message.get_srcSystem(), message.get_srcComponent())
            if self._is_foreign(message, sender, now) or (self.injection.on and self._lost(message)):
                continue
            doubt = self.signatures.doubt(message, source, now) if self._doubts else None
            if doubt is not None:
                stopped = self._doubted(message, sender, doubt, now, decide)
                good, replies = good or bool(stopped), replies + stopped
                continue
            station = stations.of.get(sender) or stations.find(sender)
            if station.receive(message, now):
                text = f"two stations call themselves {sender}: only the first is in control; renumber one"
                self.texts.report(Severity.WARNING, text)
            # A second station with the same numbers may stop the robot, and nothing else.
            handle = (LATER if station.later else HANDLERS).get(message.get_msgId())
            if handle is not None:
                drives = stations.in_control is None or station is stations.in_control
                refusal = None if drives else stations.refusal()
                incoming = Incoming(self, station, message, now, decide, refusal=refusal)
                handle(incoming)
                replies += incoming.replies
            good, old = True, speaks_mavlink_1(message)
            beats = beats or message.get_msgId() == HEARTBEAT
            if self.trust.key is None and is_signed(bytes(message.get_msgbuf())):
                self._report_once("key", "signatures are not checked: this bridge has no key")
        if not good:
            return ()
        self.audience.received(source, len(datagram), now, beats=beats, old=old)
        return self.audience.answer(source, replies, stations.source, now)

    def _lost(self, message: Message) -> bool:
        """Return whether an injected failure takes a message; never a stop, or the end of the failure."""
        if not self.injection.loses():
            return False
        commands = message.get_type() in {"COMMAND_LONG", "COMMAND_INT"}
        ends = commands and message.command == dialect.MAV_CMD_INJECT_FAILURE
        return not ends and not requests_stop(message, self.rows)

    def _is_foreign(self, message: Message, sender: Sender, now: Nanoseconds) -> bool:
        """Return whether a message is not for this robot: our own, one for another, or a radio's."""
        codec = self.codec
        if sender.system == codec.system and sender.component == codec.component:
            self.dropped.echoed += 1
            # An echo of our own messages is never addressed to us, and no ground station's heartbeat.
            station = message.get_msgId() == HEARTBEAT and message.type == dialect.MAV_TYPE_GCS
            if station or target_of(message) == codec.system:
                text = f"a station calls itself {sender}, as this robot: it is ignored; let it be system 255"
                self._report_once("namesake", text)
            return True
        if not concerns(message, codec.system, codec.component):
            self.dropped.foreign += 1
            # Counted all the same: gaps in the sequence are losses only where all frames are seen.
            self.stations.passed(sender, message.get_seq(), now)
            return True
        # A telemetry radio puts it in, unsigned: a sign of no one's life.
        return bool(message.get_msgId() == RADIO_STATUS)

    def _doubted(
        self, message: Message, sender: Sender, doubt: str, now: Nanoseconds, decide: Decide
    ) -> list[Message]:
        """Obey an emergency stop of any sender; report of all else that it was refused."""
        if requests_stop(message, self.rows):
            # It is no station on record: it may stop the robot, and is forgotten.
            return stop_for_anybody(
                Incoming(self, Station(sender), message, now, decide, refusal=doubt, doubted=True)
            )
        self.dropped.doubted += 1
        if sender not in self._doubted_before and len(self._doubted_before) < MOST_STATIONS:
            self._doubted_before.add(sender)
            self._foreign_nodes.append(f"{sender} is not obeyed: it {doubt}")
        self.texts.sometimes("doubted", f"{message.get_type()} of {sender} refused: it {doubt}", now)
        return []

    def take_new_stations(self) -> list[str]:
        """Return the untrusted senders since the last call, each once, with the reason; for the console.

        On the link only trusted stations receive texts, and there may be none.
        """
        new_stations, self._foreign_nodes = self._foreign_nodes, []
        return new_stations

    def _report_once(self, key: str, text: str) -> None:
        if key not in self._reported_once:
            self._reported_once.add(key)
            self.texts.report(Severity.WARNING, text)

    def lapse(self, now: Nanoseconds) -> bool:
        """Let no one drive where the driver is gone, and return whether he is; only when the robot rests."""
        # The caller has found the robot at standstill: control never ends while it moves.
        if not self.stations.lapses(now):
            return False
        text = f"control: {self.driver} is gone, no station in control"
        self.end_control(now)
        self.texts.report(Severity.WARNING, text)
        return True

    def end_control(self, now: Nanoseconds) -> None:
        """End control; the command is to standstill."""
        self.stations.give_up()
        self.driving.by_hand()
        self.driving.adopt(None, now)

    def note(self, texts: tuple[str, ...]) -> None:
        """Report the findings of the start: now, and to each station that takes control."""
        self.notes = texts
        for text in texts:
            self.texts.report(Severity.NOTICE, text)

    def take_returned_to_neutral(self) -> bool:
        """Return whether the station in control was neutral since the last call, even for one command."""
        driving = self.driving
        returned_to_neutral, driving.returned_to_neutral = driving.returned_to_neutral, False
        return returned_to_neutral

    def forget(self) -> None:
        """Forget the targets of an operator who has gone silent."""
        self.driving.forget()

    def set_period(self, number: int, period: Nanoseconds, now: Nanoseconds) -> None:
        """Set a message's period for all places without an interval of their own."""
        self.schedule.follow(number, period, now)
        self.audience.follow(number, period, now)

    def report(
        self, snapshot: AnySnapshot, events: tuple[ActiveInterlock, ...], now: Nanoseconds
    ) -> tuple[Packet, ...]:
        """Return what is due now, in order: texts of what began or ended, telemetry, listed parameters."""
        if snapshot.facts.emergency_stopped:
            self.injection.clear()
        self.injection.go_on(now)
        station, source = self.stations.in_control, self.stations.source
        if station is not None:
            # Before the texts are taken, so that they leave in this cycle.
            link = LinkState(station.clocks, self.age_limit, self.intent.timestamped, now)
            for severity, text in station.quality.changes(link):
                self.texts.report(severity, text)
        texts = self.texts.due(snapshot.facts, events, now)
        packets: tuple[Packet, ...] = ()
        telemetry = Telemetry(self.streams, self.status.see(snapshot, events))
        changed, due = telemetry.changed(self._reported), self.schedule.due(now)
        parameters = self.store.due(now)
        for place in self.audience.recipients(source, now):
            own = self.audience.schedule(place)
            streams = telemetry.messages(changed, due if own is None else own.due(now))
            packets += self.audience.send(place, texts + streams + parameters, now)
        if station is None or source is None:
            return packets
        # The clock of the station in control is requested, and the round trip measured; of no other.
        return packets + self.audience.answer(source, station.clocks.questions(now), source, now)
