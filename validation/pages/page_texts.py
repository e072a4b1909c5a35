"""Texts of the pages beside their tables."""

from typing import Final

OBJECTS_TEXT: Final = """{objects} objects under {indexes} indexes, as a 70/10 has them; the other types
differ in identity and current limits, and in the rows of `families.epos2.wire.differences`. `receive` and
`transmit` are the PDOs that may carry an object; `kept`: 'save' (0x1010) stores it; an empty bound depends on
the type. Each emulated drive adds its node number to the serial number (0x1018:04, 0x2004, 0x2FFF), so that
no two are equal. The source of each object is in [fidelity](fidelity.md). The same as JSON:
`firmware-bridge epos2 objects --json`."""
FIDELITY_TEXT: Final = """* **Proven**: from maxon's EDS of the 70/10, or recorded from a device.
* **Documented**: from a document on the EPOS2, from maxon's command library, or from the standard that the
  device claims.
* **By analogy**: from a document on a sister device.
* **Assumed**: no source was found; an assumption that may change.

An assumption that can be changed is a field of the device profile. The object table is proven for the 70/10,
and by analogy for the other types."""
EMERGENCIES_TEXT: Final = """An emergency message carries the code (two bytes, low byte first), the error
register 0x1001 and five zeros. Its effect depends on the state of the [power state
machine](power-machine.md):

* Not enabled: {disabled}. The power stage, which may be on in Measure init, goes off at once; the drive goes
  to Fault by transitions 13 and 14.
* Enabled: {enabled}. The drive goes to Fault by transitions 17 and 18, ramp in between.
* In Fault, and during the fault reaction, another emergency is reported and kept in the history; one that
  switches off at once ends a ramp. Fault is left only when no cause is present.
* In the NMT state Stopped: nothing is sent; register and history keep it.

0x605E = -1 only reports a ramped error, 0 switches off, 1 ramps with 0x6084, 2 with 0x6085. After the last
error has gone, a message with code 0 is sent. The last column names tests that reach the emergency in the
emulation."""
MACHINE_TEXT: Final = """CiA 402's machine with maxon's states Refresh and Measure init, the same in all types
({types}). The numbers are those of the firmware specification; the hexadecimal values in the boxes are the
statusword's, without the bits that each mode or the network sets."""
MACHINE_END: Final = """A command is completed, ramp included, before the next one is evaluated. Quick stop
active is left by disable voltage (12), enable operation (16) or a fault (17), and never by itself."""


OPCODES_TEXT: Final = """The same commands go over both lines; V1 is RS232, V2 is USB. Numbers go low byte
first, and a frame carries whole words. An answer has the opcode 0x00 and begins with an error code, 0 or one
of the abort codes of SDO; it has its whole layout also on error, the rest being zeros.

* **V1**: `opcode`, `words - 1`, data, check sum. The host sends the opcode and waits for `O` (0x4F; `F`,
  0x46, for an unknown one), sends the rest and waits again (`F` for a wrong check sum), then answers the 0x00
  of the answer, and its rest, with `O`.
* **V2**: `0x90 0x02`, `opcode`, `words`, data, check sum; each 0x90 behind the first is doubled.
* **Check sum**: CRC-CCITT (0x1021, from 0) over 16-bit words, high byte first; the first word is
  `opcode << 8 | words - 1` in V1, `words << 8 | opcode` in V2. It goes low byte first.
* **Timeout**: an incomplete frame is dropped after 0x2005 (V1) or 0x2006 (V2), by default 500 ms; in V2 the
  next `0x90 0x02` ends it, too.
* **Gateway**: node 0, or the drive's own number, means the drive on the line. Any other is sent on the CAN
  bus; a node that does not answer there gives error 0x05040000. A segment then carries 7 bytes, else up to
  63.

`firmware-bridge epos2 read --serial DEVICE` supports both. The last column names tests that send the command
to the emulated drive, or have it refused there."""

FAULTS_TEXT: Final = """A mission lists faults beside its steps:

```toml
[[fault]]
kind = "frame_loss"
title = "a loose contact at one drive"
at_s = 6.0
for_s = 0.4             # or until_s = 6.4; with neither it stays to the end
node = 3                # the node's number, or the axis' name in quotes
share = 0.3
```

`firmware-bridge bench rars --mission faults` shows most of them. A fault begins at `at_s` and ends at
`until_s`, or after `for_s`; an instantaneous fault has no end. The summary lists the faults that were active,
the plots shade them. Random numbers come from the run's seed, with a stream for each fault. Of two faults
that act on the same component of the same node, one must end before the other begins. From Python:

```python
from emulators.bench.faults import read

rig.faults.plan([read({{"kind": "frame_loss", "at_s": 6.0, "for_s": 0.4, "node": 3}})])
```

{kinds} kinds; `EMCY` codes are explained [here](emergencies.md). The nodes are on the CAN cable in this
order: {cable} (assumed, to be verified)."""

