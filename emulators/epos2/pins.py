"""All pins of one drive: inputs, outputs, and the brake on one of them."""

from typing import Final

from emulators.epos2.digital_inputs import DigitalInputs
from emulators.epos2.digital_outputs import DigitalOutputs
from emulators.epos2.holding_brake import HoldingBrake
from emulators.epos2.store import ObjectStore
from emulators.servo.axis import ServoAxis


class Pins:
    """What is wired to a drive beside bus, motor and encoder."""

    def __init__(self, store: ObjectStore, axis: ServoAxis) -> None:
        self.inputs: Final = DigitalInputs(store, axis)
        self.outputs: Final = DigitalOutputs(store, axis)
        self.brake: Final = HoldingBrake(store, axis, self.outputs)

    def reset(self) -> None:
        """Begin as after power-on."""
        self.brake.close()
        self.outputs.reset()
        self.inputs.reset()
