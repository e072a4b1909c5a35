"""`emulators.bench.bench_setup` under its name of the release before."""

from firmware_bridge import renamed

__getattr__ = renamed.module(
    __name__,
    "emulators.bench.bench_setup",
    Rehearsal="BenchSetup",
    Twist="TwistAxes",
    rehearsal_of="bench_setup_of",
    rehearsals="bench_setups",
)
