"""The simulation's commands, as rows; those of a family of devices are its own."""

from pathlib import Path
from typing import Any, Final

from firmware_bridge.cli.commands import CliCommand, Group, Row, Rows


class ByName(Rows):
    """Group that runs `robot` for words that are none of its commands, options in front included."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Put the default command in front of words that name none; refuse what is no robot either."""
        word = args[0]
        if word not in self.commands:
            # A family of another package is looked for when it is wanted.
            self.complete()
        if word in self.commands:
            return super().resolve_command(ctx, args)
        if not word.startswith("-"):
            self._is_robot(word)
        return super().resolve_command(ctx, ["robot", *args])

    def _is_robot(self, word: str) -> None:
        from firmware_bridge.cli.console import refusal
        from firmware_bridge.robot_types import SIGN, names

        robots, name = names(), word.partition(SIGN)[0]
        # A folder of that name may be a package that is not installed yet: the robot's message has it.
        if word.endswith(".toml") or name in robots or Path(name).is_dir():
            return
        families = sorted(set(self.commands) - {"robot"})
        raise refusal(
            f"emulate {word}: no such family or robot; there are the families {', '.join(families)} "
            f"and the robots {', '.join(robots)} (a path to a .toml file works, too)"
        )


COMMANDS: Final[tuple[Row, ...]] = (
    CliCommand(
        "bench",
        "emulators.cli.bench:bench",
        "Drive a mission in virtual time: bridge, bus, drives and plant, all in this process.",
    ),
    CliCommand(
        "replay",
        "emulators.cli.replay:replay",
        "Play a recording again in virtual time, and show the first packet that differs from it.",
    ),
    CliCommand(
        "report",
        "emulators.cli.report:report",
        "Make the page, the plots and the table of a recorded run, as `bench` makes them.",
    ),
    CliCommand(
        "study",
        "emulators.cli.study:study",
        "Reproduce a source's figures and numbers: printed, independent, ours, and why they differ.",
    ),
    CliCommand(
        "fmea",
        "emulators.cli.fmea:fmea",
        "Inject every fault in every state of a robot; report its detection, the time and the distance.",
    ),
    CliCommand(
        "campaign",
        "emulators.cli.campaign:campaign",
        "Drive missions x robots x protocols x faults x seeds x parameters, on all cores.",
    ),
    CliCommand(
        "faults",
        "emulators.cli.faults:faults",
        "List the faults of missions and tests; for a robot those that are possible on it, and where.",
    ),
    CliCommand(
        "inject",
        "emulators.cli.inject:inject",
        "Inject a fault into emulated devices that run now; or clear, state, set, restart, shutdown.",
    ),
    CliCommand(
        "doctor",
        "emulators.cli.doctor:doctor",
        "Check this machine: available, missing and critical items, and how to fix them.",
    ),
    Group(
        "emulate",
        """Put emulated devices on a real CAN bus or a serial line, in real time.

emulate FAMILY emulates devices of one family alone, with its own options: 'epos2' drives, 'cia402' plain
servos, 'motor_shield', or 'board', an Arduino with a motor shield, 'ar2' the board of an arm, 'imu' an
inertial sensor, 'motion_capture', or 'capture', cameras. emulate ROBOT emulates the devices and the plant
of a robot; the word 'robot' in front of the robot's name may be left out.""",
        """\b
Examples, the second without a robot:
  firmware-bridge emulate rars -i socketcan -c vcan0
  firmware-bridge emulate epos2 --node 1-2 -i socketcan -c vcan0""",
        kind=ByName,
        # An option in front of the robot's name is the robot's.
        context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False},
    ),
    CliCommand(
        "emulate robot",
        "emulators.cli.emulate_robot:emulate",
        "Put the robot's emulated drives and its plant on a real CAN bus, a serial line, or both.",
    ),
    Group(
        "fmu",
        "List, build and check plants: models of robots as FMUs.",
        "Example: firmware-bridge fmu check my_plant.fmu",
    ),
    CliCommand("fmu list", "emulators.cli.plants:list_models", "List the models that can be built."),
    CliCommand(
        "fmu show",
        "emulators.cli.plants:show",
        "List a plant's parameters: name, unit, default, meaning; and its inputs and outputs.",
    ),
    CliCommand(
        "fmu build",
        "emulators.cli.plants:build_model",
        "Build a robot's plant, or a model, as an FMU, with its sources inside.",
    ),
    CliCommand(
        "fmu check",
        "emulators.cli.plants:check",
        "Check an FMU: validity, start, bit-exact results, and the robots that it fits.",
    ),
)
