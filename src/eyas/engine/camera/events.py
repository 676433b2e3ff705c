"""Settings of the event camera."""

from typing import Annotated

from pydantic import Field

from eyas.engine.core.config import Config


class EventsConfig(Config):
    """An event camera with the lens of the camera; by default there is none.

    Thresholds, refractory time and leak are of the order of those of published sensors: 0.15 to
    0.3, 0.1 ms to 1 ms, and 0.1 events a second (v2e, table 1).
    """

    enabled: bool = False
    """Whether the tracker has an event camera, see docs/camera/events.md."""
    width: Annotated[int, Field(ge=8, le=2048)] | None = None
    """[pixels]; None: that of the camera. With another shape than the camera's it shows the same
    view, squeezed."""
    height: Annotated[int, Field(ge=8, le=2048)] | None = None
    """[pixels]; None: that of the camera."""
    bins: Annotated[int, Field(ge=1, le=64)] = 1
    """Parts of the time between two observations, whose events are counted each."""
    positive: Annotated[float, Field(gt=0, le=5)] = 0.2
    """Contrast threshold of more light: change of the natural logarithm of the light."""
    negative: Annotated[float, Field(gt=0, le=5)] = 0.2
    """The same of less light."""
    mismatch: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    """Standard deviation of the thresholds of the pixels, as a share of them."""
    refractory: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Time after an event in which a pixel has no other [s]."""
    leak: Annotated[float, Field(ge=0, le=100)] = 0.0
    """Events of more light of a pixel where nothing changes [Hz]."""
    shot: Annotated[float, Field(ge=0, le=100)] = 0.0
    """Events of a dark pixel by shot noise; a bright one has a quarter [Hz]."""
    dark: Annotated[float, Field(ge=1e-9, le=1)] = 0.001
    """Light that a pixel sees in the dark, of the radiance of white paper in the sun: it keeps the
    logarithm finite."""
    most_samples: Annotated[int, Field(ge=1, le=1000)] = 32
    """Most instants between two pictures that are drawn for it: one for each pixel of motion up
    to this."""
