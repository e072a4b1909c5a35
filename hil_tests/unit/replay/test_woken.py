"""A bridge that is woken when the recorded one was: late, at once, and after its input."""

from emulators.replay.woken import Woken
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds
from hil_tests.rows import every

RECEIVED = Packet("board", 0, b"!")


class Asking:
    """Wants to be woken at an instant, whatever happens."""

    def __init__(self, wake_at: Nanoseconds) -> None:
        self.wake_at = wake_at
        self.woken: list[Nanoseconds] = []

    def receive(self, _packet: Packet, _now: Nanoseconds) -> Reaction:
        return Reaction((RECEIVED,), self.wake_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        self.woken.append(now)
        return Reaction((), self.wake_at)


# Its requested wake is at 100: it spoke at 100, 150 and 400; a machine is up to 50 late.
@every(
    ("requested", "after_wake", "after_word"),
    [
        (99, 150, 99),
        (100, 150, 100),
        (101, 150, 150),
        (150, 150, 150),
        (151, 151, 151),
        (350, 400, 400),
        (349, 349, 349),
        (401, 401, 401),
        (NEVER, NEVER, NEVER),
    ],
)
def test_it_is_woken_at_the_next_instant_at_which_it_spoke(
    requested: Nanoseconds, after_wake: Nanoseconds, after_word: Nanoseconds
) -> None:
    node = Asking(requested)
    woken = Woken(node, (400, 150, 100), (), 50)
    assert woken.wake(100) == Reaction((), after_wake)
    assert woken.receive(RECEIVED, 100) == Reaction((RECEIVED,), after_word)


def test_what_has_come_by_an_instant_is_received_before_anything_that_is_due_then() -> None:
    node = Asking(NEVER)
    woken = Woken(node, (), (7, 7), 50)
    assert woken.wake(7) == Reaction((), 7)
    woken.receive(RECEIVED, 7)
    assert woken.wake(7) == Reaction((), 7)
    woken.receive(RECEIVED, 7)
    assert (woken.wake(7), node.woken) == (Reaction((), NEVER), [7])
