"""What a packet says, in a line of text for people; and where two runs of packets part."""

from firmware_bridge.dissector.difference import difference_text, first_difference
from firmware_bridge.dissector.dissector import Carried, Dissector, kinds_of

__all__ = ["Carried", "Dissector", "difference_text", "first_difference", "kinds_of"]
