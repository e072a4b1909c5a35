"""A device alone on a serial line that answers each request: link and driver, for a family to fill in.

One request is under way at a time. Of set-points that wait only the newest is sent; a task's requests go
before it, the request for a sample after it. A family gives a
`firmware_bridge.drivers.line_device.LineDevice`.
"""

from typing import Final

from firmware_bridge.drivers.driver import Feedback, Power, Reports, Stop
from firmware_bridge.drivers.life_cycle import FOUND, DriverState, Task, Transition
from firmware_bridge.drivers.line_device import LineDevice, Report
from firmware_bridge.drivers.line_driver import LOST, LineDriver, LineLink
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot.table import LineTable
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds
from firmware_bridge.wire.lines import LineReader

TRIES: Final = 3
"""Requests of a task without an answer, after which it has failed; a device is looked for longer."""
MISSED: Final[Nanoseconds] = 2_900 * MILLISECOND
"""A device that has not answered by then is reported as missing."""
REFUSED: Final = frozenset({Transition.HOME, Transition.SET_ZERO, Transition.RESET})
"""An axis with travel needs a driver of its own; so does a device that can be reset."""
UNFOUND: Final = "it has to be found first"


class LineAxis(LineDriver):
    """The axis of the device."""

    def __init__(self, device: LineDevice, line: LineLink) -> None:
        super().__init__(device.axis, line, device.reports)
        self._newest: Report | None = None

    @property
    def feedback(self) -> Feedback:
        """The state that it has reported."""
        newest, reports = self._newest, self.reports
        if newest is None:
            return Feedback(axis=self.axis.name, reference_lost=Reports.ZERO not in reports)
        return Feedback(
            axis=self.axis.name,
            power=newest.power if self._line.configured else Power.UNKNOWN,
            received_at=self._received_at,
            sampled_at=self._sampled_at,
            position=newest.position,
            velocity=newest.velocity,
            current_a=newest.current_a,
            current_at=NEVER_RECEIVED if newest.current_a is None else self._received_at,
            fault=newest.fault,
            text=newest.text,
            reference_lost=Reports.ZERO not in reports,
        )

    @property
    def unpowered(self) -> bool:
        """True where its newest report is power off, and no power was requested since."""
        return not self.enabled and self._newest is not None and self._newest.power is Power.OFF

    def opened(self, task: Task) -> None:
        """Note the begin of a task."""
        if task is Task.ENABLE:
            self.enabled = True
        elif task in {Task.CONFIGURE, Task.LEAVE, Task.DISABLE}:
            self.enabled = False

    def reported(self, report: Report, sampled_at: Nanoseconds, now: Nanoseconds) -> None:
        """Take a report; `sampled_at` is the begin of the cycle that requested it."""
        self._newest, self._received_at = report, now
        self._sampled_at = max(self._sampled_at, sampled_at)


