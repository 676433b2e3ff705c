"""Settings of the shutter."""

from typing import Annotated

from pydantic import AfterValidator, Field

from eyas.core.config import Config
from eyas.core.variation import Variation, bounds, within

__all__ = ["ShutterConfig"]


class ShutterConfig(Config):
    """How long and when the rows of a picture see; by default all see one instant.

    An exposure is centred on the instant of its picture, and the middle row's is that of a rolling
    shutter: labels are those of this instant.
    """

    blur: bool = False
    """Whether what moves while the shutter is open is blurred."""
    exposure: Annotated[Variation, AfterValidator(within(0.0, 0.1))] = 0.01
    """Exposure time, as long as `camera.exposure` does not set one [s]."""
    readout: Annotated[Variation, AfterValidator(within(0.0, 0.1))] = 0.0
    """Time from the exposure of the first row to that of the last, the height times the line time
    [s]; 0: a global shutter."""
    most_samples: Annotated[int, Field(ge=1, le=64)] = 8
    """Most instants of an exposure that are drawn: one for each pixel of motion up to this."""

    @property
    def rolls(self) -> bool:
        """Whether rows are exposed one after the other."""
        return bounds(self.readout)[1] > 0.0
