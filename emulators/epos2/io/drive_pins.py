"""All pins of one drive: inputs, outputs, and what is on some of them: brake, marker, compare."""

from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.io.digital_inputs import DigitalInputs
from emulators.epos2.io.digital_outputs import DigitalOutputs
from emulators.epos2.io.holding_brake import HoldingBrake
from emulators.epos2.io.position_compare import PositionCompare
from emulators.epos2.io.position_marker import PositionMarker
from emulators.servo.axis import ServoAxis


class Pins:
    """Wiring of a drive beside bus, motor and encoder."""

    def __init__(self, store: ObjectStore, axis: ServoAxis) -> None:
        self.inputs: Final = DigitalInputs(store, axis)
        self.outputs: Final = DigitalOutputs(store, axis)
        self.brake: Final = HoldingBrake(store, axis, self.outputs)
        self._marker: Final = PositionMarker(store, axis, self.inputs)
        self._compare: Final = PositionCompare(store, axis, self.outputs)

    def reset(self) -> None:
        """Begin as after power-on."""
        self.brake.close()
        self.outputs.reset()
        self.inputs.reset()
        self._marker.reset()
        self._compare.apply()

    def refresh(self) -> None:
        """Heed what the inputs and the axis have shown, and give the outputs their levels."""
        self._marker.refresh()
        self._compare.refresh()
        # Last: position compare may have changed its pin in this ms.
        self.outputs.refresh()
