"""What models of the catalogue have in common while they are made."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.targets.kind import Model


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnModel(Model):
    """A model with what draws it."""

    def plain(self) -> Model:
        """Return what ships of it beside its arrays."""
        return Model(**{field.name: getattr(self, field.name) for field in fields(Model)})

    def check_meshes(
        self,
        # All points of the finest meshes of the resting model [m], shape (P, 3)
        points: NDArray[np.floating],
        tolerance: float,  # Share of the size that they may differ by
        *,
        antennas: bool = False,  # Whether something may stand out above
    ) -> None:
        """Raise a `ConfigError` if the meshes are not of the size that is said."""
        ratio = np.ptp(points, axis=0) / self.size
        wrong = np.abs(ratio - 1.0) > tolerance
        wrong[2] &= not (antennas and ratio[2] > 1.0)
        if wrong.any():
            sides = " x ".join(f"{side:.2f}" for side in np.ptp(points, axis=0))
            said = " x ".join(f"{side:.2f}" for side in self.size)
            raise ConfigError(
                f"targets: {self.name!r} says that it is {said} m, but its meshes are {sides} m; "
                f"allowed: {tolerance:.0%} more or less; change its size, or its lines [m]"
            )
