"""Proof that a drive stops by itself when the bridge falls silent: it does so once, at the start.

No power is on then. On CAN the watch rests on what maxon documents; behind a serial port it rests, for the
gateway, on more than that, and no bridge shall move a robot on an assumption.
"""

from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.driver.feedback import FAULT_STATES, DriveFeedback
from firmware_bridge.canopen_drive.driver.steps import pause, read
from firmware_bridge.canopen_drive.driver.tasks import NEWEST_ERROR
from firmware_bridge.drivers.driver import StartupError
from firmware_bridge.drivers.script_runner import Do, Script, Until
from firmware_bridge.families.epos2.wire.emergency import CONNECTION_LOST
from firmware_bridge.robot import Axis
from firmware_bridge.units import MILLISECOND, Nanoseconds

_CODE = 0xFFFF


class Proof:
    """One drive's proof. While it `listens` no one may show the drive that the bridge lives."""

    def __init__(
        self,
        axis: Axis,
        feedback: DriveFeedback,
        watched: int,
        *,
        speaks_for: Nanoseconds,
        within: Nanoseconds,
    ) -> None:
        """Take the node whose silence the drive shall notice, how long it speaks before, and how soon."""
        self._axis = axis
        self._feedback = feedback
        self._watched = watched
        self._speaks_for = speaks_for
        self._within = within
        self.listens = False
        self.given = False
        """It holds for the life of this bridge: what it hangs on is read back at every set-up."""

    def script(self) -> Script:
        """Return the steps of the proof; none where it has been given."""
        if self.given:
            return ()
        return (
            # A consumer begins to supervise with the first heartbeat that it receives (CiA 301), so these
            # come first.
            pause(self._speaks_for),
            Do(self._begin),
            Until(self._noticed, self._within, self._missing),
            read(self._axis, NEWEST_ERROR, DataType.UNSIGNED32, self._judge),
        )

    def _begin(self) -> Script:
        self.listens = True
        return ()

    def _noticed(self) -> bool:
        return self._feedback.state in FAULT_STATES

    def _missing(self) -> StartupError:
        self.listens = False
        return StartupError(
            self._axis,
            f"it did not notice that node {self._watched} was silent for {self._within // MILLISECOND} ms; "
            f"nothing would stop it if the line broke (expected fault 0x{CONNECTION_LOST:04X})",
        )

    def _judge(self, newest: int) -> Script:
        self.listens = False
        came = newest & _CODE
        # Another fault proves nothing about the supervision.
        if came != CONNECTION_LOST:
            problem = f"fault 0x{came:04X} at the bridge's silence (expected 0x{CONNECTION_LOST:04X})"
            raise StartupError(self._axis, problem)
        self.given = True
        return ()
