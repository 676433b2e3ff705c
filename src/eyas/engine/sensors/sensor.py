"""A sensor whose readings are numbers: what it measures, and the kernel that measures it.

    COMPASS = Sensor(name="compass", unit="gauss", parts={...}, read=_read, noise=0.0012)

The kernel writes the truth. Noise, bias, rate, delay and drop-out are
`eyas.engine.sensors.readings`', the same for all sensors. How to add one is in docs/sensors.md.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.own_code import takes
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.lanes import Kernel, kernel

Floats = NDArray[np.float64]

_ARGUMENTS = ("snapshot", "terrain", "n", "settings", "reading")


@kernel(inline=True)
def keep(snapshot: Snapshot, terrain: Terrain, n: int, settings: Floats, reading: Floats) -> None:
    """Leave a reading as its errors have made it: a `Sensor.settle`."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sensor:
    """A row of the table of sensors.

    Raises:
        ConfigError: A name or a kernel is not one.
    """

    name: str
    """Name of the sensor, and of its part of observations; its random numbers depend on it."""
    unit: str
    """Unit of its numbers; interfaces choose their messages by it."""
    parts: Mapping[str, tuple[str, ...]]
    """Its readings by their names in `info` and labels, each with the names of its numbers, which
    are columns of tables: `{"magnetic_field": ("magnetic_field_x", ...)}`."""
    read: Callable[..., None]
    """Kernel `read(snapshot, terrain, n, settings, reading)`, which writes what a sensor without
    errors reads on tracker `n` into `reading`, shape (width,)."""
    noise: float
    """Standard deviation of the noise of a small sensor of this kind [unit], for who needs one that
    is not exact. By default sensors are."""
    settings: Mapping[str, float] = field(default_factory=dict)
    """Numbers that `sensors.further` may set, with their defaults; its kernels get them in this
    order."""
    settle: Callable[..., None] = keep
    """Kernel with the arguments of `read` that completes a reading after errors were added to it:
    wraps angles, writes numbers that follow from others."""

    def __post_init__(self) -> None:
        for name in (self.name, *self.parts, *self.columns, *self.settings):
            if not re.fullmatch(r"[a-z][a-z0-9_]{0,63}", name):
                raise ConfigError(
                    f"sensor {self.name!r}: {name!r} is not a name; allowed: a small letter, then "
                    "small letters, digits and '_'"
                )
        if len(set(self.columns)) != self.width or not self.columns:
            raise ConfigError(
                f"sensor {self.name!r}: parts: {dict(self.parts)} is not allowed: at least one "
                "number, each with a name of its own"
            )
        for what in (self.read, self.settle):
            why = "it is none" if not isinstance(what, Kernel) else takes(what, *_ARGUMENTS)
            if why:
                raise ConfigError(
                    f"sensor {self.name!r}: read and settle must be kernels, functions of "
                    f"{', '.join(_ARGUMENTS)} with the decorator eyas.kernel: {why}"
                )

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of its numbers."""
        return tuple(name for names in self.parts.values() for name in names)

    @property
    def width(self) -> int:
        """How many numbers it reads."""
        return len(self.columns)

    def slices(self, first: int = 0) -> dict[str, slice]:
        """Return the columns of each part in rows where its first number is in column `first`."""
        found = {}
        for name, numbers in self.parts.items():
            found[name] = slice(first, first + len(numbers))
            first += len(numbers)
        return found
