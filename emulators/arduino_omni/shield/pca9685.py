"""The PWM chip PCA9685, to the register: 16 channels of 12 bits behind an I2C address.

Source: NXP, PCA9685 product data sheet: addresses, registers, sleep and restart, software reset.
Where it is silent:
* a RESTART requested earlier than 500 us after SLEEP ended, or with SLEEP, is not obeyed and stays pending.
* while asleep, or held until RESTART, all outputs are low.
* no clock comes in at the EXTCLK pin of the shield, so after EXTCLK outputs are as in sleep.
* the reserved registers 0x46 to 0xF9 read 0, take nothing, and the pointer goes on through them.
* what was written and not followed by a STOP is taken with the next STOP on the bus.
"""

from dataclasses import dataclass
from typing import Final

from emulators.arduino_omni.shield.i2c import GENERAL_CALL
from firmware_bridge.units import MICROSECOND, NEVER, SECOND, Nanoseconds

CHANNELS: Final = 16
PERIOD_COUNTS: Final = 4_096
OSCILLATOR_HZ: Final = 25_000_000
STARTS_IN: Final[Nanoseconds] = 500 * MICROSECOND
"""Time from the end of SLEEP until the oscillator runs."""

MODE1: Final = 0x00
MODE2: Final = 0x01
SUBADR1: Final = 0x02
ALLCALLADR: Final = 0x05
LED0: Final = 0x06
LED_END: Final = 0x46
ALL_LED: Final = 0xFA
PRE_SCALE: Final = 0xFE
TEST_MODE: Final = 0xFF

RESTART: Final = 0x80
EXTCLK: Final = 0x40
AI: Final = 0x20
SLEEP: Final = 0x10
SUB1: Final = 0x08
ALLCALL: Final = 0x01

INVRT: Final = 0x10
OCH: Final = 0x08
OUTDRV: Final = 0x04
MODE2_BITS: Final = 0x1F

LAST: Final = frozenset({LED_END - 1, PRE_SCALE, TEST_MODE})
"""Registers after which the pointer begins again."""
FULL: Final = 0x10
"""Bit of ON_H: always on; and of OFF_H: always off, which wins."""
HIGH_BITS: Final = 0x1F
LOWEST_PRE_SCALE: Final = 3
SOFTWARE_RESET: Final = 0x06

POWER_ON: Final = {
    MODE1: SLEEP | ALLCALL,
    MODE2: OUTDRV,
    2: 0xE2,
    3: 0xE4,
    4: 0xE8,
    ALLCALLADR: 0xE0,
    PRE_SCALE: 0x1E,
}


@dataclass(frozen=True, slots=True)
class Wave:
    """One output over the PWM period: high from count `rises` on for `high` of 4096 counts, round the end."""

    rises: int
    high: int


LOW: Final = Wave(0, 0)
HIGH: Final = Wave(0, PERIOD_COUNTS)


def wave(on: int, off: int) -> Wave:
    """Return what a channel does by its two 13-bit registers."""
    if off & PERIOD_COUNTS:
        return LOW
    if on & PERIOD_COUNTS:
        return HIGH
    return Wave(on, (off - on) % PERIOD_COUNTS)


def driven(registers: bytes, mode2: int, *, runs: bool) -> Wave:
    """Return what a channel's pin does by its four registers and MODE2; `runs`: the oscillator does."""
    if not mode2 & OUTDRV:  # open drain: it can pull down, and so does the gate
        return LOW
    on_low, on_high, off_low, off_high = registers
    made = wave(on_low | on_high << 8, off_low | off_high << 8) if runs else LOW
    if mode2 & INVRT:
        return Wave((made.rises + made.high) % PERIOD_COUNTS, PERIOD_COUNTS - made.high)
    return made


