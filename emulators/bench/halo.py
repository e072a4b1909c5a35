"""Words that stay readable where they cross a line."""

from typing import Final

from matplotlib.patheffects import Normal, Stroke

HALO: Final = (Stroke(linewidth=2.5, foreground="white"), Normal())
