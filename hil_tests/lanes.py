"""How many examples a test draws: all that it asks for, or a tenth of them in the first lane.

Hypothesis times none: the tests' time is virtual, and the wall's says how busy the machine is.
"""

from typing import Final

from hypothesis import settings

FULL: Final = 100
FIRST_LANE: Final = "first-lane"

settings.register_profile("virtual time", settings(deadline=None, max_examples=FULL))
settings.register_profile(FIRST_LANE, settings(deadline=None, max_examples=FULL // 10))
settings.load_profile("virtual time")


def examples(count: int) -> int:
    """Return how many of a test's examples this run draws; the profile is loaded before tests are read."""
    return -(-count * settings().max_examples // FULL)
