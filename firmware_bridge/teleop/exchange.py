"""One message from a ground station, and what it may bring about in the bridge."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from firmware_bridge.intent import EmergencyStop, Intent, Request, ResetOdometry, Verdict
from firmware_bridge.teleop.mavlink import Message
from firmware_bridge.teleop.session import Address, Peer, Session
from firmware_bridge.teleop.setpoints import pressed, stick_of, velocity_of
from firmware_bridge.teleop.station import AnyStation, Switch, Unusable
from firmware_bridge.units import Nanoseconds

Decide: TypeAlias = Callable[[Request], Verdict]


@dataclass(slots=True, eq=False)
class Exchange:
    """A message, its sender, and what is answered to it."""

    session: Session
    message: Message
    address: Address
    now: Nanoseconds
    decide: Decide
    replies: list[Message] = field(default_factory=list)

    @property
    def peer(self) -> Peer:
        """What is remembered of the sender."""
        return self.session.peer(self.address)

    @property
    def station(self) -> AnyStation:
        """The robot's rows."""
        return self.session.station

    @property
    def armed(self) -> bool:
        """Whether the robot may move, as of the newest snapshot."""
        return self.session.snapshot is not None and self.session.snapshot.facts.armed

    def request(self, request: Request) -> Verdict:
        """Ask the bridge; what of a wish does not outlive a change of state is forgotten."""
        verdict = self.decide(request)
        session = self.session
        if not verdict.accepted:
            return verdict
        if isinstance(request, ResetOdometry):
            session.resets += 1
        else:
            session.forget()
        if isinstance(request, EmergencyStop) and request.final:
            session.terminated = True
        return verdict

    def switch(self, switch: Switch[Any], *, on: bool) -> None:
        """Switch one of the station's switches."""
        self.session.wish(switch.write(self.session.intent.wish, on))

    def press(self, buttons: int) -> None:
        """Switch over what has its button among these, which have just gone down."""
        for switch in self.station.switches:
            if pressed(buttons, switch.button):
                self.switch(switch, on=not switch.read(self.session.intent.wish))

    def actuate(self, place: int, share: float) -> None:
        """Send an actuator of set 0 to a share of its travel, 0 to 1."""
        session = self.session
        session.wish(session.station.actuators[place].send(session.intent.wish, share, session.robot))

    def send(self, number: int) -> bool:
        """Send a message once; False where the bridge has none with this number."""
        messages = self.session.messages(number)
        self.replies += messages or ()
        return messages is not None

    def warn(self, key: str, text: str) -> None:
        """Send a reason, but not at the rate of a joystick."""
        self.replies += self.session.speaker.say_sometimes(key, text, self.now)

    def take_stick(self) -> None:
        """Take the axes of a MANUAL_CONTROL as the newest wish, or say why they are none."""
        session, station = self.session, self.session.station
        up = station.up_button is None or pressed(self.message.buttons, station.up_button)
        stick = stick_of(self.message, up=up, dead_band=station.dead_band)
        if isinstance(stick, Unusable):
            self.refuse(stick)
        else:
            wish = station.stick(stick, session.intent.wish, session.robot)
            self.move(wish, neutral=stick.let_go(station.dead_band))

    def take_target(self) -> None:
        """Take a SET_POSITION_TARGET_LOCAL_NED as the newest wish, or say why it is none."""
        session, station = self.session, self.session.station
        velocity = velocity_of(self.message, station.largest(session.robot))
        if isinstance(velocity, Unusable):
            self.refuse(velocity)
            return
        wish = station.target(velocity, session.intent.wish, session.robot)
        if isinstance(wish, Unusable):
            self.refuse(wish)
        else:
            self.move(wish, neutral=velocity.zero)

    def move(self, wish: object, *, neutral: bool) -> None:
        """Take a wish as the newest, unless a newer one has overtaken it."""
        if self.peer.is_newest(self.message.get_seq(), self.now):
            self.session.intent = Intent(wish, self.now, neutral=neutral)
        else:
            self.session.dropped.overtaken += 1

    def refuse(self, unusable: Unusable) -> None:
        """Say why a motion command is no wish."""
        self.session.dropped.refused += 1
        self.warn(unusable.key, f"{self.message.get_type()} refused: {unusable.reason}")
