"""Packets decoded to a line of text for people; and the first difference between two runs of packets."""

from firmware_bridge.dissector.difference import difference_text, first_difference
from firmware_bridge.dissector.dissector import Carried, Dissector, kinds_of

__all__ = ["Carried", "Dissector", "difference_text", "first_difference", "kinds_of"]
