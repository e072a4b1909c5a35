"""The bridge's half of the family, as one value: the object of its entry point."""

from functools import partial
from typing import Final

from firmware_bridge.dissector.lines import TextLine
from firmware_bridge.dissector.protocols import Protocols
from firmware_bridge.family import Family

from toy_drive import wire
from toy_drive.driver import ToyDevice, alone, link_drivers, stop_stages
from toy_drive.guard import ToyRules
from toy_drive.settings import ToyAxis, ToyDriver, ToyLink

FAMILY: Final = Family(
    name="toy_drive",
    title="a toy drive on its serial line",
    link=ToyLink,
    axis=ToyAxis,
    link_drivers=link_drivers,
    reports=lambda _robot, _axis: ToyDevice.reports,
    stop_stages=stop_stages,
    confirmed_by="an answer with the axis at standstill, or without power",
    alone=alone,
    wire_rules=ToyRules,
    protocols={ToyDriver.TOY_DRIVE: Protocols(partial(TextLine, wire.decoded))},
)
