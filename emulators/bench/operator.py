"""A ground station that drives a mission and keeps a diary of what the robot answers: a Node.

It speaks MAVLink as another would: signs, scales and retries are written again, here and in `controls`, not
taken from the bridge, so that a mistake there is not repeated here.
"""

from collections.abc import Callable
from typing import Final, TypeAlias

import numpy as np

from emulators.bench import orders
from emulators.bench.bench_setup import BenchSetup
from emulators.bench.controls import Controls
from emulators.bench.foreign_datagrams import datagram
from emulators.bench.log import Diary, Subject, place_of
from emulators.bench.mission import Mission
from emulators.bench.step import Step
from firmware_bridge.mavlink.frames import Codec, Message, dialect, text_of
from firmware_bridge.mavlink.texts import TextCollector
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import NEVER, SECOND, Nanoseconds, from_seconds

SYSTEM: Final = 255
COMPONENT: Final = dialect.MAV_COMP_ID_MISSIONPLANNER

Reader: TypeAlias = Callable[[Message, Nanoseconds], None]


class ScriptedOperator:
    """One operator with a ground station, system 255; `diary` records the course of the mission."""

    def __init__(
        self,
        robot: AnyRobot,
        bench_setup: BenchSetup,
        mission: Mission,
        generator: np.random.Generator,
        *,
        begins: Nanoseconds = 0,
    ) -> None:
        """Take the mission in hand, whose steps count from `begins`.

        `generator` is drawn from only where the mission has a tremor.
        """
        self.diary = Diary()
        self.clock_ahead: Nanoseconds = 0
        """The station's own clock, less the world's."""
        self._robot = robot
        self._system: int = robot.operator.system_id
        self._component: int = robot.operator.component_id
        self._mission = mission
        self._codec = Codec(SYSTEM, COMPONENT)
        self._listener = TextCollector()
        self._period = SECOND // mission.send_hz
        self._controls = Controls(robot, bench_setup, mission, self._period, generator)
        self._pending: list[orders.Pending] = []
        self._titles: dict[int, str] = {}
        self._step = 0
        self._begins: Final = begins
        self._step_at = self._due_of_step()
        self._silent_until: Nanoseconds = 0
        self._beat_due: Nanoseconds = begins
        self._send_due: Nanoseconds = begins
        self._greetings: list[Message] = []
        self._answers: list[Message] = []
        self._received: Final[dict[int, Reader]] = {
            dialect.MAVLINK_MSG_ID_HEARTBEAT: self._heartbeat,
            dialect.MAVLINK_MSG_ID_COMMAND_ACK: self._acknowledged,
            dialect.MAVLINK_MSG_ID_STATUSTEXT: self._on_text,
            dialect.MAVLINK_MSG_ID_ODOMETRY: self._located,
            dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT: self._valued,
            dialect.MAVLINK_MSG_ID_NAMED_VALUE_INT: self._valued,
            dialect.MAVLINK_MSG_ID_PARAM_VALUE: self._parametrized,
            dialect.MAVLINK_MSG_ID_TIMESYNC: self._on_timesync,
            dialect.MAVLINK_MSG_ID_PING: self._pinged,
        }  # all other messages are left packed

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Read telemetry and answers; a command that must be repeated is repeated in time."""
        for message in self._codec.decode(packet.payload, self._received):
            if message.get_srcSystem() == self._system:
                self._received[message.get_msgId()](message, now)
        answers = tuple(Packet(OPERATOR, 0, self._codec.encode(answer)) for answer in self._answers)
        self._answers.clear()
        return Reaction(() if now < self._silent_until else answers, self._wake_at())

    def wake(self, now: Nanoseconds) -> Reaction:
        """Take the steps that are due, then send what is due."""
        sent: list[bytes] = []
        while self._step_at <= now:
            sent += self._take(self._mission.step[self._step], now)
            self._step += 1
            self._step_at = self._due_of_step()
        self._controls.release(now)
        sent += self._due(now)
        if now < self._silent_until:
            sent.clear()
        return Reaction(tuple(Packet(OPERATOR, 0, payload) for payload in sent), self._wake_at())

    def take_over(self, mission: Mission) -> None:
        """Go on with another mission that has been the same so far; ValueError where it has not.

        Its next step may come with the operator's next message at the earliest.
        """
        before, done = self._mission, self._step
        to_come = {"title": mission.title, "duration_s": mission.duration_s, "step": mission.step}
        if mission.step[:done] != before.step[:done] or before.model_copy(update=to_come) != mission:
            raise ValueError(f"'{mission.title}' is not '{before.title}' with other steps to come")
        self._mission = mission
        self._step_at = self._due_of_step()

    def _due_of_step(self) -> Nanoseconds:
        steps = self._mission.step
        return self._begins + from_seconds(steps[self._step].at_s) if self._step < len(steps) else NEVER

    def _wake_at(self) -> Nanoseconds:
        due = min(self._beat_due, self._send_due)
        due = min(due, self._step_at)
        due = min(due, self._controls.released_at)
        for pending in orders.first_of_each(self._pending):
            due = min(due, pending.due)
        return due

    def _take(self, step: Step, now: Nanoseconds) -> list[bytes]:
        self.diary.note(now, Subject.STEP, step.title)
        self._controls.move(step, now)
        if step.silent_s is not None:
            self._silent_until = now + from_seconds(step.silent_s)
        ordered = list(orders.of_step(step, self._robot, now))
        numbers = {pending.number for pending in ordered}
        # COMMAND_ACK carries the number alone: a new command takes the place of one of the same number.
        self._pending = [old for old in self._pending if old.number not in numbers] + ordered
        self._titles |= {pending.number: pending.title for pending in ordered}
        if step.stray is None:
            return []
        return [datagram(step.stray, self._codec, self._system, self._component)]

    def _due(self, now: Nanoseconds) -> list[bytes]:
        messages: list[Message] = []
        if now >= self._beat_due:
            # On a grid: a late wake-up shifts no later heartbeat.
            self._beat_due += SECOND
            station, none = dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID
            messages.append(
                dialect.MAVLink_heartbeat_message(station, none, 0, 0, dialect.MAV_STATE_ACTIVE, 3)
            )
        messages += self._greetings
        self._greetings.clear()
        messages += self._insisted(now)
        if now >= self._send_due:
            self._send_due += self._period
            clock = now + self.clock_ahead
            messages.append(self._controls.message(self._system, self._component, now, clock))
        return [self._codec.encode(message) for message in messages]

    def _insisted(self, now: Nanoseconds) -> list[Message]:
        messages: list[Message] = []
        # What is not sent must not count as a try without an answer.
        if now < self._silent_until:
            for pending in self._pending:
                pending.due = max(pending.due, self._silent_until)
            return messages
        for pending in [one for one in orders.first_of_each(self._pending) if one.due <= now]:
            if pending.tries == orders.MOST_TRIES:
                self._pending.remove(pending)
                self.diary.note(now, Subject.UNANSWERED, pending.title)
            else:
                messages.append(pending.message(self._system, self._component, now))
        return messages

    def _heartbeat(self, message: Message, now: Nanoseconds) -> None:
        armed = bool(message.base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED)
        # With the first heartbeat a station requests the parameters, as the common ones do.
        if self.diary.armed is None:
            self._greetings.append(dialect.MAVLink_param_request_list_message(self._system, self._component))
        if armed != self.diary.armed:
            self.diary.note(now, Subject.STATUS, "armed" if armed else "disarmed")
        self.diary.armed = armed
        self.diary.status = message.system_status

    def _acknowledged(self, message: Message, now: Nanoseconds) -> None:
        # All stations are on one link: an acknowledge to another one is not this station's.
        if message.target_system not in (0, SYSTEM):
            return
        first = orders.first_of_each(self._pending)
        waiting = [pending for pending in first if pending.number == message.command]
        again = message.result == dialect.MAV_RESULT_TEMPORARILY_REJECTED
        for pending in waiting:
            if not (again and pending.try_again(now)):
                self._pending.remove(pending)
                for one in self._pending:
                    one.due = (
                        max(one.due, now + orders.NEXT_AFTER) if one.number == pending.number else one.due
                    )
        if again and waiting and waiting[0].rejections > 1:
            return
        # A second answer, to one that was ordered twice, has the name of what was ordered last.
        title = (
            waiting[0].title if waiting else self._titles.get(message.command, f"command {message.command}")
        )
        result = orders.RESULTS.get(message.result, f"result {message.result}")
        self.diary.note(now, Subject.ANSWERED, f"{title}: {result}")

    def _on_text(self, message: Message, now: Nanoseconds) -> None:
        for received in self._listener.receive(message):
            self.diary.note(now, Subject.REPORTED, received.text, received.severity)

    def _located(self, message: Message, now: Nanoseconds) -> None:
        self.diary.odometry.append(place_of(message, now))

    def _on_timesync(self, message: Message, now: Nanoseconds) -> None:
        # TIMESYNC: 0 in tc1 marks a request; an answer with 0 would be one, too.
        if message.tc1 == 0:
            clock = max(now + self.clock_ahead, 1)
            self._answers.append(dialect.MAVLink_timesync_message(clock, message.ts1))

    def _pinged(self, message: Message, _: Nanoseconds) -> None:
        # PING: target 0 is a request, and the answer names its sender.
        if message.target_system == 0:
            who = (message.get_srcSystem(), message.get_srcComponent())
            self._answers.append(dialect.MAVLink_ping_message(message.time_usec, message.seq, *who))

    def _valued(self, message: Message, _: Nanoseconds) -> None:
        self.diary.values[text_of(message.name)] = message.value

    def _parametrized(self, message: Message, _: Nanoseconds) -> None:
        self.diary.parameters[text_of(message.param_id)] = message.param_value
