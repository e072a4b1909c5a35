"""A board on its serial line, as a link of the robot: its commands, their order, its answers.

One request is under way at a time. The motors' commands go first, then the requests of a cycle, then set-up.
A board that was silent for longer than its link allows may have started again: it is commanded to release its
motors until it answers, and then set up again, which begins with that; to drive it must be enabled.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Final

from firmware_bridge.drivers.driver import Stop
from firmware_bridge.drivers.life_cycle import FOUND, NOT_ENDED, Task, Transition
from firmware_bridge.drivers.line_driver import LOST, LineLink
from firmware_bridge.families.motor_shield.driver.booting import FOUND_EVERY, TRIES, Booting
from firmware_bridge.families.motor_shield.driver.dialects import BoardMessage, Dialect, Numbers
from firmware_bridge.families.motor_shield.driver.expressed import expressed
from firmware_bridge.families.motor_shield.driver.releasing import Releasing
from firmware_bridge.families.motor_shield.driver.waiting import Part, Waiting
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

if TYPE_CHECKING:
    from firmware_bridge.families.motor_shield.driver.motor import ShieldMotor

RESTORING: Final = (Task.IDENTIFY, Task.CONFIGURE)
REFUSED: Final = frozenset({Transition.HOME, Transition.SET_ZERO})
"""A motor at a shield has no travel, and no one knows where it stands."""
_LETTING_GO: Final = (Task.LEAVE, Task.DISABLE)


class Board(LineLink):
    """A `firmware_bridge.drivers.link_drivers.DeviceLink`."""

    def __init__(self, name: str, table: ShieldLink, dialect: Dialect, answers_within: Nanoseconds) -> None:
        super().__init__(name, answers_within, REFUSED)
        self.motors: tuple[ShieldMotor, ...] = ()
        self.clock: Nanoseconds = 0
        self._dialect: Final = dialect
        self._reader = dialect.reader()
        self._silent_after: Final = table.silent_ms * MILLISECOND
        self._patience: Final = table.answers_within_ms * MILLISECOND
        self._booting: Final = Booting(name, table, dialect.begins)
        self._dirty = self._set_up_once = False
        self._received_at: Nanoseconds = NEVER_RECEIVED
        self._question: BoardMessage | None = None
        self._requested_at: Nanoseconds = 0
        self._until: Nanoseconds = NEVER
        self._tries = 0
        self._questions = 0
        self._waiting: Final = Waiting()
        self._begun: tuple[Transition, Task | None, Nanoseconds] | None = None
        self._misses = 0
        """Commands of the task under way that were not answered."""
        self._starts_until: Nanoseconds = NEVER
        self._cycle_at: Nanoseconds = NEVER_RECEIVED
        self._scripts: Final[Mapping[Task, Callable[[], Iterator[BoardMessage] | None]]] = {
            Task.FIND: self._find,
            Task.IDENTIFY: self._identify,
            Task.CONFIGURE: dialect.set_up,
            Task.START: self._start,
            Task.ENABLE: self._enable,
            Task.LEAVE: self._release_all,
            Task.DISABLE: self._release_all,
        }
        """The commands of a task; None where it waits, or has failed. Other tasks need none."""
        self._releasing: Final = Releasing()

    def hint(self, now: Nanoseconds) -> str:
        """Return what to check where the board is looked for in vain."""
        return self._booting.hint(now) if self.life.tasks[:1] == (Task.FIND,) else ""

    @property
    def wake_at(self) -> Nanoseconds:
        """At once where a command is to be sent and the line is free; else when an answer is overdue."""
        if self._question is None and not self.gone:
            wanted = self._dirty and not self.life.tasks
            if wanted or self._waiting.urgent:
                return self._booting.speaks_at
            scripted = max(self._booting.quiet_until, self._booting.speaks_at)
            return scripted if self._waiting.scripted else self._starts_until
        return self._until

    # For the motors

    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition; each motor of the board requests it, and it is done once."""
        self.clock = now
        if self._begun == (transition, task, now):
            return ()
        self._begun = (transition, task, now)
        self.end_tasks()
        self.life.begin(transition, task, configured=self.configured)
        if self.life.tasks:
            self._drop()
        return self._open_task() + self._go_on(now)

    def end_tasks(self) -> None:
        """Do those under way no more; what comes in their place waits for no quiet line."""
        self._booting.quiet_until = 0
        self.life.end()
        self._waiting.end()
        self._starts_until = NEVER

    def note_set_point(self) -> None:
        """Say what the motors want, as soon as the line is free."""
        self._dirty = True

    # For the link's drivers

    def sample(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask for all counts, unless the questions of the cycle before are not answered."""
        self.clock = now
        if self.configured and now - self._received_at >= self._silent_after:
            self._forget()
        waiting = self._waiting
        if waiting.samples or (self._question is not None and waiting.part is Part.SAMPLE):
            self.late += 1
            return self._go_on(now)
        if self.configured:
            self._cycle_at = now
            waiting.samples.extend(self._dialect.encoders())
        if not waiting.samples and not self.life.tasks and self._set_up_once:
            if now >= self._booting.seeks_at:
                self._booting.lost(now)
                self.life.restore((Task.RESET,))
                return self._open_task()
            waiting.samples.append(self._dialect.find())
        return self._go_on(now)

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take bytes, or what became of the line; what answers no question is ignored."""
        self.clock = now
        self._booting.receives(now)
        if packet.address == LINE_LOST and not packet.payload:
            self._lose()
        elif packet.address == LINE_BACK and not packet.payload:
            self.gone = ""
            self._booting.begun(now)
        else:
            if not self.configured:
                self._booting.take_bytes(packet.payload)
            for answer in self._reader.receive(packet.payload):
                question = self._question
                numbers = None if question is None or question.reads is None else question.reads(answer)
                if question is not None and numbers is not None:
                    self._end(question, numbers, now)
        return self._go_on(now)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask again, or give up, what has no answer in its time; say what waits."""
        self.clock = now
        question = self._question
        sent: tuple[Packet, ...] = ()
        if question is not None and now >= self._until:
            self.busy += now - self._requested_at
            self._question, self._reader = None, self._dialect.reader()
            self._releasing.forget()
            sent = self._again(question, now)
        elif self._starts_until <= now:
            self._fail("the encoders report nothing")
        return sent + self._go_on(now)

    # Sending

    def _go_on(self, now: Nanoseconds) -> tuple[Packet, ...]:
        sent: list[Packet] = []
        while self._question is None and not self.gone and now >= self._booting.speaks_at:
            if self._dirty and not self._waiting.motion and not self.life.tasks:
                self._express(now)
            message = self._taken()
            if message is None:
                break
            sent += self._encoded(message, now)
        return tuple(sent)

    def _taken(self) -> BoardMessage | None:
        """Return the next command."""
        self._tries = 0
        message = self._waiting.take(quiet=self.clock < self._booting.quiet_until)
        if message is not None and message.reads is None and self._waiting.part is Part.TASK:
            self._advance()
        return message

    def _advance(self) -> None:
        """Go on to the next command of the task under way, or to the next task."""
        if not self._waiting.advance():
            self._close_task()
        elif self._waiting.last and self.life.tasks[0] in _LETTING_GO:
            self._releasing.begin(self.motors, self._questions)

    def _encoded(self, message: BoardMessage, now: Nanoseconds) -> tuple[Packet, ...]:
        self.commands += 1
        before: Iterable[BoardMessage] = ()
        if message.reads is not None:
            self._question, self._requested_at = message, now
            finding = self.life.tasks[:1] == (Task.FIND,)
            self._until = now + (FOUND_EVERY if finding else self._patience)
            self._questions += 1
            if finding and self.life.state in NOT_ENDED and not self._dialect.on_board:
                # Its shield drives on until commanded, and its answers may not come through.
                before = self._dialect.release_again(motor.number for motor in self.motors)
        return tuple([Packet(self.name, 0, command.data) for command in (*before, message)])

    def _express(self, now: Nanoseconds) -> None:
        """Make commands of the motors' set-points."""
        self._dirty = False
        commands, released = expressed(self._dialect, self.motors, now, configured=self.configured)
        self._waiting.motion.extend(commands)
        if released is not None:
            self._releasing.begin(released, self._questions, commands)

    # What is answered

    def _end(self, question: BoardMessage, numbers: Numbers, now: Nanoseconds) -> None:
        self._question, self._received_at = None, now
        self.busy += now - self._requested_at
        self._releasing.answered(self._questions, self.motors)
        if question.wanted is not None and numbers != question.wanted:
            counted, wanted = (", ".join(map(str, them)) for them in (numbers, question.wanted))
            self._fail(f"{question.what}: it reports {counted}, expected {wanted}")
            return
        self._count(question, numbers)
        if self._waiting.part is Part.TASK:
            self._advance()
        elif not self.configured:
            self._restore()
        elif self._waiting.part is Part.SAMPLE:
            self._sampled(now)
        elif not self.life.tasks and not self._waiting.motion:
            self.longest_cycle = max(self.longest_cycle, now - self._cycle_at)

    def _count(self, question: BoardMessage, numbers: Numbers) -> None:
        """Give the motors their counts."""
        for number, count in zip(question.counts, numbers, strict=False):
            for motor in self.motors:
                if motor.number == number and motor.measured:
                    motor.counted(count, self._dialect.bits, self._requested_at, self._cycle_at)

    def _sampled(self, now: Nanoseconds) -> None:
        """Learn that a question of the cycle is answered; with the last of them the sample is whole."""
        if self._waiting.samples:
            return
        for motor in self.motors:
            motor.sampled(self._cycle_at, now)
        if Task.START in self.life.tasks[:1]:
            self._close_task()

    def _restore(self) -> None:
        """Set the board up that answers again; its motors are released by it, and stay so."""
        if self._waiting.part is Part.SAMPLE and not self.life.tasks:
            self.life.restore(RESTORING)
            self._open_task()

    def _again(self, question: BoardMessage, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask once more what has no answer, or give it up."""
        self._tries += 1
        finding = self.life.tasks[:1] == (Task.FIND,)
        if self._waiting.part is not Part.TASK:
            # The next cycle repeats the request; a motor's command is up to date then.
            self._waiting.samples.clear()
            return ()
        if finding and now < self._booting.found_until and self._tries >= TRIES:
            self._waiting.again(question)
            return self._booting.pulse(now)
        if self.life.tasks[0] in _LETTING_GO and self._misses < TRIES + len(self.motors):
            # One motor after the other, so that each is commanded once before the first is again.
            self._misses += 1
            self._waiting.later(question)
            return ()
        if now < self._booting.found_until if finding else self._tries < TRIES:
            return self._encoded(question, now)
        self._fail(self._booting.unanswered(question.what, found=not finding))
        return ()

    def _open_task(self) -> tuple[Packet, ...]:
        """Begin the first of the tasks that are left; return the packets before its own."""
        if not self.life.tasks:
            return ()
        task, self._misses = self.life.tasks[0], 0
        if reset := task is Task.RESET:
            task, self.life.tasks = Task.FIND, FOUND
        # A board that does not stop by itself has nothing but its reset when it hangs: it is tried at once.
        untried = task is Task.FIND and not self._set_up_once and not self._dialect.on_board
        pulse = self._booting.pulse(self.clock) if reset or untried else ()
        opens = self._scripts.get(task)
        script = iter(()) if opens is None else opens()
        if script is not None:
            self._waiting.begin(script)
            self._advance()
        return pulse

    def _find(self) -> Iterator[BoardMessage]:
        self._booting.looked_for(self.clock)
        if self.clock - self._received_at >= self._silent_after:
            # To open its port may have reset it.
            self._booting.begun(self.clock)
        self.configured = False
        return iter((self._dialect.find(),))

    def _identify(self) -> Iterator[BoardMessage]:
        self._booting.identified(self.clock)
        return iter((self._dialect.find(),))

    def _start(self) -> None:
        """Wait for the samples of a cycle."""
        self._starts_until = self.clock + TRIES * self._silent_after

    def _enable(self) -> Iterator[BoardMessage] | None:
        if not self.configured:
            self._fail("it has to be set up first")
            return None
        for motor in self.motors:
            motor.enabled, motor.set_point = True, Stop.STANDSTILL
        return iter(())

    def _release_all(self) -> Iterator[BoardMessage]:
        """Yield the commands that release all motors, and a request whose answer proves their arrival."""
        for motor in self.motors:
            motor.enabled, motor.set_point = False, Stop.POWER_OFF
        release = self._dialect.release if self.configured else self._dialect.release_again
        yield from release(motor.number for motor in self.motors)
        yield self._dialect.find()

    def _close_task(self) -> None:
        """End the task under way, and begin the next one."""
        done = self.life.tasks[0]
        self.life.done()
        self._starts_until = NEVER
        if done is Task.CONFIGURE:
            self.configured = self._set_up_once = True
            self.remark = self._booting.released(self.clock)
            for motor in self.motors:
                motor.begin_again()
            self._releasing.begin(self.motors, self._questions)
        self._open_task()

    def _fail(self, problem: str) -> None:
        self.life.fail(problem)
        self.end_tasks()

    def _forget(self) -> None:
        """Learn that the board was silent for too long: it may have started again, and nothing holds."""
        self.configured = self._dirty = False
        self._booting.lost(self.clock)
        self._waiting.motion.clear()
        for motor in self.motors:
            motor.enabled = motor.released = False

    def _drop(self) -> None:
        """Forget what waits, and the answer that is awaited."""
        self._dirty, self._question, self._until = False, None, NEVER
        self._releasing.forget()
        self._waiting.drop()
        self._reader = self._dialect.reader()

    def _lose(self) -> None:
        self.gone = LOST
        self._drop()
        self._forget()
        if self.life.tasks:
            self._fail(LOST)
