"""A node's commands on one link put on a serial line: they become bytes, one after the other.

It is to commands what a controller is to CAN frames: behind it is only the wire. The meaning of a command is
not known here. Commands for a line that is gone are dropped; the node knows.
"""

from collections import deque
from typing import Final

from firmware_bridge.families.epos2.maxon.frame import Frame, Generation, Outcome
from firmware_bridge.families.epos2.maxon.lines import host_end
from firmware_bridge.families.epos2.maxon.opcodes import COMMANDS
from firmware_bridge.families.epos2.maxon.packets import outcome_packet
from firmware_bridge.node import LINE_BACK, LINE_LOST, Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

TIMEOUT: Final[Nanoseconds] = 700 * MILLISECOND
"""For each step of the drive. The gateway gives up after 500 ms; an answer that came later than this would
be taken for that of the next command."""


class MaxonLine:
    """A node whose commands on this link go over a serial line; its other links are left alone."""

    def __init__(self, node: Node, generation: Generation, link: str) -> None:
        """Take the node, what the line speaks, and the name that the link has on both sides."""
        self.node = node
        self._link = link
        self.commands = 0
        """Commands that have begun so far."""
        self.busy: Nanoseconds = 0
        """Total time of commands under way so far."""
        self._begun_at: Nanoseconds = 0
        self._generation = generation
        self._host = host_end(generation, TIMEOUT)
        self._waiting: deque[Packet] = deque()
        self._under_way = 0
        """The opcode of the command that is on the line."""
        self._outbox: list[Packet] = []
        self._wake_at: Nanoseconds = 0
        self._gone = False

    @property
    def holding(self) -> bool:
        """True while the node keeps the robot from moving after a command to end."""
        return holds(self.node)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take bytes of the line, or a packet of another link."""
        if packet.link != self._link:
            self._take(self.node.receive(packet, now))
        elif packet.address == LINE_LOST:
            self._lose(now)
        elif packet.address == LINE_BACK:
            self._gone = False
            self._take(self.node.receive(Packet(self._link, LINE_BACK, b""), now))
        else:
            self._end(self._host.receive(packet.payload, now), now)
        return self._reaction(now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Give up what has lasted too long, and wake the node where that is due."""
        self._end(self._host.wake(now), now)
        if self._wake_at <= now:
            self._take(self.node.wake(now))
        return self._reaction(now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Ask the node to end; what it sends because of it still leaves."""
        if isinstance(self.node, Stoppable):
            self._take(self.node.stop(now))
        return self._reaction(now)

    def _lose(self, now: Nanoseconds) -> None:
        self._gone = True
        self._waiting.clear()
        # A new one, as the protocol's state of the lost line is worth nothing.
        self._host = host_end(self._generation, TIMEOUT)
        self._take(self.node.receive(Packet(self._link, LINE_LOST, b""), now))

    def _end(self, outcome: Outcome | None, now: Nanoseconds) -> None:
        if outcome is not None:
            self.busy += now - self._begun_at
            # What the protocol still has to send the drive leaves before the next command.
            self._say()
            self._take(self.node.receive(outcome_packet(self._under_way, outcome, self._link), now))

    def _take(self, reaction: Reaction) -> None:
        self._wake_at = reaction.wake_at
        for packet in reaction.sent:
            if packet.link != self._link:
                self._outbox.append(packet)
            elif not self._gone:
                self._waiting.append(packet)

    def _reaction(self, now: Nanoseconds) -> Reaction:
        host, waiting = self._host, self._waiting
        # V1 needs silence after a failure, until the drive has given up the old command.
        if waiting and not host.busy and now >= host.ready_at:
            packet = waiting.popleft()
            self._under_way, self._begun_at = packet.address, now
            answered = self._generation in COMMANDS[packet.address].answered
            host.ask(Frame(packet.address, packet.payload), now, answered=answered)
            self.commands += 1
        self._say()
        sent = tuple(self._outbox)
        self._outbox.clear()
        ready_at = host.ready_at if waiting and not host.busy else NEVER
        return Reaction(sent, min(self._wake_at, host.due, ready_at))

    def _say(self) -> None:
        taken = self._host.taken()
        if taken:
            self._outbox.append(Packet(self._link, 0, taken))
