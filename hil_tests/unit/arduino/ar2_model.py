"""The grammar and the loops of the arm's sketch once more: by the published figures, in C's manner.

It shares no code with the emulator. Lines are C strings, numbers numpy's int16 and float32.
"""

from dataclasses import dataclass, field

import numpy as np

TURN_US = 70
PINS_OF_DIRECTION = (1, 1, 1, 0, 1, 1, 0)
F = np.float32
SWITCHES = ((21, -1), (21, -1), (7829, 1), (21, -1), (21, -1), (6604, 1))
"""Closing point of each joint's switch, and the direction beyond it."""


def word(value: int) -> int:
    return int(np.array([value & 0xFFFF], dtype=np.uint16).view(np.int16)[0])


def atol(text: str) -> int:
    at, sign, value = 0, 1, 0
    while at < len(text) and text[at] in " \t\n\v\f\r":
        at += 1
    if at < len(text) and text[at] in "+-":
        sign, at = (-1 if text[at] == "-" else 1), at + 1
    while at < len(text) and "0" <= text[at] <= "9":
        value, at = value * 10 + ord(text[at]) - 48, at + 1
    return sign * value


def atof(text: str) -> float:
    text = text.lstrip(" \t\n\v\f\r")
    best = 0.0
    for end in range(1, len(text) + 1):
        begin = text[:end]
        if begin[-1] in " \t\n\v\f\r_" or not begin.isascii() or "inity" in begin.lower():
            break
        try:
            best = float(begin)
        except ValueError:
            continue
    with np.errstate(over="ignore"):
        return float(F(best))


def field_of(line: str, start: int, following: str) -> str:
    """The core's substring(start, indexOf(following)), for a line without zeros."""
    end = line.find(following) if following else len(line)
    if end == -1:
        end = max(len(line), start)
    return line[min(start, end) : max(start, end)]


def to_long(value: float) -> int:
    return int(value) if -(2.0**31) <= value < 2.0**31 else 0


def delayed(us: int) -> int:
    us &= 0xFFFF
    return 0 if us == 0 else ((us * 4) & 0xFFFF) // 4 or 16_384


def divide(one: int, two: int) -> int:
    """C's division of two ints, of which none is negative."""
    return one // two