class RequestLine(LineLink):
    """A `firmware_bridge.drivers.link_drivers.DeviceLink`."""

    def __init__(self, name: str, table: LineTable, device: LineDevice) -> None:
        super().__init__(name, table.answers_within_ms * MILLISECOND, REFUSED)
        self.driver: Final = LineAxis(device, self)
        self._device: Final = device
        self._table: Final = table
        self._reader: Final = LineReader(device.end)
        self._found_once = False
        self._todo: tuple[bytes, ...] = ()
        """Requests of the task under way that are not answered."""
        self._set_point: bytes | None = None
        self._sample_due = False
        self._cycle_at: Nanoseconds = NEVER_RECEIVED
        self._open: bytes | None = None
        """The request whose answer is awaited."""
        self._of_task = False
        """True where it is the first of `_todo`."""
        self._sent_at: Nanoseconds = 0
        self._samples: Nanoseconds = NEVER_RECEIVED
        """The cycle that it samples."""
        self._tries = 0
        self._received_at: Nanoseconds = NEVER_RECEIVED
        self._found_until: Nanoseconds = 0

    def hint(self, now: Nanoseconds) -> str:
        """Return what to check where the device is looked for in vain."""
        since = self._found_until - self._table.found_within_ms * MILLISECOND
        missed = self.life.tasks[:1] == (Task.FIND,) and now - since >= MISSED
        return f"{self.name}: {self._table.silent_hint}" if missed else ""

    @property
    def wake_at(self) -> Nanoseconds:
        """At once where something is to be sent and the line is free; else when an answer is overdue."""
        if self._open is not None:
            return self._sent_at + self.answers_within
        # Tasks and samples are sent at once, or when the line is free again; a set-point waits to be woken.
        return 0 if self._set_point is not None and not self.gone else NEVER

    # For the axis

    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition, or one of its tasks."""
        self.end_tasks()
        self._set_point = None
        self.life.begin(transition, task, configured=self.configured)
        self._open_task(now)
        return self._go_on(now)

    def end_tasks(self) -> None:
        """Do those under way no more."""
        self.life.end()
        self._drop()

    def note_set_point(self) -> None:
        """Send the set-point as soon as the line is free, in place of one that waits."""
        set_point = self.driver.set_point
        if not isinstance(set_point, Stop) and self.driver.state is not DriverState.ACTIVE:
            set_point = Stop.STANDSTILL
        self._set_point = self._device.request(set_point)

    # For the link's drivers

    def sample(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Request a sample, unless that of the cycle before is not answered."""
        if self.configured and now - self._received_at >= self._table.silent_ms * MILLISECOND:
            self._forget()
        if self._sample_due or (self._open is not None and self._samples != NEVER_RECEIVED):
            self.late += 1
        elif self.configured:
            self._sample_due = True
        elif not self.life.tasks and self._found_once and not self.gone:
            # Lost, without a command: it is set up again when it answers, but not enabled.
            self.life.restore(FOUND)
            self._open_task(now)
        self._cycle_at = now
        return self._go_on(now)

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take bytes, or what became of the line; what answers no request is ignored."""
        if packet.address == LINE_LOST and not packet.payload:
            self.gone, self._open = LOST, None
            self._forget()
            if self.life.tasks:
                self._fail(LOST)
        elif packet.address == LINE_BACK and not packet.payload:
            self.gone = ""
        else:
            for line in self._reader.receive(packet.payload):
                answer = self._open is not None and self._device.read(self._open, line)
                if answer:
                    self._answered(answer if isinstance(answer, Report) else None, now)
        return self._go_on(now)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Give up, or send again, a request that has no answer in its time; send what waits."""
        if self._open is not None and now >= self._sent_at + self.answers_within:
            self._unanswered(now)
        return self._go_on(now)

    def _go_on(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Send the next request where the line is free."""
        if self._open is not None or self.gone:
            return ()
        self._of_task, self._samples = bool(self._todo), NEVER_RECEIVED
        if self._todo:
            self._open = self._todo[0]
        elif self._set_point is not None:
            self._open, self._set_point = self._set_point, None
        elif self._sample_due:
            self._open, self._sample_due, self._samples = self._device.question, False, self._cycle_at
        else:
            return ()
        self.commands += 1
        self._sent_at = now
        # Half a line from before would spoil the answer.
        self._reader.flush()
        return (Packet(self.name, 0, self._open + self._device.end),)

    def _answered(self, report: Report | None, now: Nanoseconds) -> None:
        self._open, self._received_at, self._tries = None, now, 0
        self.busy += now - self._sent_at
        if report is not None:
            self.driver.reported(report, self._samples, now)
        if self._samples != NEVER_RECEIVED:
            self.longest_cycle = max(self.longest_cycle, now - self._samples)
        if self._of_task:
            self._todo = self._todo[1:]
            if not self._todo:
                self._close_task(now)

    def _unanswered(self, now: Nanoseconds) -> None:
        self._open = None
        self.busy += now - self._sent_at
        # The next cycle repeats a set-point and a sample: they are up to date then.
        if self._of_task:
            self._tries += 1
            finding = self.life.tasks[0] is Task.FIND
            if now >= self._found_until if finding else self._tries >= TRIES:
                self._fail(f"no answer to {self._todo[0]!r}: {self._table.silent_hint}")

    # Tasks

    def _open_task(self, now: Nanoseconds) -> None:
        """Begin the first of the tasks that are left; one without requests is done at once."""
        while self.life.tasks:
            task, self._tries = self.life.tasks[0], 0
            if task is Task.ENABLE and not self.configured:
                self._fail(UNFOUND)
                return
            self.driver.opened(task)
            self._todo = self._device.tasks.get(task, ())
            if task is Task.FIND:
                self.configured = False
                self._found_until = now + self._table.found_within_ms * MILLISECOND
            if task in {Task.FIND, Task.START}:
                self._todo = (self._device.question, *self._todo)
            if self._todo:
                return
            self._end_task()

    def _close_task(self, now: Nanoseconds) -> None:
        """End the task under way, and begin the next one."""
        self._end_task()
        self._open_task(now)

    def _end_task(self) -> None:
        if self.life.tasks[0] is Task.CONFIGURE:
            self.configured = self._found_once = True
        self.life.done()

    def _fail(self, problem: str) -> None:
        self.life.fail(problem)
        self._drop()

    def _drop(self) -> None:
        self._todo, self._of_task = (), False

    def _forget(self) -> None:
        """Note that the device was silent for too long, or is not reached: it may have started again."""
        self.configured = self._sample_due = False
        self._set_point = None


def line_drivers(name: str, table: LineTable, device: LineDevice) -> LinkDrivers:
    """Return the devices on a link by its name: this one."""
    line = RequestLine(name, table, device)
    return LinkDrivers(line, table, (line.driver,))