STICK_TEXT: Final = """Effect of positive values of MANUAL_CONTROL's axes, and of its buttons. x,
y and r are neutral at 0. An axis with a dash is not read, whatever its value, which is reported once. z, a
throttle, is neutral at 0 or at 500: it counts from its value when its button was pressed. Before arming, all
axes that are read must be neutral; the refusal names the axis and its value. An axis that is no longer used
(0x7FFF) is neutral at once.

`firmware-bridge pilot` drives from the terminal, too: {keys}.

`--view video` shows the robot by two pictures a second, each 0.5 s old (A. P. Das, PhD thesis, App. A): the
display, and a path follower, see no pose between. `--view predicted` shows those pictures moved to the newest
pose, by (6.2) of the thesis, corrected; what no picture has shown stays dark. The picture is a room with
posts that stands for the robot's own, drawn by a program of its own in a window, or with `--view-to FILE.png`
into a file. It needs the extra `plots`."""
STATIONS_TEXT: Final = """Any MAVLink station can drive: by MANUAL_CONTROL, by RC_CHANNELS_OVERRIDE, or by
SET_POSITION_TARGET_LOCAL_NED. All of them are subject to the same motion permission, operator link timeout,
age limits and interlocks ([interlocks, limits and stops](safety.md), [one station in
control](decisions/station-in-control.md)). A station is answered in its version of MAVLink; MAVLink 1 has no
message numbers above 255 and no signatures."""
DRIVING_TEXT: Final = """Without a mode command the newest motion command counts, whatever its message.
**Guided** is set by `DO_SET_MODE` or `SET_MODE`: a neutral stick does not count while set-points arrive; a
stick that is moved takes over. **Hold** ramps down and waits; Manual or Guided continues, with stick and
set-points neutral. The numbers are those of ArduPilot's Rover; a station that requests PX4's gets PX4's.
[Why](decisions/mavlink-modes.md)."""
RC_TEXT: Final = """1500 us is neutral, 1000 and 2000 are full; 0 releases a channel, 65535 leaves it
unchanged (from channel 9 on: 65534, and 0 or 65535). A channel without a message for the operator link
timeout is released. Below 900 us a receiver has lost its transmitter: that moves nothing, and does not keep
the operator link alive. A robot's station may have other rows (`channels`)."""
MASKS_TEXT: Final = """A velocity, with or without yaw rate, in the body frames 8, 9 and 12: masks 1511, 3559,
1479 (MAVSDK, MAVROS with `mav_frame: BODY_NED`) and 4039 (DroneKit). A robot that can go any way follows
frames 1 and 7, too, by its own heading. A velocity of zero stops in each of these frames, with any heading in
the same message. A place alone, `x` in frame 1 by mask 3576, is for robots of one axis: {of_place}. Other
positions, headings and accelerations are refused by a text, as are SET_ATTITUDE_TARGET,
SET_POSITION_TARGET_GLOBAL_INT and SET_ACTUATOR_CONTROL_TARGET: at once, and then at growing intervals."""
NARROW_TEXT: Final = """`drive --bandwidth 57600`, or `bandwidth_bit_s` under `[operator]` in the robot file,
is the rate of the link, ten bits a byte. Telemetry takes at most half of it: {full:.0f} B/s on a network,
{slow:.0f} B/s at 57,600; on narrower links all but the heartbeat has a longer period. Each station may
request its own intervals (SET_MESSAGE_INTERVAL), a station without control none shorter than these. Arming,
landed state and mode are reported at once when they change."""
PROFILE_TEXT: Final = """`profile = "thesis"` under `[operator.telemetry]` in the robot file sends each
field of the packet of RARS's thesis (A. P. Das, 2018, Fig. 4.3) at its 20 Hz, without a request: pose, the
robot's own values, axis speeds, motor currents, battery. `rars+thesis` is RARS with it: at most {whole:.0f}
B/s to each station, in place of {usual:.0f} B/s. Below {least:.0f} bit/s by `bandwidth_bit_s` the slower
periods count. A station may request the same of any robot: `firmware-bridge pilot --telemetry cycle`. The
station's own packet (Fig. 4.2) is one MANUAL_CONTROL every 50 ms: velocity, steer angle, the platform's z
as a rate, detector and headlamp as buttons."""
LACKING_TEXT: Final = "Not supported, and refused at once by the protocol's own answer: {names}."
STOP_TEXT: Final = """* **QGroundControl** takes the robot for a generic rover. It shows modes by name and
  arms; it cannot set modes of a generic autopilot. While the robot is armed its action *Emergency stop* is on
  the screen: it sends a forced disarm, which brakes first and disables the power stage at standstill. From a
  station without control it is an emergency stop, which brakes and can be cleared. Armed counts as *in the
  air*, as on rovers of PX4, because the action is shown only then. A custom stop button is a file in
  QGroundControl's folder
  `MavlinkActions`, chosen under *Application settings, Fly view*:

```json
{"version": 1, "fileType": "MavlinkActions", "actions": [
  {"label": "Stop", "description": "Brake, and stay until cleared", "mavCmd": 5300, "param1": 0},
  {"label": "Clear", "description": "Clear the stop", "mavCmd": 5300, "param1": 1}]}
```

* **MAVSDK**: `action.arm`, `manual_control`, `offboard.set_velocity_body` and `start`, `action.hold`,
  `action.disarm`, `action.kill` (brakes first). `offboard` continues after a hold, and begins
  after arming, with a set-point of zero: one is enough. `mavsdk_server` repeats the last set-point of a
  script that has died: let a supervisor end it with the script.
* **pymavlink, MAVProxy, DroneKit**: modes `MANUAL`, `GUIDED`, `HOLD`; `rc` overrides.
* **MAVROS**: `setpoint_velocity` with `mav_frame: BODY_NED`, `setpoint_raw`, `manual_control`, and
  `rc/override`."""
COMMANDS_TEXT: Final = (
    "\\* From a station without control: requests and stops; all else is refused by a text."
)
