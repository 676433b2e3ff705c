"""What a renderer on a device draws: cameras, in the layout that its kernels read."""

import operator
from typing import Any, NamedTuple, Protocol

import numpy as np

from eyas.lanes.device import Device
from eyas.render.device import DeviceRenderer, PictureSize
from eyas.render.kernels.bundles import Geometry, Job, Light, Movers
from eyas.render.outputs import NO_OUTPUT
from eyas.render.renderer import GRIDS
from eyas.state.lighting import LightState

__all__ = ["DeviceDrawer", "DeviceViews", "StagedDrawer"]

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


class DeviceDrawer(Protocol):
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


class StagedDrawer:
    """Draws by `eyas.render.device.DeviceRenderer`, whose working memory is for one number of
    pictures; there is one for each number.

    Args:
        device: The device.
        geometry: Everything that can be drawn.
        light: Light and air.
        samples: Samples per pixel.
    """

    def __init__(self, device: Device, geometry: Geometry, light: Light, samples: int = 1) -> None:
        self._device, self._geometry, self._light = device, geometry, light
        self._grid = GRIDS[samples]
        self._made: dict[PictureSize, tuple[DeviceRenderer, Job]] = {}
        self._last: PictureSize | None = None
        self._given: tuple[Any, ...] = ()
        self._cut: Any = None

    def draw(self, cameras: DeviceViews, movers: Movers, rgb: Array) -> None:
        """Draw the pictures of V cameras, see `DeviceDrawer`."""
        views, (height, width) = cameras.views, rgb.shape[1:3]
        size = PictureSize(views, height, width, *self._grid)
        if size not in self._made:
            renderer = DeviceRenderer(self._device, self._geometry, self._light)
            self._made[size] = renderer, self._new_job(size)
        renderer, job = self._made[size]
        timed = cameras.instant.shape[0] > 0
        # Mostly the same arrays as the last time: cutting off a dozen takes some time.
        given = rgb, *cameras[1:]
        if self._last != size or not all(map(operator.is_, given, self._given)):
            self._last, self._given = size, given
            self._cut = _with_cameras(job, cameras, timed=timed), rgb[:views]
        job, pictures = self._cut
        output = NO_OUTPUT._replace(rgb=pictures)
        renderer.draw(size, job, movers, output, falls=int(timed and cameras.falling))

    def _new_job(self, size: PictureSize) -> Job:
        """Return a job without its cameras, for whole views."""
        views = size.views
        band = np.zeros((views, 3), np.int32)
        band[:, 0], band[:, 2] = np.arange(views), size.height
        nothing: Any = np.zeros(0)
        return Job(
            picture=self._device.upload(np.arange(views, dtype=np.int32)),
            band=self._device.upload(band),
            begun=self._device.zeros(1, np.int64),
            eye=nothing,
            axes=nothing,
            world=nothing,
            subject=nothing,
            light=LightState.create(0),
            instant=nothing,
            focal=nothing,
            lens=self._device.zeros(0, np.int32),
        )


def _with_cameras(job: Job, cameras: DeviceViews, *, timed: bool) -> Job:
    """Return a job with V cameras."""
    rows = slice(cameras.views)
    return job._replace(
        eye=cameras.eye[rows],
        axes=cameras.axes[rows],
        world=cameras.world[rows],
        subject=cameras.subject[rows],
        light=LightState(*(array[rows] for array in cameras.light)),
        instant=cameras.instant[rows] if timed else cameras.instant,
        focal=cameras.focal[rows],
    )
