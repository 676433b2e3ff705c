"""The shutter: how long and when the rows of a picture see."""

from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field

from eyas.engine.core.config import Config
from eyas.engine.core.variation import Variation, bounds, sample, within


class ShutterConfig(Config):
    """By default all rows of a picture see one instant.

    An exposure is centred on the instant of its picture, and the middle row's is that of a rolling
    shutter: labels are those of this instant.
    """

    blur: bool = False
    """Whether what moves while the shutter is open is blurred, see docs/camera/shutter.md."""
    exposure: Annotated[Variation, AfterValidator(within(0.0, 0.1))] = 0.01
    """Exposure time, where no sensor is modelled that sets it [s]; sampled for each tracker at
    each reset."""
    readout: Annotated[Variation, AfterValidator(within(0.0, 0.1))] = 0.0
    """Time from the exposure of the first row to that of the last, the height times the line time
    [s]; 0: a global shutter."""
    most_samples: Annotated[int, Field(ge=1, le=64)] = 8
    """Most instants of an exposure that are drawn: one, and one more for each pixel of motion."""

    @property
    def rolls(self) -> bool:
        """Whether rows are exposed one after the other."""
        return bounds(self.readout)[1] > 0.0


class Shutter:
    """The shutters of N cameras.

    Attributes:
        config: The settings.
        exposure: How long each is open [s], shape (N,); 0: an instant.
        readout: Time from the exposure of its first row to that of its last [s], shape (N,).

    Args:
        config: The settings.
        count: N.
    """

    def __init__(self, config: ShutterConfig, count: int) -> None:
        self.config = config
        self.exposure, self.readout = np.zeros(count), np.zeros(count)

    @classmethod
    def of(cls, config: ShutterConfig, count: int) -> "Shutter | None":
        """Return the shutters of some settings; None: all rows see one instant."""
        return cls(config, count) if config.blur or config.rolls else None

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""
        if self.config.blur:
            self.exposure[tracker] = sample(self.config.exposure, rng)
        self.readout[tracker] = sample(self.config.readout, rng)