class Pca9685:
    """One chip at its 7-bit address. It knows no motor."""

    def __init__(self, address: int) -> None:
        self.address: Final = address
        self._registers = bytearray(256)
        self._latched = bytearray(LED_END)
        """Registers that the outputs follow: MODE2 and the channels as of the last STOP, or byte (OCH)."""
        self._pointer = 0
        self._selecting = False
        self._general = False
        self._calls = 0
        self._held = False
        self._reset_due = False
        self._channel_written = False
        self._awake_at: Nanoseconds = NEVER
        self.changes = 0
        """Times that what the outputs go by may have changed."""
        self.power_on()

    def power_on(self) -> None:
        """Reset it to its power-on state."""
        self._registers[:] = bytes(256)
        for register, value in POWER_ON.items():
            self._registers[register] = value
        for channel in range(CHANNELS):
            # Power-on value of each LEDn_OFF_H, 0x10: fully off.
            self._registers[LED0 + 4 * channel + 3] = FULL
        self._held = self._channel_written = self._reset_due = False
        self._awake_at = NEVER
        self._latched[:] = self._registers[:LED_END]
        self.changes += 1

    # What others see

    @property
    def hasty(self) -> bool:
        """True if outputs change with each acknowledge."""
        return bool(self._registers[MODE2] & OCH)

    @property
    def pre_scale(self) -> int:
        """The divisor less one."""
        return self._registers[PRE_SCALE]

    @property
    def period(self) -> Nanoseconds:
        """One PWM period."""
        return PERIOD_COUNTS * (self.pre_scale + 1) * SECOND // OSCILLATOR_HZ

    def register(self, number: int) -> int:
        """Return what a read of this register gives."""
        if number == MODE1:
            return self._registers[MODE1] | (RESTART if self._held else 0)
        return 0 if ALL_LED <= number < PRE_SCALE else self._registers[number]

    def next_change(self, now: Nanoseconds) -> Nanoseconds:
        """Return when the outputs change without a word from the bus: the oscillator starts."""
        due = self._awake_at + STARTS_IN if self._awake_at != NEVER else NEVER
        return due if due > now else NEVER

    def runs(self, now: Nanoseconds) -> bool:
        """Return whether the channels follow their registers: the oscillator runs, and no RESTART is due."""
        return not self._held and self._awake_at != NEVER and now >= self._awake_at + STARTS_IN

    def latched(self, channel: int) -> bytes:
        """Return the four registers by which a channel goes."""
        at = LED0 + 4 * channel
        return bytes(self._latched[at : at + 4])

    @property
    def latched_mode2(self) -> int:
        """Drive mode of the pins."""
        return self._latched[MODE2]

    def output(self, channel: int, now: Nanoseconds) -> Wave:
        """Return what the pin of a channel does, from 0 on, as a gate that pulls down at rest sees it."""
        return driven(self.latched(channel), self.latched_mode2, runs=self.runs(now))

        # The bus

    def acknowledges(self, address: int, *, reading: bool) -> bool:
        """Return whether the chip answers: to its own address; to write, to a group and the general call."""
        return address == self.address or (
            not reading and (address == GENERAL_CALL or address in self._groups())
        )

    def _groups(self) -> set[int]:
        mode1 = self._registers[MODE1]
        # The registers hold addresses of 8 bits, of which the lowest is not used.
        own = {self._registers[ALLCALLADR] >> 1} if mode1 & ALLCALL else set[int]()
        return own | {self._registers[SUBADR1 + n] >> 1 for n in range(3) if mode1 & SUB1 >> n}

    def addressed(self, address: int, *, reading: bool, at: Nanoseconds) -> None:
        """Take a START and an address."""
        del at
        self._general = address == GENERAL_CALL and address != self.address
        self._selecting = not reading
        self._calls = 0
        self._reset_due = False

    def written(self, byte: int, at: Nanoseconds) -> bool:
        """Take a byte: the register's number, or what goes into it."""
        if self._general:
            self._calls += 1
            # SWRST is one byte 06 to the general call; any further one cancels it, and it counts at the STOP.
            self._reset_due = self._calls == 1 and byte == SOFTWARE_RESET
            return self._reset_due
        if self._selecting:
            self._selecting = False
            self._pointer = byte
            return True
        number, registers = self._pointer, self._registers
        if LED0 <= number < LED_END:
            self._set_channel(number, byte)
        else:
            self._store(number, byte, at)
        self._next()
        if registers[MODE2] & OCH:
            self._take()
        return True

    def read(self, at: Nanoseconds) -> int:
        """Give the register that the pointer is at."""
        del at
        value = self.register(self._pointer)
        self._next()
        return value

    def stopped(self, at: Nanoseconds) -> None:
        """Take a STOP: outputs change now."""
        del at
        if self._reset_due:
            self.power_on()
        self._take()

    def _take(self) -> None:
        taken = self._registers[:LED_END]
        if self._latched != taken:
            self.changes += 1
            self._latched[:] = taken
        if self._channel_written:
            # Data sheet: a write to a channel, with its STOP, clears RESTART as well.
            self._channel_written = False
            if self._held:
                self.changes += 1
                self._held = False

    def _next(self) -> None:
        if self._registers[MODE1] & AI:
            self._pointer = 0 if self._pointer in LAST else self._pointer + 1

    def _store(self, number: int, byte: int, at: Nanoseconds) -> None:
        """Take a byte for what is no channel's register."""
        if number == MODE1:
            self._set_mode1(byte, at)
        elif number == MODE2:
            self._registers[MODE2] = byte & MODE2_BITS
        elif SUBADR1 <= number <= ALLCALLADR:
            self._registers[number] = byte & 0xFE
        elif ALL_LED <= number < PRE_SCALE:
            # ALL_LED writes through to all 16 channels, and itself reads 0.
            for channel in range(CHANNELS):
                self._set_channel(LED0 + 4 * channel + number - ALL_LED, byte)
        elif number == PRE_SCALE and self._registers[MODE1] & SLEEP:
            # A value below 3 behaves as 3 (data sheet).
            self._registers[PRE_SCALE] = max(byte, LOWEST_PRE_SCALE)

    def _set_channel(self, number: int, byte: int) -> None:
        is_high = (number - LED0) & 1
        self._registers[number] = byte & HIGH_BITS if is_high else byte
        self._channel_written = True

    def _set_mode1(self, byte: int, at: Nanoseconds) -> None:
        self.changes += 1
        before = self._registers[MODE1]
        # EXTCLK is taken with SLEEP set before and now, and is cleared by a reset only.
        sticky = before & EXTCLK or (byte & EXTCLK if before & SLEEP and byte & SLEEP else 0)
        self._registers[MODE1] = byte & ~(RESTART | EXTCLK) | sticky
        if byte & SLEEP:
            if not before & SLEEP:
                # RESTART reads 1 only if SLEEP has stopped a channel that ran.
                self._held = self._held or self._pwm_runs()
            self._awake_at = NEVER
            return
        if before & SLEEP:
            self._awake_at = NEVER if sticky else at
        elif byte & RESTART and self._awake_at != NEVER and at >= self._awake_at + STARTS_IN:
            # RESTART resumes the channels, 500 us after SLEEP at the earliest, and clears itself.
            self._held = False

    def _pwm_runs(self) -> bool:
        return any(not self._registers[LED0 + 4 * channel + 3] & FULL for channel in range(CHANNELS))
