"""The runner of scripts: waiting, giving up, and nothing left under way after either."""

import pytest

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.sdo_client import Outcome, Transfer
from firmware_bridge.drivers.driver import StartupError
from firmware_bridge.drivers.script_runner import Ask, Do, Script, ScriptRunner, Sent, Until
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import NEVER, Nanoseconds

AXIS = find("rars").axes[0]
READ = Transfer(Address(0x6041))
FIRST, SECOND, THIRD = (Packet("bus", number, b"") for number in (1, 2, 3))
REQUEST = Packet("bus", 0x601, b"")


class Client:
    """A client whose transfer ends by hand."""

    def __init__(self) -> None:
        self.busy = False
        self.wake_at: Nanoseconds = NEVER
        self.cancelled = 0
        self.outcome: Outcome | None = None

    def start(self, transfer: Transfer, now: Nanoseconds) -> Sent:
        del transfer, now
        assert not self.busy
        self.busy = True
        return (REQUEST,)

    def wake(self, now: Nanoseconds) -> Sent:
        del now
        return ()

    def take(self) -> Outcome | None:
        taken, self.outcome = self.outcome, None
        self.busy = self.busy and taken is None
        return taken

    def cancel(self) -> None:
        self.cancelled += 1
        self.busy, self.outcome = False, None


def failing(why: str) -> StartupError:
    return StartupError(AXIS, why)


def raising(why: str) -> Do:
    def act() -> Script:
        raise failing(why)

    return Do(act)


def waits(otherwise: str | None = None) -> Until:
    return Until(lambda: False, 10, None if otherwise is None else lambda: failing(otherwise))


def test_a_condition_that_is_not_met_in_time_ends_the_script_each_time() -> None:
    runner = ScriptRunner(Client())
    for begin, why in ((0, "first"), (100, "second"), (200, "third")):
        assert runner.run((FIRST, waits(why), SECOND), begin) == (FIRST,)
        assert runner.wake_at == begin + 10
        assert runner.go_on(begin + 9) == ()
        assert (runner.busy, runner.failure) == (True, None)
        assert runner.go_on(begin + 10) == ()
        assert (runner.busy, runner.idle, runner.wake_at) == (False, True, NEVER)
        assert why in str(runner.failure)


def test_a_condition_without_an_error_lets_the_script_go_on() -> None:
    runner = ScriptRunner(Client())
    runner.run((waits(), SECOND), 0)
    assert runner.go_on(10) == (SECOND,)
    assert (runner.busy, runner.failure) == (False, None)


def test_a_step_that_fails_ends_the_script_each_time_and_what_it_had_sent_is_sent() -> None:
    client = Client()
    runner = ScriptRunner(client)
    for why in ("first", "second", "third"):
        before = client.cancelled
        script = (FIRST, SECOND, raising(why), THIRD)
        assert runner.run(script, 0) == (FIRST, SECOND)
        assert (runner.busy, runner.wake_at) == (False, NEVER)
        assert why in str(runner.failure)
        # Once for the script that it replaces, once for its own.
        assert client.cancelled == before + 2
        assert runner.go_on(1_000) == ()


def test_an_outcome_is_turned_into_steps_before_the_rest() -> None:
    client = Client()
    runner = ScriptRunner(client)
    assert runner.run((Ask(READ, lambda outcome: (SECOND,) if outcome == b"\x21\x00" else ()), THIRD), 0) == (
        REQUEST,
    )
    assert runner.go_on(1) == ()
    client.outcome = b"\x21\x00"
    assert runner.go_on(2) == (SECOND, THIRD)
    assert not runner.busy


@pytest.mark.parametrize("under_way", [(waits("late"),), (Ask(READ, lambda _: ()),)])
def test_a_new_script_replaces_what_is_under_way(under_way: Script) -> None:
    client = Client()
    runner = ScriptRunner(client)
    runner.run((*under_way, THIRD), 0)
    assert runner.run((FIRST,), 1) == (FIRST,)
    assert (runner.busy, client.busy, runner.wake_at, runner.failure) == (False, False, NEVER, None)
