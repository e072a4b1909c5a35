"""Failure mode and effects analysis on the bench: the effect of every fault in every state of a robot."""
