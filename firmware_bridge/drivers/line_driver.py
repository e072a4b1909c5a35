"""An axis whose device is commanded with others of its serial line, or alone there, by requests.

The line has one life cycle and sends the set-points, when it is free.
"""

from abc import abstractmethod
from typing import Final

from firmware_bridge.drivers.driver import Feedback, Power, Reports, SetPoint, StartupError, Stop
from firmware_bridge.drivers.life_cycle import NOT_ENDED, DriverState, LifeCycle, Task, Transition
from firmware_bridge.drivers.plain_link import PlainLink
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis
from firmware_bridge.units import NEVER, Nanoseconds

LOST: Final = "the serial line is gone"


class LineLink(PlainLink):
    """The line: base of a `firmware_bridge.drivers.link_drivers.DeviceLink`."""

    def __init__(
        self, name: str, answers_within: Nanoseconds, refused: frozenset[Transition] = frozenset()
    ) -> None:
        super().__init__(name, answers_within)
        self.life: Final = LifeCycle(refused)
        """The life cycle of all its axes."""
        self.configured = False
        """True where the set-up is in force: the device was found, and not lost since."""

    @abstractmethod
    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition, or one of its tasks, for all axes of the line."""

    @abstractmethod
    def end_tasks(self) -> None:
        """Do those under way no more."""

    @abstractmethod
    def note_set_point(self) -> None:
        """Send the axes' set-points, as soon as the line is free."""


class LineDriver:
    """A `firmware_bridge.drivers.driver.Driver`; a family overrides its part."""

    def __init__(self, axis: Axis, line: LineLink, reports: frozenset[Reports]) -> None:
        self.axis: Final = axis
        self.reports: Final = reports
        self._line: Final = line
        self.set_point: SetPoint = Stop.STANDSTILL
        self.enabled = False
        """True from the request for power until it is taken off."""
        self.released = False
        """True where the device has confirmed that it has no power, and none was requested since."""
        self._position = self._velocity = 0.0
        self._received_at: Nanoseconds = NEVER_RECEIVED
        self._sampled_at: Nanoseconds = NEVER_RECEIVED

    @property
    @abstractmethod
    def feedback(self) -> Feedback:
        """The state that it has reported."""

    def as_commanded(self, powered: str, unpowered: str, *, reference_lost: bool) -> Feedback:
        """Return the feedback of a device that reports no power: the one that was commanded and acknowledged.

        The texts are those of its two states.
        """
        power = Power.UNKNOWN
        if self._line.configured and self._received_at != NEVER_RECEIVED:
            power = Power.ON if self.enabled else Power.OFF
        return Feedback(
            axis=self.axis.name,
            power=power,
            received_at=self._received_at,
            sampled_at=self._sampled_at,
            position=self._position,
            velocity=self._velocity,
            text="" if power is Power.UNKNOWN else powered if self.enabled else unpowered,
            reference_lost=reference_lost,
        )

    @property
    def sampled_at(self) -> Nanoseconds:
        """Time of its newest sample."""
        return self._sampled_at

    @property
    def between(self) -> None:
        """None: its device sends no position between samples."""

    @property
    def state(self) -> DriverState:
        """Its place in the life cycle: the line's, but inactive where it alone has no power."""
        state = self._line.life.seen(configured=self._line.configured)
        return DriverState.INACTIVE if state is DriverState.ACTIVE and not self.enabled else state

    @property
    def failure(self) -> StartupError | None:
        """The failure, or the refusal, of the line's last transition."""
        problem = self._line.life.problem
        return None if problem is None else StartupError(self.axis, problem)

    @property
    def unpowered(self) -> bool:
        """True where the device has confirmed that it has no power, and none was requested since."""
        return self.released

    @property
    def wake_at(self) -> Nanoseconds:
        """Never: the line is woken."""
        return NEVER

    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition, or only that one of its tasks, with all axes of the line."""
        return self._line.begin(transition, now, task)

    def set_zero(self, position: float, now: Nanoseconds) -> tuple[Packet, ...]:
        """Refuse it: an axis with travel overrides this."""
        del position
        return self._line.begin(Transition.SET_ZERO, now)

    def command(self, set_point: SetPoint) -> tuple[Packet, ...]:
        """Note a set-point; while tasks are under way only one that stops, unless they do so themselves."""
        life = self._line.life
        if life.tasks:
            if set_point not in {Stop.QUICK_STOP, Stop.POWER_OFF} or life.state in NOT_ENDED:
                return ()
            self._line.end_tasks()
        self.set_point = set_point
        if set_point is Stop.POWER_OFF:
            self.enabled = False
        self._line.note_set_point()
        return ()

    def release(self) -> tuple[Packet, ...]:
        """Do nothing: a request has no handshake beside its answer."""
        return ()

    def wake(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Do nothing: the line is woken."""
        return ()
