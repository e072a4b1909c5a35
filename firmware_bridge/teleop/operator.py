"""The operator's side of the bridge, whole: datagrams to intent and answers, snapshots to telemetry.

It opens no socket, reads no clock and judges nothing: requests go to the bridge through `decide`, limits are
the interlocks'. One station is in control; while none is, the newest command counts. An echo of our own
messages, and messages for other systems, are ignored. A robot's own use of them is in its station's rows.
"""

from typing import Any, Final

from firmware_bridge.intent import AgeLimit, Intent
from firmware_bridge.mavlink.frames import Counters, Message, concerns, dialect, speaks_mavlink_1, target_of
from firmware_bridge.mavlink.trust import Stamps, Trust, is_signed
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.snapshot import ActiveInterlock, AnySnapshot
from firmware_bridge.teleop.commands import requests_stop
from firmware_bridge.teleop.control import Sender
from firmware_bridge.teleop.exchange import Decide, Exchange
from firmware_bridge.teleop.messages import HANDLERS, LATER, stop_for_anybody
from firmware_bridge.teleop.session import ANY_STATION, MOST_PEERS, Dropped, Session
from firmware_bridge.teleop.station import AnyStation
from firmware_bridge.teleop.streams import Telemetry
from firmware_bridge.teleop.texts import InterlockTexts
from firmware_bridge.units import NEVER, Nanoseconds

RADIO_STATUS: Final = dialect.MAVLINK_MSG_ID_RADIO_STATUS


