"""One servo axis as a flat record of whole numbers: what a regulator needs to know between two ticks.

Not known here: objects, states and the bus. Every value fits 64 bits, so that the kernel in C works on the
same record and gives the same results.
"""

import ctypes
from typing import ClassVar, Final

from emulators.servo.record import FIELDS, ServoRecord
from emulators.servo.recorder import Recorder
from firmware_bridge.units import MICROSECOND, Nanoseconds

TICK: Final[Nanoseconds] = 100 * MICROSECOND
"""Sampling of the current loop, 10 kHz (EPOS2 Application Notes, p. 120)."""
TICKS_PER_MILLISECOND: Final = 10
"""The velocity and position loops and the profile run at 1 kHz (EPOS2 Application Notes, p. 121, 136)."""

OFF: Final = -1
"""A supervision that is switched off (0xFFFFFFFF in the objects)."""

# What drives the current demand.
IDLE: Final = 0
CURRENT: Final = 1
VELOCITY: Final = 2
POSITION: Final = 3

# What drives the demands of the velocity and position regulators.
DIRECT: Final = 0
RAMP: Final = 1
MOVE: Final = 2
SPLINE: Final = 3
ELECTRONIC_GEAR: Final = 4

# What a ramp and a move are shaped like (0x6086).
TRAPEZOID: Final = 0
SINE: Final = 1

# Flags that an axis reports; a change of one of these is an event.
PROFILE_DONE: Final = 1 << 0
TARGET_REACHED: Final = 1 << 1
AT_REST: Final = 1 << 2
CURRENT_LIMITED: Final = 1 << 3
FOLLOWING_ERROR: Final = 1 << 4
OVER_CURRENT: Final = 1 << 5
UNDER_VOLTAGE: Final = 1 << 6
OVER_VOLTAGE: Final = 1 << 7
CURRENT_REACHED: Final = 1 << 8
POSITION_LIMIT_PASSED: Final = 1 << 16
OVER_TEMPERATURE: Final = 1 << 17
LOGIC_SUPPLY_LOW: Final = 1 << 18
GATE_SUPPLY_LOW: Final = 1 << 19
ENCODER_BROKEN: Final = 1 << 20
INDEX_LOST: Final = 1 << 21
INDEX_DISTANCE_WRONG: Final = 1 << 22
HALL_IMPOSSIBLE: Final = 1 << 23
HALL_ANGLE_APART: Final = 1 << 24
ENCODER_AGAINST_MOTOR: Final = 1 << 25
AUXILIARY_AGAINST_MAIN: Final = 1 << 26

SWAPPED: Final = 1 << 1
"""In an axis's `sensor_faults`: the encoder's channels A and B are exchanged."""
JUST_OPENED: Final = 2
"""Value of `turning` until an open winding has got its voltage for a tick."""
LEAST_LEARNING: Final = 838_861
"""0.05 Ohm in 24 places: a lower bound of the windings' resistance, so that learning begins from below."""
LEFT_MA: Final = 2
"""Rest of a current that brakes when that constant has been learnt: less is not seen."""
AVERAGE_PLACES: Final = 16
"""Binary places of the averaged current, which is in mA."""
LOGIC_MV: Final = 5_000
"""The drive's own supply, when nothing is wrong with it."""
GATE_MV: Final = 12_000
"""The supply of the power stage's gate drivers, likewise."""
AMBIENT_MC: Final = 25_000
"""The air at the drive's heat sink."""
STAGE_RISE_MC: Final = 50_000
LARGEST_SPEED: Final = 1 << 29
"""25 000 rpm, the fastest that any object allows, lies below this many velocity units."""
FASTEST_RPM: Final = 25_000
FOREVER: Final = 1 << 62
LONGEST_REST_MS: Final = 0xFFFF


