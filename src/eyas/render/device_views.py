"""What a renderer on a device draws: cameras, in the layout that its kernels read."""

from typing import Any, NamedTuple, Protocol

from eyas.render.kernels.bundles import Movers
from eyas.state.lighting import LightState

__all__ = ["DeviceRenderer", "DeviceViews"]

Array = Any
"""An `eyas.lanes.device.DeviceArray`."""


class DeviceViews(NamedTuple):
    """V cameras. The arrays lie on the device and may have more rows; the first V count."""

    views: int
    """V."""
    eye: Array
    """Optical centres, world frame [m], float64, shape (V, 3)."""
    axes: Array
    """Forward, left, up as rows, float64, shape (V, 3, 3)."""
    world: Array
    """Row of the draw list that each shows, int32, shape (V,)."""
    subject: Array
    """Object id of each view's subject, int32, shape (V,)."""
    light: LightState
    """Changes of the light, float32, shape (V,) each."""
    instant: Array
    """Time for what falls and for the wind [s], float64, shape (V,), or (0,) if neither is
    shown."""
    focal: Array
    """Focal length along rows and along columns [pixels], float64, shape (V, 2)."""
    falling: bool
    """Whether flakes, drops and leaves are drawn at that time."""


class DeviceRenderer(Protocol):
    """Draws a scene and the things that move in it on a device."""

    def draw(self, cameras: DeviceViews, movers: Movers, rgb: Array) -> None:
        """Draw the pictures of V cameras.

        Args:
            cameras: The cameras.
            movers: Draw lists on the device, the first V rows of which count.
            rgb: sRGB, row 0 on top, on the device, uint8, shape (at least V, H, W, 3); the first V
                are written.
        """
        ...
