"""ROME's studies: numbers of its thesis, made again beside an independent way.

A. Seleit, "Rapid Orbital Motion Emulator (ROME)", MSc thesis, UCF, 2020.
"""

from typing import Final

from validation.studies.study import Study

THESIS: Final = "A. Seleit, MSc thesis, UCF, 2020"
HERE: Final = "validation.rome_arm"

STUDIES: Final = (
    Study(
        "orbit",
        "An orbit about the Earth, by F and G, and flown on a floor by base and arm",
        f"{THESIS}, 2.4, (4.7), (4.8), (4.10)",
        f"{HERE}.orbit:orbit",
    ),
)
