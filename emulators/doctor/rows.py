"""Checks of the machine, and their findings: a row for each, a pure function of the facts.

A remedy is one line. It does not access the machine itself.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from statistics import median
from typing import Final

from emulators.doctor.facts import CanInterface, Facts
from firmware_bridge.runtime.runner import LATE
from firmware_bridge.units import MICROSECOND, MILLISECOND, Nanoseconds


class CheckResult(Enum):
    """Result of a check."""

    OK = "ok"
    CAREFUL = "careful"
    MISSING = "missing"


@dataclass(frozen=True, slots=True)
class Finding:
    """Result and remedy of a check; no remedy where there is nothing to fix."""

    verdict: CheckResult
    found: str
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Check:
    """A check. `needed` marks one without which the program, or its bench, does not work."""

    title: str
    judge: Callable[[Facts], Finding]
    needed: bool = False


OLDEST: Final = (3, 11)
NEWEST: Final = (3, 14)
"""Pythons. Assumed: a later one works, too; no one has tried."""
CYCLE: Final[Nanoseconds] = 50 * MILLISECOND
"""Cycle of the bridge on most robots that come with it; a robot file has its own, `cycle_ms`."""
COARSE: Final[Nanoseconds] = MILLISECOND
"""Limit of a clock's resolution: with longer steps it cannot distinguish one frame from the next."""
CROWDED: Final = 2.0
"""Processes for each processor. Assumed: with twice as many as there are processors a cycle waits its turn
often; with more than one each, now and then."""
PURPOSES: Final = {
    "mcap": "recordings in MCAP",
    "plants": "for plants of your own",
    "plots": "pictures of runs",
    "testing": "the plugin of pytest",
}
"""Purposes of the extras."""
SKETCH: Final = "flash this project's sketch (protocol ros-arduino-bridge), which stops them after 2 s"
_LINUX: Final = "Linux"
_HEALTHY: Final = frozenset({None, "ERROR-ACTIVE"})
_BUS_OFF: Final = "BUS-OFF"


def _ok(found: str) -> Finding:
    return Finding(CheckResult.OK, found)


def _careful(found: str, remedy: str) -> Finding:
    return Finding(CheckResult.CAREFUL, found, remedy)


def _missing(found: str, remedy: str) -> Finding:
    return Finding(CheckResult.MISSING, found, remedy)


def python(facts: Facts) -> Finding:
    """Judge the interpreter."""
    found = ".".join(map(str, facts.python))
    if facts.python[:2] < OLDEST:
        return _missing(found, "install Python 3.11 or later, and this program with it")
    if facts.python[:2] > NEWEST:
        return _careful(found, "later than any that was tried; Python 3.11 to 3.14 are known to do")
    return _ok(found)


def socketcan(facts: Facts) -> Finding:
    """Judge the kernel's way to CAN adapters."""
    found = f"{facts.system} {facts.release}"
    if facts.socketcan:
        return _ok(f"{found}, with SocketCAN")
    if facts.system != _LINUX:
        return _careful(
            f"{found}, which has no SocketCAN", "name an adapter that python-can knows: -i pcan, -i slcan ..."
        )
    return _missing(
        f"{found}, without SocketCAN", "`sudo modprobe can-raw`; or -i loopback_multicast without a bus"
    )


def vcan(facts: Facts) -> Finding:
    """Judge the way to a bus without an adapter."""
    names = [one.name for one in facts.interfaces if one.virtual and one.up]
    if names:
        return _ok(f"{', '.join(names)} up")
    if facts.vcan:
        return _careful(
            "the kernel has it, and no interface is up",
            "`sudo modprobe vcan && sudo ip link add dev vcan0 type vcan && sudo ip link set vcan0 up`",
        )
    return _missing("the kernel has no vcan", "take -i loopback_multicast; or run tools/with-vcan")


