"""Heights of the ground, and the files of the project."""

import json
from pathlib import Path
from typing import Any, NamedTuple


class Ground(NamedTuple):
    """Heights of the ground, as the world file has them."""

    floor: float  # z where the relief is 0 [m]
    relief: list[list[float]]
    """Heights above the floor, from south to north, then from west to east [m]; empty: flat."""
    west: float
    south: float
    spacing: float

    def above_floor(self, x: float, y: float) -> float:
        """Return the height of the ground above the floor, linear between the points [m]."""
        if not self.relief:
            return 0.0
        rows, columns = len(self.relief), len(self.relief[0])
        across = min(max((x - self.west) / self.spacing, 0.0), columns - 1.0)
        up = min(max((y - self.south) / self.spacing, 0.0), rows - 1.0)
        column, row = min(int(across), columns - 2), min(int(up), rows - 2)
        across, up = across - column, up - row
        south, north = (
            (1.0 - across) * line[column] + across * line[column + 1]
            for line in self.relief[row : row + 2]
        )
        return (1.0 - up) * south + up * north


def ground_of(folder: Path) -> Ground:
    """Return the ground that a folder of roads tells."""
    told = json.loads((folder / "ground.json").read_text(encoding="utf-8"))
    return Ground(told["floor"], told["relief"], told["west"], told["south"], told["spacing"])


def settings_of(project: Path) -> dict[str, Any]:
    """Return `config/env_config.json`, with what it does not tell from the file beside it."""
    folder = project / "config"
    whole: dict[str, Any] = json.loads((folder / "env_config_backup.json").read_text())
    changed = json.loads((folder / "env_config.json").read_text())
    for key, value in changed.items():
        whole[key] = {**whole.get(key, {}), **value} if isinstance(value, dict) else value
    return whole
