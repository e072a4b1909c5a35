"""RARS's studies: figures and numbers of its thesis, made anew beside an independent way.

A. P. Das, "Design and control of a tele-operated mobile platform", PhD thesis, IIT Delhi, 2018.
"""

from typing import Final

from emulators.studies.study import Study

THESIS: Final = "A. P. Das, PhD thesis, IIT Delhi, 2018"
HERE: Final = "emulators.robots.rars.studies"

STUDIES: Final = (
    Study(
        "tipping",
        "Limits of acceleration and speed before it tips",
        f"{THESIS}, (2.2)-(2.7), Fig. 2.4-2.6",
        f"{HERE}.tipping:tipping",
    ),
)
