"""Six links on stepper motors: the field that a driver turns pulls its rotor after it; README.md has them.

Everything is written in a frame that turns with the first joint, about which weight and links are alike.
"""

from collections.abc import Iterator, Sequence
from typing import Any, Final, NamedTuple

import sympy as sp

from fmu.ar2.parameters import AXES, PARAMETERS
from fmu.export.functions import named, positive_part, size
from fmu.export.model import Expression, Input, Model, Output, StateVariable
from fmu.parts.motor import bristle
from fmu.parts.stop import push
from fmu.parts.symbols import HALF, inner, symbol, symbols

P: Final = dict(symbols(PARAMETERS))
QUARTER: Final = sp.pi / 2
LINKS: Final = (
    (-1, P["shoulder"], P["height"], sp.S.Zero),
    (0, P["upper_arm"], sp.S.Zero, sp.S.Zero),
    (1, sp.S.Zero, sp.S.Zero, -QUARTER),
    (-1, sp.S.Zero, -P["forearm"], sp.S.Zero),
    (1, sp.S.Zero, sp.S.Zero, sp.S.Zero),
    (0, sp.S.Zero, -P["hand"], sp.pi),
)
"""Data of each joint: the sine of alpha, which is a right angle or none; a, d and the angle's offset."""


def line(expression: Expression) -> Expression:
    """Return it as a line of its own, where it is more than a name or a number."""
    return expression if expression.is_Atom else named(expression)


def lines(vector: Any) -> Any:
    """Return a vector whose parts are lines of their own."""
    return vector.applyfunc(line)


class Ground(NamedTuple):
    """Motion of the arm's ground, in its own frame; it turns about the first joint's axis."""

    ahead: Expression
    left: Expression
    turn: Expression


class Arm:
    """Positions of the links, their motion, and the effect of their masses; the foot may be on moving ground.

    Then the ground's three speeds stand before the joints' in every list by joints.
    """

    def __init__(self, ground: Ground | None = None) -> None:
        self.angles: Final = [symbol(f"angle_{axis}") for axis in AXES]
        self.ground: Final = ground
        self.first: Final = 0 if ground is None else len(ground)
        """Index of the first joint."""
        self.speeds: Final = [*(ground or ()), *(symbol(f"speed_{axis}") for axis in AXES)]
        self.axes: Final[list[Any]] = [sp.Matrix([0, 0, 1])]
        self.origins: Final[list[Any]] = [sp.zeros(3, 1)]
        self.masses: Final = [*(P[f"mass_{axis}"] for axis in AXES), P["payload"]]
        self.points: Final[list[Any]] = []
        """Positions of the masses: links, and the tool's payload."""
        self.swings: Final[list[Any]] = []
        """Accelerations of the masses where no joint's speed changes."""
        self.turned: Final[Any] = () if ground is None else (sp.cos(self.angles[0]), sp.sin(self.angles[0]))
        """Cosine and sine of the first joint's angle, where the ground's own directions count."""
        self._walk()
        self.columns: Final = [
            [
                *self.carried(point),
                *(
                    lines(self.axes[joint].cross(point - self.origins[joint]))
                    for joint in range(min(place + 1, 6))
                ),
            ]
            for place, point in enumerate(self.points)
        ]

    def in_frame(self, ahead: Expression, left: Expression) -> Any:
        """Return a level vector of the ground in the frame that turns with the first joint."""
        cosine, sine = self.turned
        return sp.Matrix([ahead * cosine + left * sine, left * cosine - ahead * sine, 0])

    def carried(self, point: Any) -> Iterator[Any]:
        """Yield how a point moves with the ground: ahead, to the left, and round; nothing where it rests."""
        if self.ground is not None:
            yield self.in_frame(sp.S.One, sp.S.Zero)
            yield self.in_frame(sp.S.Zero, sp.S.One)
            yield sp.Matrix([-point[1], point[0], 0])

    def _walk(self) -> None:
        """Go from link to link: frames, turn rates, and accelerations that the speeds alone make."""
        along = sp.Matrix([1, 0, 0])
        turning, turned, swing = sp.zeros(3, 1), sp.zeros(3, 1), sp.zeros(3, 1)
        if self.ground is not None:
            ahead, left, turn = self.ground
            turning = sp.Matrix([0, 0, turn])
            swing = lines(self.in_frame(-turn * left, turn * ahead))
        for joint, (sine, a, d, offset) in enumerate(LINKS):
            axis, speed = self.axes[-1], self.speeds[self.first + joint]
            # The first joint's angle is left out: the frame turns with it.
            angle = sp.S.Zero if joint == 0 else line(self.angles[joint] + offset)
            left = axis.cross(along)
            along = lines(line(sp.cos(angle)) * along + line(sp.sin(angle)) * left)
            way = lines(a * along + d * axis)
            # `turned` is the angular acceleration that the speeds
            # alone make, before this joint's own turn rate is added.
            turned = lines(turned + turning.cross(axis * speed))
            turning = lines(turning + axis * speed)
            # Euler's and the centripetal part; the joints' own accelerations come in by the mass matrix.
            bent = lines(turned.cross(way) + turning.cross(turning.cross(way)))
            self.points.append(lines(self.origins[-1] + way / 2))
            self.swings.append(lines(swing + bent / 2))
            swing = lines(swing + bent)
            self.origins.append(lines(self.origins[-1] + way))
            self.axes.append(axis if sine == 0 else lines(sine * along.cross(axis)))
        self.points.append(self.origins[-1])
        self.swings.append(swing)

    def inertia(self) -> list[list[Expression]]:
        """Return the lower half of the mass matrix, with the rotors behind their gears.

        Of the ground there is only what the arm makes of it.
        """
        found = []
        # A rotor's inertia counts behind its gear by the square of the ratio.
        rotors = [P[f"rotor_inertia_{axis}"] * P[f"gear_{axis}"] ** 2 for axis in AXES]
        for one, rotor in enumerate([sp.S.Zero] * self.first + rotors):
            row = [
                sum(
                    (
                        self.masses[place] * columns[one].dot(columns[other])
                        for place, columns in enumerate(self.columns)
                        if one < len(columns)
                    ),
                    sp.S.Zero,
                )
                for other in range(one + 1)
            ]
            row[one] += rotor
            found.append([line(it) for it in row])
        return found

    def loads(self) -> list[Expression]:
        """Return what weight and speeds do against each joint, N m, and against the ground's ways, N."""
        up = P["gravity"] * sp.Matrix([0, 0, 1])
        return [
            line(
                sum(
                    (
                        self.masses[place] * columns[one].dot(self.swings[place] + up)
                        for place, columns in enumerate(self.columns)
                        if one < len(columns)
                    ),
                    sp.S.Zero,
                )
            )
            for one in range(len(self.speeds))
        ]

    def energy(self, inertia: Sequence[Sequence[Expression]]) -> Expression:
        """Return kinetic and potential energy in J, that of the floor's height being 0."""
        moving = sum(
            (HALF if one == other else 1) * inertia[one][other] * self.speeds[one] * self.speeds[other]
            for one in range(len(self.speeds))
            for other in range(one + 1)
        )
        heights = (mass * point[2] for mass, point in zip(self.masses, self.points, strict=True))
        return moving + P["gravity"] * sum(heights)