class Operator:
    """One robot's place on MAVLink."""

    def __init__(
        self,
        robot: AnyRobot,
        station: AnyStation,
        rest: Any,
        *,
        rolling: tuple[str, ...],
        modes: tuple[str, ...] = (),
        path_followers: tuple[str, ...] = (),
        trust: Trust = ANY_STATION,
    ) -> None:
        """Take the robot, its body's rolling axes, its type's rows, standstill, modes, path followers.

        `trust` decides whose frames are accepted.
        """
        self._session: Final = Session(
            robot, station, rest, rolling=rolling, modes=modes, path_followers=path_followers, trust=trust
        )
        self._texts: Final = InterlockTexts(self._session.speaker)
        self._reported: Final[dict[int, object]] = {}
        """The last values of the streams that are sent as soon as they change, by their place."""
        self._called: Final = {axis.name: axis.called for axis in robot.axes}
        self._faults: Final[dict[str, str]] = {}
        self._doubted_before: Final[set[Sender]] = set()
        self._foreign_nodes: list[str] = []

    @property
    def intent(self) -> Intent:
        """The operator's command now."""
        return self._session.intent

    @property
    def age_limit(self) -> AgeLimit:
        """Age limit of a motion command."""
        return self._session.age_limit

    def stamps(self, now: Nanoseconds) -> Stamps:
        """Return which signatures' time stamps must outlive this run."""
        return self._session.signatures.kept(now)

    @property
    def driver(self) -> Sender | None:
        """The station in control; None without one."""
        return self._session.control.driver

    @property
    def stations(self) -> tuple[Sender, ...]:
        """The stations on record."""
        return tuple(self._session.peers)

    @property
    def counters(self) -> Counters:
        """Count of frames received, corrupt and unknown."""
        return self._session.codec.counters

    @property
    def dropped(self) -> Dropped:
        """Messages that were understood and not obeyed."""
        return self._session.dropped

    @property
    def next_due(self) -> Nanoseconds:
        """The instant at which `report` has something to send, whatever happens until then."""
        session = self._session
        return min(session.schedule.next_due, session.audience.next_due, session.list_due)

    def receive(
        self, datagram: bytes, now: Nanoseconds, decide: Decide, source: int = 0
    ) -> tuple[Packet, ...]:
        """Take one datagram, have `decide` judge the requests that only the bridge grants; return answers.

        `source` is its origin: the packet's address. No bytes make it raise: bytes that are no MAVLink are
        counted and skipped.
        """
        session = self._session
        codec = session.codec
        replies: list[Message] = []
        good = beats = old = False
        for message in codec.decode(datagram):
            # The place belongs to it: two stations may have the same system and component.
            sender = Sender(source, message.get_srcSystem(), message.get_srcComponent())
            if sender[1:] == (codec.system, codec.component):
                session.dropped.echoed += 1
                self._say_if_namesake(message, sender)
                continue
            # Not ours, and counted all the same: gaps in the sequence are losses only where all frames are
            # seen.
            if not concerns(message, codec.system, codec.component):
                session.dropped.foreign += 1
                session.passed(sender, message.get_seq(), now)
                continue
            if message.get_msgId() == RADIO_STATUS:
                continue  # a telemetry radio puts it in, unsigned: a sign of no one's life
            doubt = session.signatures.doubt(message, source, now)
            if doubt is not None:
                stopped = self._doubted(message, sender, doubt, now, decide)
                good = good or bool(stopped)
                replies += stopped
                continue
            self._say_if_signed_in_vain(message)
            peer = session.received(sender, message, now)
            good = True
            old = speaks_mavlink_1(message)
            beats = beats or message.get_msgId() == dialect.MAVLINK_MSG_ID_HEARTBEAT
            # A second station with the same numbers may stop the robot, and nothing else.
            if (handle := (LATER if peer.later else HANDLERS).get(message.get_msgId())) is not None:
                exchange = Exchange(session, message, sender, now, decide)
                handle(exchange)
                replies += exchange.replies
        if not good:
            return ()
        session.audience.received(source, len(datagram), now, beats=beats, old=old)
        return session.audience.answer(source, replies, session.drives_from, now)

    def _doubted(
        self, message: Message, sender: Sender, doubt: str, now: Nanoseconds, decide: Decide
    ) -> list[Message]:
        """Obey an emergency stop of any sender; report of all else that it was refused."""
        session = self._session
        if requests_stop(message, session.station):
            exchange = Exchange(session, message, sender, now, decide, doubt=doubt)
            return stop_for_anybody(exchange)
        session.dropped.doubted += 1
        if sender not in self._doubted_before and len(self._doubted_before) < MOST_PEERS:
            self._doubted_before.add(sender)
            self._foreign_nodes.append(f"{sender} is not obeyed: it {doubt}")
        text = f"{message.get_type()} of {sender} refused: it {doubt}"
        session.unsent += session.speaker.say_sometimes("doubted", text, now)
        return []

    def take_new_stations(self) -> list[str]:
        """Return the untrusted senders since the last call, each once, with the reason; for the console.

        On the link only trusted stations receive texts, and there may be none.
        """
        new_stations, self._foreign_nodes = self._foreign_nodes, []
        return new_stations

    def _say_if_namesake(self, message: Message, sender: Sender) -> None:
        """Name a station with the robot's own identity: an echo of our messages is never addressed to us."""
        session = self._session
        station = message.get_type() == "HEARTBEAT" and message.type == dialect.MAV_TYPE_GCS
        to_us = target_of(message) == session.codec.system
        if (station or to_us) and not session.namesake:
            session.namesake = True
            text = f"a station calls itself {sender}, as this robot: it is ignored; let it be system 255"
            session.report(Severity.WARNING, text)

    def _say_if_signed_in_vain(self, message: Message) -> None:
        session = self._session
        if (
            session.trust.key is None
            and not session.signed_in_vain
            and is_signed(bytes(message.get_msgbuf()))
        ):
            session.signed_in_vain = True
            session.report(Severity.WARNING, "signatures are not checked: this bridge has no key")

    def lapse(self, now: Nanoseconds) -> bool:
        """Let no one drive where the driver is gone, and return whether he is; only when the robot rests."""
        session = self._session
        # The caller has found the robot at standstill: control never ends while it moves.
        if not session.control.lapses(now):
            return False
        text = f"control: {session.control.driver} is gone, no station in control"
        session.control.give_up()
        session.driven.begin()
        session.adopt(None, now)
        session.report(Severity.WARNING, text)
        return True

    def note(self, texts: tuple[str, ...]) -> None:
        """Report the findings of the start: now, and to each station that takes control."""
        self._session.notes = texts
        for text in texts:
            self._session.report(Severity.NOTICE, text)

    def take_returned_to_neutral(self) -> bool:
        """Return whether the station in control was neutral since the last call, even for one command."""
        returned_to_neutral, self._session.returned_to_neutral = self._session.returned_to_neutral, False
        return returned_to_neutral

    def forget(self) -> None:
        """Forget the targets of an operator who has gone silent."""
        self._session.forget()

    def report(
        self, snapshot: AnySnapshot, events: tuple[ActiveInterlock, ...], now: Nanoseconds
    ) -> tuple[Packet, ...]:
        """Return what is due now, in order: texts of what began or ended, telemetry, listed parameters."""
        session = self._session
        session.snapshot, session.events = snapshot, events
        # Before the texts are taken, so that they leave in this cycle.
        session.report_link(now)
        texts = session.unsent + self._texts.due(events, now) + self._fault_texts(snapshot)
        session.unsent = []
        packets: tuple[Packet, ...] = ()
        telemetry = Telemetry(session.streams, session.context(snapshot))
        changed, due = telemetry.changed(self._reported), session.schedule.due(now)
        parameters = self._parameters(now)
        for source in session.audience.recipients(session.drives_from, now):
            own = session.audience.schedule(source)
            streams = telemetry.messages(changed, due if own is None else own.due(now))
            packets += session.audience.send(source, texts + streams + parameters, now)
        return packets + self._questions(now)

    def _questions(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Request the clock of the station in control, and measure the round trip; others get no request."""
        session, place = self._session, self._session.drives_from
        if place is None:
            return ()
        return session.audience.answer(place, session.ages.questions(now), place, now)

    def _fault_texts(self, snapshot: AnySnapshot) -> list[Message]:
        messages: list[Message] = []
        say = self._session.speaker.say
        for axis in snapshot.facts.axes.values():
            before = self._faults.get(axis.axis, "")
            if axis.fault == before:
                continue
            self._faults[axis.axis] = axis.fault
            called = self._called[axis.axis]
            if axis.fault:
                messages += say(Severity.CRITICAL, f"{called}: fault {axis.fault}")
            else:
                messages += say(Severity.INFO, f"{called}: fault cleared")
        return messages

    def _parameters(self, now: Nanoseconds) -> list[Message]:
        session = self._session
        messages: list[Message] = []
        while session.list_due <= now:
            messages.append(session.store.message(session.listed))
            session.listed += 1
            last = session.listed >= len(session.store.rows)
            session.list_due = NEVER if last else session.list_due + session.listing_gap
        return messages