@dataclass
class Model:
    """Expected output of the sketch; each pulse as axis, direction and us since the line was obeyed."""

    places: list[int]
    pulses: list[tuple[int, int, int]] = field(default_factory=list)
    us: int = 0

    def __post_init__(self) -> None:
        self.levels = dict.fromkeys((*range(2, 14), *range(20, 38), *range(46, 54)), 0)
        self.levels |= dict.fromkeys(range(38, 46), 1)
        self.table = [""] * 101
        self.expected = self.stored = self.last = 0
        self.prefix = ""

    def obey(self, line: str) -> bytes | None:  # noqa: C901, PLR0911 - a case for each command
        """Return the answer; None where the line blocks for ever."""
        self.pulses, self.us = [], 0
        line, self.prefix = self.prefix + line, ""
        if self.expected:
            return self.point(line[:-1])
        match line[:2]:
            case "TM":
                return line[2:].encode("latin-1") + b"\r\n"
            case "SV":
                return b"Servo Done"
            case "WT":
                return b"Done"
            case "MJ":
                self.joint_move(line)
                return b"command recieved"
            case "LL":
                return self.switch_move(line)
            case "ML":
                self.last = word(atol(line[2:]))
                self.expected, self.stored = max(0, self.last), 0
                return self.run_if_all(b"num points recieved")
            case "ON" | "OF":
                self.write(self.pin(line, "X", ""), int(line[1] == "N"))
                return b"Done"
            case "JF":
                return b"T\r" if self.read(self.pin(line, "X", "T")) else b"F\r"
            case "WI" | "WO":
                wanted = int(line[1] == "I")
                return b"Done" if self.read(self.pin(line, "N", "")) == wanted else None
        return b""

    @staticmethod
    def pin(line: str, letter: str, following: str) -> int:
        return word(atol(field_of(line, line.find(letter) + 1, following))) & 0xFF

    def read(self, pin: int) -> int:
        if 14 <= pin <= 19:
            return int(self.closed(pin - 14))
        return 1 if pin < 2 else self.levels.get(pin, 0)

    def write(self, pin: int, level: int) -> None:
        if pin not in self.levels:
            return
        axis = (2, 4, 6, 8, 10, 12, 20).index(pin) if pin in {2, 4, 6, 8, 10, 12, 20} else None
        if axis is not None and level and not self.levels[pin]:
            ahead = 1 if self.levels[pin + 1] == 1 - PINS_OF_DIRECTION[axis] else -1
            self.step(axis, ahead)
        self.levels[pin] = level

    def point(self, text: str) -> bytes | None:
        if self.stored < 101:
            self.table[self.stored] = text[:49]
        stated = str(self.stored).encode()
        self.stored += 1
        self.expected -= 1
        return self.run_if_all(stated)

    def run_if_all(self, stated: bytes) -> bytes | None:
        if self.expected:
            return stated
        for text in self.table[: max(0, self.last + 1)]:
            self.prefix = text
            requested = self.fields(text, "ABCDEFT")
            share = F(atof(field_of(text, text.find("S") + 1, "G"))) / F(100)
            with np.errstate(all="ignore"):
                width = word(to_long(float(F(400) / share)))
            wait = delayed(int(width / 6))
            left = [count for count, _ in requested]
            while any(count > 0 for count in left[:6]):
                for joint in range(6):
                    if left[joint] > 0:
                        left[joint] -= 1
                        self.us += wait
                        self.step(joint, requested[joint][1])
                self.us += TURN_US
            if left[6] > 0:
                return None
        return stated + b"waypts done"

    def fields(self, line: str, letters: str) -> list[tuple[int, int]]:
        found = []
        for at, letter in enumerate(letters):
            place = line.find(letter)
            following = letters[at + 1] if at + 1 < len(letters) else "S"
            digit = word(atol(line[place + 1 : place + 2]))
            count = word(atol(field_of(line, place + 2, following)))
            # The driver goes ahead where its pin is what the digit 1 makes of it.
            pin = 0 if digit == PINS_OF_DIRECTION[at] else 1
            self.levels[3 + 2 * at if at < 6 else 21] = pin
            found.append((count, 1 if pin == (0 if PINS_OF_DIRECTION[at] == 1 else 1) else -1))
        return found

    def joint_move(self, line: str) -> None:
        requested = self.fields(line, "ABCDEFT")
        high = max(count for count, _ in requested)
        active = sum(count > 0 for count, _ in requested)
        if active == 0:
            return
        speed = atof(field_of(line, line.find("S") + 1, "G"))
        g, h, i = (
            F(word(atol(field_of(line, line.find(one) + 1, two))))
            for one, two in (("G", "H"), ("H", "I"), ("I", "K"))
        )
        k = F(word(atol(line[line.find("K") + 1 :])))
        with np.errstate(all="ignore"):
            a = F(speed) / F(100)
            regular = word(to_long(float(F(200) / a)))
            acc = (F(200) + F(200) / (h / F(100))) / a
            dcc = (F(200) + F(200) / (k / F(100))) / a
            acc_step = F(high) * (g / F(100))
            dcc_step = F(high) - F(high) * (i / F(100))
            acc_inc = (F(regular) - acc) / acc_step
            dcc_inc = (F(regular) + dcc) / dcc_step
            dcc = F(regular)
            places = [self.plan(count, high) for count, _ in requested]
            turn = 0
            while any(place["done"] < count for place, (count, _) in zip(places, requested, strict=True)):
                if turn <= acc_step:
                    delay, acc = acc / F(active), acc + acc_inc
                elif turn >= dcc_step:
                    delay, dcc = dcc / F(active), dcc + dcc_inc
                else:
                    delay = F(regular) / F(active)
                turn += 1
                wait = delayed(to_long(float(delay)))
                for axis, (count, ahead) in enumerate(requested):
                    if self.due(places[axis], count):
                        self.us += wait
                        self.step(axis, ahead)
                self.us += TURN_US

    def step(self, axis: int, ahead: int) -> None:
        self.pulses.append((axis, ahead, self.us))
        self.places[axis] += ahead
        self.levels[2 + 2 * axis if axis < 6 else 20] = 1

    @staticmethod
    def plan(count: int, high: int) -> dict[str, int]:
        plan = dict.fromkeys(("PE", "SE1", "SE2", "c", "c1", "c2", "done"), 0)
        if count > 0:
            plan["PE"] = divide(high, count)
            lo1 = high - count * plan["PE"]
            plan["SE1"] = divide(high, lo1) if lo1 > 0 else 0
            lo2 = 0
            if plan["SE1"] > 0:
                lo2 = high - (count * plan["PE"] + divide(count * plan["PE"], plan["SE1"]))
            plan["SE2"] = divide(high, lo2) if lo2 > 0 else 0
        return plan

    @staticmethod
    def due(plan: dict[str, int], count: int) -> bool:
        if plan["done"] >= count:
            return False
        if plan["SE2"] == 0:
            plan["c2"] = 1
        if plan["c2"] == plan["SE2"]:
            plan["c2"] = 0
            return False
        plan["c2"] += 1
        if plan["SE1"] == 0:
            plan["c1"] = 1
        if plan["c1"] == plan["SE1"]:
            plan["c1"] = 0
            return False
        plan["c1"] += 1
        plan["c"] += 1
        if plan["c"] == plan["PE"]:
            plan["c"] = 0
            plan["done"] += 1
            return True
        return False

    def closed(self, joint: int) -> bool:
        at, beyond = SWITCHES[joint]
        return (self.places[joint] - at) * beyond >= 0

    def switch_move(self, line: str) -> bytes:
        requested = self.fields(line, "ABCDEF")
        with np.errstate(all="ignore"):
            share = F(atof(line[line.find("S") + 1 :])) / F(100)
            wait = delayed(word(to_long(float(F(400) / share))))
        left = [count for count, _ in requested]
        while due := [joint for joint in range(6) if left[joint] > 0 and not self.closed(joint)]:
            for joint in range(6):
                self.us += 5
                if joint in due:
                    left[joint] -= 1
                    self.step(joint, requested[joint][1])
                self.us += 5
            self.us += wait + TURN_US
        for _ in range(21):
            self.us += wait
            for joint, (count, ahead) in enumerate(requested):
                if count > 0:
                    self.step(joint, ahead)
            self.us += wait + TURN_US
        return b"P\r" if all(self.closed(it) for it in range(6) if requested[it][0] > 0) else b"F\r"