def solved(lower: Sequence[Sequence[Expression]], right: Sequence[Expression]) -> list[Expression]:
    """Solve a symmetric positive system by its factors L D L'; `lower` is its lower half."""
    count = len(right)
    factors: list[list[Expression]] = [[sp.S.Zero] * count for _ in range(count)]
    pivots: list[Expression] = []
    for row in range(count):
        for column in range(row):
            taken = sum(factors[row][k] * factors[column][k] * pivots[k] for k in range(column))
            factors[row][column] = line((lower[row][column] - taken) / pivots[column])
        # No pivoting: a mass matrix is positive definite.
        pivots.append(line(lower[row][row] - sum(factors[row][k] ** 2 * pivots[k] for k in range(row))))
    found: list[Expression] = []
    for row in range(count):
        found.append(line(right[row] - sum(factors[row][k] * found[k] for k in range(row))))
    found = [line(value / pivot) for value, pivot in zip(found, pivots, strict=True)]
    for row in reversed(range(count)):
        found[row] = line(found[row] - sum(factors[k][row] * found[k] for k in range(row + 1, count)))
    return found


def lag(axis: str) -> Expression:
    """Return by how much the rotor is behind its field, in rad of the motor's shaft."""
    return symbol(f"field_{axis}") - P[f"gear_{axis}"] * (symbol(f"angle_{axis}") - P[f"rest_{axis}"])


def driven(axis: str) -> Expression:
    """Return the motor's torque behind its gear, N m: the field's pull, less with the speed, and damping."""
    gear, speed = P[f"gear_{axis}"], symbol(f"speed_{axis}")
    left = positive_part(1 - gear * size(speed) / P["fading_speed"])
    # A stepper's torque is a sine over the lag: largest a full step behind, and 0 again after two.
    pull = symbol("current_on") * P[f"holding_{axis}"] * left * sp.sin(P["pole_pairs"] * lag(axis))
    rate = 1 / P["damping_time"] + symbol("current_on") / P["driver_damping_time"]
    return P["efficiency"] * gear * pull - P[f"rotor_inertia_{axis}"] * gear**2 * rate * speed


