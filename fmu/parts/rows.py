"""Parameters that several plants have: motors and battery. Without SymPy, so that reading them is quick."""

from fmu.export.model import Parameter


def motor_rows(
    axis: str,
    source: str,
    *,
    resistance: float,
    inductance: float,
    torque_constant: float,
    rotor_inertia: float,
    no_load_current: float,
    voltage: float = 24.0,
) -> tuple[Parameter, ...]:
    """Return one motor's parameters; half of the no-load torque is dry friction, half viscous (assumed)."""
    no_load_torque = torque_constant * no_load_current
    no_load_speed = (voltage - resistance * no_load_current) / torque_constant
    friction = f"half of the no-load current {no_load_current} A at {voltage:g} V; {source}"
    return (
        Parameter(f"resistance_{axis}", resistance, "Ohm", "winding resistance", source),
        Parameter(f"inductance_{axis}", inductance, "H", "winding inductance", source),
        Parameter(f"torque_constant_{axis}", torque_constant, "N.m/A", "torque constant", source),
        Parameter(f"rotor_inertia_{axis}", rotor_inertia, "kg.m2", "rotor inertia", source),
        Parameter(
            f"coulomb_{axis}", 0.5 * no_load_torque, "N.m", "dry friction of the motor", friction, least=0.0
        ),
        Parameter(
            f"viscous_{axis}",
            0.5 * no_load_torque / no_load_speed,
            "N.m.s/rad",
            "viscous friction of the motor",
            friction,
        ),
    )


def battery_rows(source: str, voltage: float = 24.0) -> tuple[Parameter, ...]:
    """Return the battery's parameters."""
    return (
        Parameter(
            "battery_emf", voltage, "V", "battery's open-circuit voltage", source, least=0.0, tunable=True
        ),
        Parameter("battery_resistance", 0.050, "Ohm", "battery's inner resistance", source, tunable=True),
    )


def tyre_rows(source: str, *, floor_friction: float) -> tuple[Parameter, ...]:
    """Return the parameters of fmu.parts.tyre, with RARS's ways of the tyre's rubber."""
    return (
        Parameter(
            "floor_friction",
            floor_friction,
            "1",
            "peak of the tyres' adhesion",
            source,
            least=0.0,
            tunable=True,
        ),
        Parameter("peak_slip", 0.15, "1", "slip at the peak of adhesion", source, least=0.0, most=1.0),
        Parameter(
            "friction_circle",
            1.0,
            "1",
            "1: both slips share one adhesion; 0: each its own",
            source,
            least=0.0,
            most=1.0,
        ),
        Parameter(
            "slip_speed",
            0.01,
            "m/s",
            "speed below which the slip is taken over this speed",
            source,
            least=0.0,
        ),
        Parameter("tyre_stiffness", 5e5, "N/m", "tyre against floor, each way", source),
        Parameter("tyre_damping", 4000.0, "N.s/m", "tyre against floor, at rest", source),
    )