def adapters(facts: Facts) -> Finding:
    """Judge the CAN interfaces of the kernel that have a wire."""
    real = [one for one in facts.interfaces if not one.virtual]
    if not real:
        return _missing("none", "plug an adapter in; one that is a serial port needs no interface: -i slcan")
    found = "; ".join(map(_text_of, real))
    for one in real:
        # Before "down": an interface in bus off is up, and sends nothing until it is restarted.
        if one.state == _BUS_OFF:
            again = f"`sudo ip link set {one.name} down && sudo ip link set {one.name} up`"
            return _careful(found, f"check bit rate, wiring and termination, then {again}")
        if not one.up:
            return _careful(found, f"`sudo ip link set {one.name} up type can bitrate 1000000`")
        if one.state not in _HEALTHY:
            return _careful(
                found, f"{one.name} sees errors: check bit rate, wiring, termination at both ends"
            )
    return _ok(found)


def _text_of(one: CanInterface) -> str:
    rate = "" if one.bit_rate is None else f", {one.bit_rate // 1000} kbit/s"
    return f"{one.name} {'up' if one.up else 'down'}{rate}{'' if one.state is None else f', {one.state}'}"


def ports(facts: Facts) -> Finding:
    """Judge the serial ports, and the user's leave to open them."""
    if not facts.ports:
        return _missing("none", "plug the converter or the board in; `ls /dev/tty*` shows what is there")
    found = "; ".join(f"{one.device} ({one.title})" for one in facts.ports)
    barred = [one for one in facts.ports if not one.allowed]
    if barred:
        names, group = ", ".join(one.device for one in barred), barred[0].group or "dialout"
        return _careful(
            f"{found}; {facts.user} may not open {names}",
            f"`sudo usermod -aG {group} {facts.user}`, then log in again",
        )
    return _ok(found)


def watchdogs(facts: Facts) -> Finding:
    """Judge what stops the devices of installed robots when the bridge ends."""
    if not facts.unwatched:
        return _ok("the devices of every installed robot stop by themselves when the bridge falls silent")
    accepted = sorted(place for place, accepts in facts.unwatched.items() if accepts)
    if accepted:
        found = f"motors run on when the bridge ends, and the robot file accepts it: {', '.join(accepted)}"
        return _missing(found, f"keep the switch of their supply within reach, or {SKETCH}")
    return _careful(f"motors run on when the bridge ends: {', '.join(sorted(facts.unwatched))}", SKETCH)


def clock(facts: Facts) -> Finding:
    """Judge how fine the clock is, and how late this machine wakes who sleeps."""
    worst = max(facts.late, default=0)
    usual = median(facts.late) if facts.late else 0
    found = (
        f"steps of {facts.resolution} ns; of {len(facts.late)} sleeps of 10 ms the median woke "
        f"{usual / MICROSECOND:.0f} us late, the worst {worst / MILLISECOND:.2f} ms"
    )
    # A whole cycle late: the bridge leaves set-points out.
    if worst >= CYCLE or facts.resolution >= CYCLE:
        return _missing(
            f"{found}: whole cycles of 50 ms are lost",
            "end what else runs, or give the bridge priority: `sudo chrt -f 50 firmware-bridge ...`",
        )
    if worst >= LATE or facts.resolution > COARSE:
        return _careful(
            f"{found}: a cycle of 50 ms may be late by so much, none is lost",
            "for a real robot end what else runs; the bench in virtual time does not mind",
        )
    return _ok(f"{found}: cycles of 50 ms are kept")


def load(facts: Facts) -> Finding:
    """Judge how busy the machine is."""
    if facts.load is None:
        return _careful(
            f"{facts.processors} processors; this system reports no load", "look at it by yourself"
        )
    found = f"{facts.load:.1f} processes want to run, on {facts.processors} processors"
    if facts.load > CROWDED * facts.processors:
        return _missing(f"{found}: none is free", "end what else runs before a real robot is driven")
    if facts.load > facts.processors:
        return _careful(found, "for a real robot end what else runs")
    return _ok(found)


def compiler(facts: Facts) -> Finding:
    """Judge what plants, servo kernel and core are translated with."""
    if facts.compiler is None:
        remedy = "install one, or correct $CC; on Debian or Ubuntu: apt-get install gcc libc6-dev"
        if facts.plants and all(facts.plants.values()):
            return _careful("none; the plants are built already", f"for a plant of your own {remedy}")
        return _missing("none", remedy)
    if not facts.headers:
        return _careful(
            f"{facts.compiler}, without Python's headers",
            "only `make compiled` needs them; on Debian or Ubuntu: apt-get install python3-dev",
        )
    return _ok(facts.compiler)


