"""The arm's studies: its thesis' results, made again beside an independent way.

A. Seleit, "Rapid Orbital Motion Emulator (ROME)", MSc thesis, UCF, 2020.
"""

from typing import Final

from validation.studies.study import Study

THESIS: Final = "A. Seleit, MSc thesis, UCF, 2020"
HERE: Final = "validation.ar2"

STUDIES: Final = (
    Study(
        "resolved_rate",
        "How errors die away under the law, and ramp and sine of 80 mm through the whole chain",
        f"{THESIS}, (3.16), (3.24), (3.25)",
        f"{HERE}.rates:resolved_rate",
    ),
    Study(
        "laws",
        "Ramp in open loop, sine by PI, the orbit's height by PID, and the tool's workspace",
        f"{THESIS}, chapter 3, Fig. 3.3, 3.9-3.11",
        f"{HERE}.laws:laws",
    ),
)