def rubbed(axis: str) -> Expression:
    """Return what gear and bearing rub at a joint, N m: a part of what its motor can do, by a bristle."""
    level = P["friction"] * P["efficiency"] * P[f"gear_{axis}"] * P[f"holding_{axis}"]
    return level * symbol(f"bristle_{axis}")


def past_stops(axis: str) -> tuple[Expression, Expression]:
    """Return how far a joint is in its lower stop, and in its upper one, rad."""
    angle = symbol(f"angle_{axis}")
    return positive_part(P[f"stop_low_{axis}"] - angle), positive_part(angle - P[f"stop_high_{axis}"])


def stopped(axis: str) -> Expression:
    """Return what a joint's stops push back, N m."""
    (under, over), speed = past_stops(axis), symbol(f"speed_{axis}")
    stiffness, damping = P["stop_stiffness"], P["stop_damping"]
    return push(under, -speed, stiffness, damping) - push(over, speed, stiffness, damping)


def torque(axis: str) -> Expression:
    """Return what motor, stops and friction do at a joint, N m."""
    return driven(axis) + stopped(axis) - rubbed(axis)


def bent() -> Expression:
    """Return the energy of all stops that a joint is in, J."""
    return sum(HALF * P["stop_stiffness"] * depth**2 for axis in AXES for depth in past_stops(axis))


def inputs() -> tuple[Input, ...]:
    """Return what the drivers do."""
    fields = (
        Input(f"field_{axis}", "rad", f"how far the driver has turned the field, {axis}") for axis in AXES
    )
    return (*fields, Input("current_on", "1", "drivers' current, 1 on, 0 off", 1.0, switch=True))


def states(rates: Sequence[Expression]) -> tuple[StateVariable, ...]:
    """Return the joints; `rates` are their accelerations, rad/s2."""
    return (
        *(StateVariable(f"angle_{axis}", "rad", P[f"rest_{axis}"], symbol(f"speed_{axis}")) for axis in AXES),
        *(
            StateVariable(f"speed_{axis}", "rad/s", sp.S.Zero, rate)
            for axis, rate in zip(AXES, rates, strict=True)
        ),
        *(
            StateVariable(
                f"bristle_{axis}",
                "1",
                sp.S.Zero,
                bristle(symbol(f"speed_{axis}"), symbol(f"bristle_{axis}"), P["joint_presliding"]),
            )
            for axis in AXES
        ),
    )


def outputs() -> tuple[Output, ...]:
    """Return what joints and rotors do."""
    return (
        *(Output(f"angle_{axis}", "rad", f"joint's angle, {axis}", symbol(f"angle_{axis}")) for axis in AXES),
        *(
            Output(f"speed_{axis}", "rad/s", f"joint's speed, {axis}", symbol(f"speed_{axis}"))
            for axis in AXES
        ),
        *(
            Output(f"lag_{axis}", "rad", f"rotor behind its field, at the motor, {axis}", lag(axis))
            for axis in AXES
        ),
    )


def model() -> Model:
    """Return the equations of the arm with all tables."""
    arm = Arm()
    inertia = arm.inertia()
    torques = [line(torque(axis) - load) for axis, load in zip(AXES, arm.loads(), strict=True)]
    turn = symbol(f"angle_{AXES[0]}")
    velocity = sum(
        (column * speed for column, speed in zip(arm.columns[-1], arm.speeds, strict=True)), sp.zeros(3, 1)
    )
    x, y, z = arm.origins[-1]
    return Model(
        name="ar2",
        description="The arm AR2: six joints on stepper motors with gears",
        parameters=PARAMETERS,
        inputs=inputs(),
        states=states(solved(inertia, torques)),
        outputs=(
            *outputs(),
            Output("tool_x", "m", "tool, along the floor's x", x * sp.cos(turn) - y * sp.sin(turn)),
            Output("tool_y", "m", "tool, along the floor's y", x * sp.sin(turn) + y * sp.cos(turn)),
            Output("tool_z", "m", "tool, above the floor", z),
            Output("tool_speed", "m/s", "tool, how fast it moves", sp.sqrt(velocity.dot(velocity))),
            inner("energy", "J", "energy of links, rotors and stops", arm.energy(inertia) + bent(), 10.0),
        ),
        inner_step=50e-6,
    )