def kernel(facts: Facts) -> Finding:
    """Judge the drives' loops in C."""
    if not facts.kernel_problem:
        return _ok("loaded")
    found = f"{facts.kernel_problem.partition(' (')[0]}; the loops run in Python, slower"
    if facts.kernel_built:
        return _careful(
            found,
            "install this package again, and leave FIRMWARE_BRIDGE_SERVO unset",
        )
    return _missing(
        found,
        "with a C compiler there, install this package again",
    )


def core(facts: Facts) -> Finding:
    """Judge whether what every packet passes through is translated to C."""
    plain = sorted(name for name, done in facts.compiled.items() if not done)
    if not plain:
        return _ok("translated to C")
    if len(plain) < len(facts.compiled):
        return _careful(f"in Python, beside others in C: {', '.join(plain)}", "install it again, whole")
    return _missing("in Python, which is slower; the bytes are the same", "`make compiled`, in a checkout")


def plants(facts: Facts) -> Finding:
    """Judge whether a first run has to wait for plants."""
    wanting = sorted(name for name, built in facts.plants.items() if not built)
    if None in facts.plants.values():
        return _missing("without a compiler it is unknown", "install a C compiler")
    if not wanting:
        return _ok(f"{', '.join(sorted(facts.plants)) or 'none is installed'}: built")
    remedy = "they are built when they are wanted, 10 s each; `firmware-bridge fmu build NAME` does it now"
    if facts.extras.get("plants"):
        remedy = "`pip install 'firmware-bridge[plants]'`: they are built from equations"
    if len(wanting) < len(facts.plants):
        return _careful(f"not built yet: {', '.join(wanting)}", remedy)
    return _missing("none is built yet", remedy)


def libraries(facts: Facts) -> Finding:
    """Judge the libraries that every installation needs."""
    found = ", ".join(
        f"{one.name} {'-' if one.installed is None else '.'.join(map(str, one.installed))}"
        for one in facts.libraries
    )
    again = "`pip install --upgrade firmware-bridge`, or `make setup` in a checkout"
    missing = [one.name for one in facts.libraries if one.installed is None]
    if missing:
        return _missing(f"not installed: {', '.join(missing)}", again)
    old = [one.name for one in facts.libraries if one.installed is not None and one.installed < one.least]
    if old:
        return _careful(f"{found}; too old: {', '.join(old)}", again)
    return _ok(found)


def extras(facts: Facts) -> Finding:
    """Judge the optional extras, which only some users need."""
    wanting = {name: lacking for name, lacking in facts.extras.items() if lacking}
    if not wanting:
        return _ok(f"complete: {', '.join(facts.extras)}" if facts.extras else "there are none")
    found = "; ".join(_extra(name, lacking) for name, lacking in wanting.items())
    remedy = f"where you want it: `pip install 'firmware-bridge[{','.join(wanting)}]'`"
    if len(wanting) < len(facts.extras):
        return _careful(f"without {found}", remedy)
    return _missing(f"without {found}", remedy)


def _extra(name: str, lacking: tuple[str, ...]) -> str:
    purpose = PURPOSES.get(name)
    return f"{name}{f', {purpose}' if purpose else ''} ({', '.join(lacking)})"


ROWS: Final = (
    Check("Python", python, needed=True),
    Check("libraries", libraries, needed=True),
    Check("extras", extras),
    Check("C compiler", compiler, needed=True),
    Check("plants", plants),
    Check("servo kernel", kernel),
    Check("compiled core", core),
    Check("SocketCAN", socketcan),
    Check("virtual CAN", vcan),
    Check("CAN interfaces", adapters),
    Check("serial ports", ports),
    Check("watchdogs", watchdogs),
    Check("clock", clock),
    Check("load", load),
)


def lacks(facts: Facts) -> tuple[str, ...]:
    """Return the titles of what is missing and needed."""
    return tuple(row.title for row in ROWS if row.needed and row.judge(facts).verdict is CheckResult.MISSING)
