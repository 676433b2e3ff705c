"""What the import of a map tells."""

import shlex
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

__all__ = ["Report"]


@dataclass(slots=True)
class Report:
    """What an import has found and guessed."""

    name: str
    folder: Path
    registered: bool  # Whether it is known by its name; otherwise by its folder
    size: tuple[float, float] = (0.0, 0.0)  # Extent of the floor [m]
    lanes: int = 0
    signals: int = 0  # Programs of traffic lights
    buildings: int = 0
    trees: int = 0
    guessed: Counter[str] = field(default_factory=Counter)
    """Number of things without a tag, by what had to be guessed."""
    odd: Counter[str] = field(default_factory=Counter)
    """Number of values that made no sense, by tag."""
    broken: Counter[str] = field(default_factory=Counter)
    """Number of outlines that were mended or left out, by what was wrong."""
    traffic: str = ""  # What was recorded, or why nothing was
    seconds: float = 0.0

    @property
    def known_as(self) -> str:
        """What commands and settings call the map."""
        return self.name if self.registered else str(self.folder)

    def lines(self) -> list[str]:
        """Return the report for people."""
        width, height = self.size
        made = [
            f"{self.name}: {width:.0f} x {height:.0f} m, {self.lanes} lanes, {self.signals} "
            f"traffic lights, {self.buildings} buildings, {self.trees} trees, "
            f"in {self.seconds:.0f} s",
            f"kept in {self.folder}; use it with --map {shlex.quote(self.known_as)}",
        ]
        for word, counted in (("guessed", self.guessed), ("odd tags", self.odd),
                              ("mended or left out", self.broken)):  # fmt: skip
            if counted:
                parts = ", ".join(f"{count} {what}" for what, count in sorted(counted.items()))
                made.append(f"{word}: {parts}")
        return [*made, self.traffic, "© OpenStreetMap contributors"]
