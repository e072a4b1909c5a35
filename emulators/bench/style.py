"""Colors and style of the bench's pictures, independent of the code that draws them."""

from pathlib import Path
from typing import Final

# Okabe and Ito's palette: distinguished with every common kind of color blindness, and in gray by lightness.
BLUE: Final = "#0072B2"
ORANGE: Final = "#E69F00"
GREEN: Final = "#009E73"
VERMILION: Final = "#D55E00"
PURPLE: Final = "#CC79A7"
SKY: Final = "#56B4E9"
INK: Final = "#222222"
PALE: Final = "#9A9A9A"
AXIS_COLORS: Final = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)

STYLE: Final = Path(__file__).with_name("bench.mplstyle")
