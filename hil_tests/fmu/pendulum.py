"""A model that is no robot, for what the exporter does with any: a pendulum of 1 kg."""

import sympy as sp

from fmu.export.model import Input, Model, Output, Parameter, StateVariable


def pendulum() -> Model:
    length, angle, speed, force = (sp.Symbol(n, real=True) for n in ("length", "angle", "speed", "force"))
    start = sp.sqrt(2 * 9.81 * (1 - sp.cos(1)) / length)
    return Model(
        name="pendulum",
        description="A pendulum of 1 kg",
        parameters=(Parameter("length", 1.0, "m", "length", "assumed"),),
        inputs=(Input("force", "N", "force across"),),
        states=(
            StateVariable("angle", "rad", sp.S.Zero, speed),
            # Starts on the orbit that just reaches 1 rad with length = 1 m.
            StateVariable("speed", "rad/s", start, (force - 9.81 * sp.sin(angle)) / length),
        ),
        outputs=(
            Output("angle", "rad", "angle", angle),
            Output("height", "m", "height", length * (1 - sp.cos(angle)), local=True),
        ),
        inner_step=1e-3,
    )  # fmt: skip
