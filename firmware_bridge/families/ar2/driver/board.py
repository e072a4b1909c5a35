"""The board of an AR2 arm on its serial line, as a link of the robot: requests, moves, and their proofs.

One move is under way at a time. Its end is known when the board has answered a line that was sent after it:
it reads one line after the other, and nothing while it moves. The arm's position is unknown when the bridge
begins, and after a silence longer than the link allows: a board that starts again ends its move somewhere.
The position is sent on the line, too, so that guard and recordings know it.
"""

from typing import Final, NamedTuple

from firmware_bridge.drivers.driver import Stop
from firmware_bridge.drivers.life_cycle import FOUND, Task, Transition
from firmware_bridge.drivers.line_driver import LOST
from firmware_bridge.families.ar2 import wire
from firmware_bridge.families.ar2.driver.joint import Ar2Joint, JointBoard
from firmware_bridge.families.ar2.driver.slices import Slice, slice_of
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.node import DTR_DOWN, DTR_UP, LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

FOUND_EVERY: Final[Nanoseconds] = 250 * MILLISECOND
TRIES: Final = 3
KEPT: Final = 256
"""Newest bytes that are searched for an answer."""
SILENT: Final = (
    "no answer to TM: is the board powered? is it this port? is it flashed with AR2 2.0? 1.5 has no such word"
)
MISSED: Final[Nanoseconds] = 2_900 * MILLISECOND
"""A board that has not answered by then is reported as missing."""
REQUESTS: Final = frozenset({Task.FIND, Task.IDENTIFY, Task.LEAVE, Task.DISABLE})
"""Tasks that are a question, and over when it is answered."""


class Question(NamedTuple):
    """A line that the board shall echo."""

    text: str
    joint: Ar2Joint | None = None
    """The joint whose position it carries."""