class ServoAxis(ServoRecord, ctypes.Structure):
    """The state of one axis. Positions and velocities of the demand carry `fraction` binary places.

    Velocity unit: 2^-fraction qc per ms. Acceleration unit: velocity unit per ms. Currents in mA, voltages
    in mV. Gains are multipliers in binary fixed point: see `emulators.servo.scaling`.

    The fields lie in memory as the kernel in C expects them: Python and the kernel share this one record.
    """

    _fields_: ClassVar = [(field, ctypes.c_int64) for field in FIELDS]

    def __init__(
        self,
        name: str,
        encoder_resolution: int,
        node: str = "",
        *,
        supply_mv: int = 24_000,
    ) -> None:
        """Take the mounted encoder in qc per turn, and the node to wake (the name where it is empty).

        Of its motor it knows nothing before `emulators.servo.winding.set_winding`.
        """
        super().__init__()
        self.name: Final = name
        self.node: Final = node or name
        self.recorder: Final = Recorder()
        self.encoder_resolution = encoder_resolution
        self.supply_mv = supply_mv
        self._own_supply_mv: Final = supply_mv
        self.source_mv = 0
        self.analogue_1_mv = 0
        self.analogue_2_mv = 0
        self.master = 0
        self.back_emf = self.decay_resistance = self.balance_resistance = 0
        self.raised = self.braking = self.waits = self.speed_before = 0
        self.left = LEFT_MA
        self.learning = LEAST_LEARNING
        # assumed: 90 % of the supply reaches the winding; the rest is the bridge and its dead time.
        self.voltage_percent = 90
        # assumed: the hardware cuts off above 1.5 times the 70/10's largest output current of 25 A.
        self.over_current_ma = 37_500
        # assumed: supply range 11 V to 70 V, from the type's name and its sisters.
        self.under_voltage_mv = 10_000
        self.over_voltage_mv = 75_000
        self._undisturbed()
        self._unscaled()
        self.encoder = 0
        self.pins = self.outputs = 0
        self.now: Nanoseconds = 0
        self.restart()

    def force_supply(self, millivolts: int) -> None:
        """Put another voltage on the drive's supply; 0 gives it back."""
        self.forced_supply_mv = millivolts
        if not self.source_mv:
            # No plant has this supply: no one else writes it.
            self.supply_mv = millivolts or self._own_supply_mv

    def _undisturbed(self) -> None:
        """Begin in surroundings in which nothing is wrong."""
        self.forced_supply_mv = 0
        self.logic_mv = LOGIC_MV
        self.gate_mv = GATE_MV
        self.ambient_mc = AMBIENT_MC
        # assumed: the continuous current, 10 A for the 70/10, heats the power stage by 50 K.
        self.square_per_mc = 10_000**2 // STAGE_RISE_MC
        self.sensor_faults = self.encoder_loss = self.mounted_pole_pairs = 0
        self.slipped = self.loss_rest = 0

    def _unscaled(self) -> None:
        self.resolution = self.encoder_resolution
        self.fraction = 0
        self.current_p = self.current_i = 0
        self.velocity_p = self.velocity_i = 0
        self.velocity_speed_forward = self.velocity_acceleration_forward = 0
        self.position_p = self.position_i = self.position_d = self.position_filter = 0
        self.position_speed_forward = self.position_acceleration_forward = 0
        self.continuous_ma = self.peak_ma = 0
        self.thermal_full = FOREVER
        self.speed_limit = 0
        self.following_limit_qc = OFF
        self.position_window_qc = self.velocity_window = OFF
        self.position_window_ms = self.velocity_window_ms = 0
        self.rest_window = self.rest_ms = 0
        self.lowest_qc, self.highest_qc = -(1 << 31), (1 << 31) - 1
        self.position_limited = self.encoder_reversed = 0
        self.encoder_supervised = self.index_supervised = 0
        self.hall_pole_pairs = self.hall_angle_supervised = self.auxiliary_supervised = 0

    def restart(self) -> None:
        """Begin as after power-on: power off, position 0 at the present angle (assumed: counter cleared)."""
        self.powered = 0
        self.profile = DIRECT
        self.regulator = IDLE
        self.current_setting_ma = 0
        self.target_velocity = self.target_position = 0
        self.cruise = self.acceleration = self.deceleration = 1
        self.stopping_distance = 0
        self._unplanned()
        self.call = self.event = self.recording = 0
        self.pins_watched = self.index_watched = self.current_watched_ma = 0
        self.pins_before = self.pins
        self.index_position = self.index_passes = 0
        self.compare_direction = self.compare_reference = self.compare_width = 0
        self.compare_first = self.compare_last = self.compare_pulse_ms = 0
        self.compare_left = self.compare_hits = 0
        self.turning = JUST_OPENED
        self.flags = AT_REST
        self.position = 0
        self.step = self.velocity_average = 0
        self.current_ma = self.current_average = 0
        self.current_demand_ma = self.current_limit_ma = 0
        self.current_integral = self.voltage_mv = 0
        self.thermal = self.window_ms = 0
        self.turned = self.contrary_ms = self.hall_zero = 0
        self.index_count = self.index_before = self.encoder + self.slipped
        self.index_known = self.index_judged = 0
        self.switched_on_at = self.encoder
        self.still_ms = LONGEST_REST_MS
        self.clear_demand()

    def _unplanned(self) -> None:
        self.shape = TRAPEZOID
        self.leg_from = self.leg_to = self.leg_ms = self.leg_at = self.leg_spare = 0
        self.leg_2_to = self.leg_2_ms = self.leg_3_to = self.leg_3_ms = self.leg_4_to = self.leg_4_ms = 0
        self.knot = self.spline_ms = self.spline_at = 0
        self.spline_linear = self.spline_square = self.spline_cube = 0
        self.next_linear = self.next_square = self.next_cube = self.next_ms = 0
        self.splines_done = 0
        self.lowest, self.highest = -FOREVER, FOREVER
        self.gear_counted, self.gear_rest = self.master, 0
        self.gear_numerator = self.gear_denominator = 1
        self.analogue_input = self.analogue_numerator = self.analogue_offset = 0
        self.analogue_denominator = 1

    def swap_channels(self, *, swapped: bool) -> None:
        """Exchange the channels of its encoder, or put them back."""
        # One bit of several: a missing index at the same time stays.
        others = self.sensor_faults & ~SWAPPED
        self.sensor_faults = others | SWAPPED if swapped else others

    def clear_demand(self) -> None:
        """Let the demands follow the shaft, with empty integrators: where a regulator starts from."""
        self.position_demand = self.position << self.fraction
        self.velocity_demand = self.shaft_speed()
        self.acceleration_demand = 0
        self.velocity_integral = self.position_integral = self.derivative = 0

    def shaft_speed(self) -> int:
        """Return the averaged speed; rounding leaves that of a resting shaft a little below 0."""
        return 0 if self.flags & AT_REST else self.velocity_average

    def switch_on(self) -> None:
        """Close the power stage with no current demanded; the regulator starts at the winding's voltage."""
        self.powered = 1
        self.regulator = IDLE
        self.profile = DIRECT
        self.current_demand_ma = 0
        # The integrator takes over the open winding's voltage: no step in the current when the stage closes.
        self.current_integral = self.voltage_mv << 8
        self.switched_on_at = self.encoder
        self.clear_demand()

    def switch_off(self) -> None:
        """Open the winding."""
        self.powered = 0
        self.turning = JUST_OPENED
        self.learning = min(self.learning, LEAST_LEARNING)
        self.braking = self.waits = 0
        self.left = LEFT_MA
        self.regulator = IDLE
        self.profile = DIRECT
        self.current_demand_ma = 0
        self.current_integral = 0
        self.flags &= ~(PROFILE_DONE | TARGET_REACHED | FOLLOWING_ERROR)
        self.clear_demand()
