"""The golden traces: the first seconds of each shipped mission, as any machine must carry them.

`python tools/golden_traces.py` drives them, prints their hashes as JSON, and reports on the standard error
the first packet that differs from those kept, and last the engine of the drives' loops. With `--renew` (`make
golden`) it writes them to `hil_tests/golden` instead: the hashes to `traces.json`, the traces themselves to
`MISSION.trace.xz`. Renew them when a change is meant to change the traffic, and give the reason in the
commit.
"""

# ruff: noqa: INP001, T201 - a script, not a package

import json
import lzma
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeAlias

import numpy as np

from emulators.bench import mission
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.operator import ScriptedOperator
from emulators.rig import Rig
from emulators.run import HAND_STREAM
from emulators.servo import kernel
from emulators.trace import parse_trace_line
from firmware_bridge.dissector import Carried, first_difference
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds
from fmu.build import ensure
from fmu.verify import recorded

Traces: TypeAlias = dict[str, str]
"""SHA-256 by what it is of: `plant NAME`, `mission NAME`, or `mission NAME, LINK` for one link of it."""

FOLDER: Final = Path(__file__).parents[1] / "hil_tests" / "golden"
PATH: Final = FOLDER / "traces.json"
ROBOT: Final = "rars"
SECONDS: Final = 8.0
"""Set up, armed and under way by then."""
SEED: Final = 1


@dataclass(frozen=True, slots=True)
class Driven:
    """The first seconds of a mission: every packet as a line of the trace, and the hashes by their names."""

    mission: str
    lines: bytes
    hashes: Traces


def missions() -> list[str]:
    """Return the names of the shipped missions that a hand drives: a pilot's sines are each machine's own."""
    robot = find(ROBOT)
    bench_setup = bench_setup_of(robot)
    shipped = {name: mission.find(name, robot, bench_setup) for name in bench_setup.shipped()}
    return [name for name, one in shipped.items() if one.pilot is None and one.survey is None]


def plant() -> str:
    """Return the fingerprint of the plant: what its equations give without a compiler."""
    carried = recorded(ensure(find(ROBOT).plant.fmu))
    if carried is None:
        raise SystemExit(f"golden_traces: the plant of {ROBOT} carries no fingerprint; build it again")
    return carried.sha256


def drive(name: str) -> Driven:
    """Drive the first seconds of a mission."""
    robot = find(ROBOT)
    bench_setup = bench_setup_of(robot)
    script = mission.find(name, robot, bench_setup)
    operator = ScriptedOperator(robot, bench_setup, script, np.random.default_rng([SEED, HAND_STREAM]))
    rig = Rig(robot, bench_setup, operator, seed=SEED, noise=script.noise, faults=script.fault)
    lines: list[bytes] = []
    rig.world.observe(lines.append)
    rig.run(from_seconds(SECONDS))
    rig.finish()
    links = {f"mission {name}, {link}": sha256 for link, sha256 in rig.world.links_sha256.items()}
    return Driven(name, b"".join(lines), {f"mission {name}": rig.world.trace_sha256} | links)


def kept(name: str) -> Path:
    """Return where a mission's packets are kept."""
    return FOLDER / f"{name}.trace.xz"


def carried(lines: bytes) -> list[Carried]:
    """Return the packets of a trace."""
    return [Carried(*parse_trace_line(line)) for line in lines.decode("ascii").splitlines()]


def difference(driven: Driven) -> str:
    """Return in words which packet is the first that is not as kept; empty where all are."""
    golden = carried(lzma.decompress(kept(driven.mission).read_bytes()))
    found = first_difference(golden, carried(driven.lines))
    return "" if found is None else f"mission {driven.mission}: {found}"


def golden() -> Traces:
    """Return the hashes that are kept."""
    hashes: Traces = json.loads(PATH.read_text(encoding="utf-8"))
    return hashes


def renew(traces: Traces, all_driven: list[Driven]) -> None:
    """Write all; a mission's packets only where they are others, because compressors differ."""
    for file in set(FOLDER.glob("*.trace.xz")) - {kept(driven.mission) for driven in all_driven}:
        file.unlink()
    for driven in all_driven:
        file = kept(driven.mission)
        if not file.exists() or lzma.decompress(file.read_bytes()) != driven.lines:
            file.write_bytes(lzma.compress(driven.lines, preset=9 | lzma.PRESET_EXTREME))
    PATH.write_text(json.dumps(traces, indent=2) + "\n", encoding="utf-8")


def main() -> None:
    """Print or renew them."""
    all_driven = [drive(name) for name in missions()]
    traces: Traces = {f"plant {ROBOT}": plant()}
    for driven in all_driven:
        traces |= driven.hashes
    if "--renew" in sys.argv[1:]:
        renew(traces, all_driven)
        return
    for reported in filter(None, map(difference, all_driven)):
        print(reported, file=sys.stderr)
    print("kernel" if kernel.choose().library is not None else "reference", file=sys.stderr)
    print(json.dumps(traces, indent=2))


if __name__ == "__main__":
    main()