class Ar2Board(JointBoard):
    """A `firmware_bridge.drivers.link_drivers.DeviceLink`."""

    def __init__(self, name: str, table: Ar2Link) -> None:
        super().__init__(name, table.answers_within_ms * MILLISECOND, frozenset({Transition.HOME}))
        self.joints: tuple[Ar2Joint, ...] = ()
        self._table: Final = table
        self._silent_after: Final = table.silent_ms * MILLISECOND
        self._dirty = self._found_once = False
        self._received_at: Nanoseconds = NEVER_RECEIVED
        self._received = b""
        self._requested = 0
        self._question: Question | None = None
        self._requested_at: Nanoseconds = 0
        self._until: Nanoseconds = NEVER
        self._tries = 0
        self._move: Slice | None = None
        """The move whose end is not proved."""
        self._places: list[Question] = []
        """Positions to be sent."""
        self._placed = False
        """True where one was sent since the last sample."""
        self._begun: tuple[Transition, Task | None, Nanoseconds] | None = None
        self._speaks_at: Nanoseconds = 0
        """Time before which nothing is sent: it may be booting."""
        self._found_until: Nanoseconds = 0
        self._starts_until: Nanoseconds = NEVER
        self._cycle_at: Nanoseconds = NEVER_RECEIVED
        self._opens: Final = {
            Task.FIND: self._find,
            Task.CONFIGURE: self._configure,
            Task.START: self._start,
            Task.ENABLE: self._enable,
            Task.LEAVE: self._release_current,
            Task.DISABLE: self._release_current,
        }

    def hint(self, now: Nanoseconds) -> str:
        """Return what to check where the board is looked for in vain."""
        since = self._found_until - self._table.boots_within_ms * MILLISECOND
        missed = self.life.tasks[:1] == (Task.FIND,) and now - since >= MISSED
        return f"{self.name}: {SILENT}" if missed else ""

    @property
    def wake_at(self) -> Nanoseconds:
        """At once where a line is to be sent and the port is free; else when an answer is overdue."""
        if self._question is not None:
            return self._until
        if self.gone:
            return NEVER
        has_more = bool(self._places) or (self._dirty and self._may_move) or self._requests
        return self._speaks_at if has_more else self._starts_until

    # For the joints

    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition; each joint requests it, and it is done once."""
        if self._begun == (transition, task, now):
            return ()
        self._begun = (transition, task, now)
        self.end_tasks()
        self.life.begin(transition, task, configured=self.configured)
        return self._open_task(now) + self._go_on(now)

    def end_tasks(self) -> None:
        """Do those under way no more."""
        self.life.end()
        self._starts_until = NEVER

    def note_set_point(self) -> None:
        """Move the joints to where they are wanted, as soon as the line is free."""
        self._dirty = True

    def placed(self, joint: Ar2Joint, steps: int, now: Nanoseconds) -> tuple[Packet, ...]:
        """Say on the line where a joint stands; it counts from there once the board has echoed it."""
        joint.commanded = steps
        self._places.append(Question(wire.place(joint.number, steps), joint))
        return self._go_on(now)

    # For the link's drivers

    def sample(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Request proof that it is there, and has done its move, unless a request is under way."""
        if self.configured and now - self._received_at >= self._silent_after:
            self._forget(now)
        if self._question is not None:
            self.late += 1
        elif self.gone or now < self._speaks_at:
            return ()
        elif self.configured:
            self._cycle_at = now
            return (self._ask(Question(self._next_text()), now),)
        elif not self.life.tasks and self._found_once:
            # Lost, without a command: it is set up again when it answers, but not enabled.
            self.life.restore(FOUND)
            return self._open_task(now) + self._go_on(now)
        return ()

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take bytes, or what became of the line; what answers no question is ignored."""
        if packet.address == LINE_LOST and not packet.payload:
            self.gone = LOST
            self._question = None
            self._forget(now)
            if self.life.tasks:
                self._fail(LOST)
        elif packet.address == LINE_BACK and not packet.payload:
            self.gone = ""
            self._speaks_at = now + self._boots
        else:
            self._received = (self._received + bytes(packet.payload))[-KEPT:]
            question = self._question
            if question is not None and wire.echo(question.text) in self._received:
                self._received = b""
                self._answered(question, now)
        return self._go_on(now)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Give up, or ask again, what has no answer in its time; say what waits."""
        sent: tuple[Packet, ...] = ()
        if self._question is not None and now >= self._until:
            sent = self._unanswered(self._question, now)
        elif self._starts_until <= now:
            self._fail(SILENT)
        return sent + self._go_on(now)

    # Sending

    @property
    def _boots(self) -> Nanoseconds:
        return self._table.boots_ms * MILLISECOND

    @property
    def _requests(self) -> bool:
        """True where the task under way is a request that has not been sent."""
        return bool(self.life.tasks) and self.life.tasks[0] in REQUESTS

    @property
    def _may_move(self) -> bool:
        return self.configured and not self.life.tasks and self._move is None

    def _go_on(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Send the next line, where the port is free: a task's request, a position, a move."""
        if self._question is not None or self.gone or now < self._speaks_at:
            return ()
        if self._requests:
            return (self._ask(Question(self._next_text()), now),)
        if self._places:
            return (self._ask(self._places.pop(0), now),)
        if self._dirty and self._may_move:
            return self._moves()
        return ()

    def _next_text(self) -> str:
        """Return a text that no answer which is still under way can have."""
        self._requested += 1
        return f"q{self._requested}"

    def _ask(self, question: Question, now: Nanoseconds) -> Packet:
        self.commands += 1
        self._question, self._requested_at, self._received = question, now, b""
        finding = self.life.tasks[:1] == (Task.FIND,)
        # The sketch reads the next line only after the move: its answer may come that much later.
        moves = 0 if self._move is None else self._table.move
        self._until = now + (FOUND_EVERY if finding else self.answers_within + moves)
        return Packet(self.name, 0, wire.test(question.text))

    def _moves(self) -> tuple[Packet, ...]:
        """Send the joints a step further towards where they are wanted."""
        self._dirty = False
        steps, most = [0] * 6, [0] * 6
        for joint in self.joints:
            # Steps are digit 1's: `direction` is in what a joint counts.
            steps[joint.number - 1], most[joint.number - 1] = joint.wanted, joint.most
        self._move = slice_of(steps, most, self._table.move)
        if self._move is None:
            return ()
        self.commands += 1
        for joint in self.joints:
            # From here on a joint may turn, until an answer proves that none does.
            joint.released = False
        return (Packet(self.name, 0, self._move.line),)

    # What is answered

    def _answered(self, question: Question, now: Nanoseconds) -> None:
        self._question, self._received_at, self._tries = None, now, 0
        self.busy += now - self._requested_at
        self._prove()
        if question.joint is not None:
            question.joint.count, question.joint.commanded = question.joint.commanded, None
            self._placed = True
        elif self._requests:
            self._close_task(now)
        elif self.configured:
            self._sampled(now)

    def _prove(self) -> None:
        """Know that what was sent before is done: no move is under way."""
        for joint in self.joints:
            if self._move is not None:
                joint.moved(self._move.steps[joint.number - 1])
            joint.released = not joint.enabled
        self._move = None

    def _sampled(self, now: Nanoseconds) -> None:
        for joint in self.joints:
            joint.sampled(self._cycle_at, now, placed=self._placed)
        self._placed = False
        self.longest_cycle = max(self.longest_cycle, now - self._cycle_at)
        if self.life.tasks[:1] == (Task.START,):
            self._close_task(now)

    def _unanswered(self, question: Question, now: Nanoseconds) -> tuple[Packet, ...]:
        """Repeat a request without an answer, or give it up: the next cycle repeats it."""
        self.busy += now - self._requested_at
        self._question = None
        if question.joint is not None:
            question.joint.commanded = None
        elif self._requests:
            self._tries += 1
            finding = self.life.tasks[0] is Task.FIND
            if now < self._found_until if finding else self._tries < TRIES:
                return (self._ask(Question(self._next_text()), now),)
            self._fail(SILENT)
        return ()

    # Tasks

    def _open_task(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Begin the first of the tasks that are left; return the packets before its own."""
        while self.life.tasks:
            task, self._tries = self.life.tasks[0], 0
            if task is Task.RESET:
                self.life.tasks = FOUND
                self._question = None
                self._forget(now)
                self._find(now)
                self._speaks_at = now + self._boots
                return Packet(self.name, DTR_DOWN, b""), Packet(self.name, DTR_UP, b"")
            opens = self._opens.get(task)
            if opens is not None:
                opens(now)
            if task in REQUESTS or task is Task.START or not self.life.tasks:
                break
            self.life.done()
        return ()

    def _close_task(self, now: Nanoseconds) -> None:
        """End the task under way, and begin the next one."""
        self.life.done()
        self._starts_until = NEVER
        self._open_task(now)

    def _find(self, now: Nanoseconds) -> None:
        if now - self._received_at >= self._silent_after:
            # To open its port may have reset it.
            self._speaks_at = max(self._speaks_at, now + self._boots)
        self.configured = False
        self._found_until = now + self._table.boots_within_ms * MILLISECOND

    def _configure(self, _now: Nanoseconds) -> None:
        """Know that it is there; a board that was just found may have begun again."""
        self.configured = self._found_once = True
        for joint in self.joints:
            # After a reset the arm stands somewhere within the move that it broke off.
            joint.lost()

    def _start(self, now: Nanoseconds) -> None:
        self._starts_until = now + TRIES * self._silent_after

    def _enable(self, _now: Nanoseconds) -> None:
        if not self.configured:
            self._fail("it has to be found first")
            return
        for joint in self.joints:
            joint.enabled, joint.released, joint.set_point = True, False, Stop.STANDSTILL

    def _release_current(self, _now: Nanoseconds) -> None:
        """Move no joint any more; the answer to the question proves that none does."""
        for joint in self.joints:
            joint.enabled, joint.released, joint.set_point = False, False, Stop.POWER_OFF

    def _fail(self, problem: str) -> None:
        self.life.fail(problem)
        self.end_tasks()

    def _forget(self, now: Nanoseconds) -> None:
        """Note that the board was silent for too long: it may have started again, in the middle of a move."""
        self.configured = self._dirty = False
        self._speaks_at = max(self._speaks_at, now)
        self._move = None
        self._places.clear()
        for joint in self.joints:
            joint.lost()
