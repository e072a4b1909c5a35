"""Origin and terms of use of a plant: an FMU's information on itself beside its equations."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class About:
    """Version, author and license of a plant's package, and the plant's page; empty where unknown."""

    version: str = ""
    author: str = ""
    licence: str = ""
    licence_text: str = ""
    page: str = ""
    """The plant's README: signs, equations, sources."""

    @property
    def copyright(self) -> str:
        """The license's line of copyright."""
        lines = (line.strip() for line in self.licence_text.splitlines())
        return next((line for line in lines if line.lower().startswith("copyright")), "")
