"""The guard: the last look at everything that leaves for the drives; behind it is only the wire."""

from firmware_bridge.safety.guard.guard import Guarded, Listener, Refusal, guarded

__all__ = ["Guarded", "Listener", "Refusal", "guarded"]
