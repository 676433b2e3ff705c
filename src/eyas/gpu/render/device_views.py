"""What a renderer on a device draws: cameras, in the layout that its kernels read."""

import operator
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from eyas.engine.render.kernels.bundles import Geometry, Job, Light, Movers, Output
from eyas.engine.render.outputs import NO_OUTPUT
from eyas.engine.render.renderer import GRIDS
from eyas.engine.state.lighting import LightState
from eyas.gpu.render.device import DeviceRenderer, PictureSize
from eyas.lanes.device import Device

Array = Any  # An `eyas.lanes.device.DeviceArray`.


class DeviceViews(NamedTuple):
    """V cameras. The arrays lie on the device and may have more rows; the first V count."""

    views: int  # V
    eye: Array  # Optical centres, world frame [m], float64, shape (V, 3)
    axes: Array  # Forward, left, up as rows, float64, shape (V, 3, 3)
    world: Array  # Row of the draw list that each shows, int32, shape (V,)
    subject: Array  # Object id of each view's subject, int32, shape (V,)
    light: LightState  # Changes of the light, float32, shape (V,) each
    instant: Array
    """Time for what falls and for the wind [s], float64, shape (V,), or (0,) if neither is
    shown."""
    focal: Array  # Focal length along rows and along columns [pixels], float64, shape (V, 2)
    falling: bool  # Whether flakes, drops and leaves are drawn at that time


class DeviceDrawer(Protocol):
    """Draws a scene and the things that move in it on a device."""

    def draw(
        self, cameras: DeviceViews, movers: Movers, rgb: Array, subject: Array | None = None
    ) -> None:
        """Draw the pictures of V cameras.

        Args:
            cameras: The cameras.
            movers: Draw lists on the device, the first V rows of which count.
            rgb: sRGB, row 0 on top, on the device, uint8, shape (at least V, H, W, 3); the first V
                are written.
            subject: What is measured of each camera's subject, as `Output.subject` on the device,
                int32, shape (at least V, 10), likewise; None: nothing.
        """
        ...


@dataclass
class _Made:
    """What draws so many pictures, and what it was last asked to."""

    renderer: DeviceRenderer
    job: Job  # Without its cameras
    given: tuple[Any, ...] = ()  # The arrays that it was given
    cut: Any = None  # The job with the cameras
    output: Output = NO_OUTPUT


class StagedDrawer:
    """Draws by `eyas.gpu.render.device.DeviceRenderer`, whose working memory is for one number of
    pictures; there is one for each number.

    Args:
        device: The device.
        geometry: Everything that can be drawn.
        light: Light and air.
        samples: Samples per pixel.
        tent: See `Views`.
    """

    def __init__(
        self,
        device: Device,
        geometry: Geometry,
        light: Light,
        samples: int = 1,
        *,
        tent: bool = True,
    ) -> None:
        self._device, self._geometry, self._light = device, geometry, light
        self._grid, self._tent = GRIDS[samples], tent
        self._made: dict[PictureSize, _Made] = {}

    def draw(
        self, cameras: DeviceViews, movers: Movers, rgb: Array, subject: Array | None = None
    ) -> None:
        """Draw the pictures of V cameras, see `DeviceDrawer`."""
        height, width = rgb.shape[1:3]
        size = PictureSize(cameras.views, height, width, *self._grid)
        measured = size._replace(across=1, down=1, measured=True)  # at the pixels' centres
        if subject is None:
            self._draw(size, cameras, movers, (rgb, None))
            return
        self._device.clear(subject)
        if self._grid == (1, 1):
            self._draw(measured, cameras, movers, (rgb, subject))
        else:
            self._draw(size, cameras, movers, (rgb, None))
            self._draw(measured, cameras, movers, (None, subject))

    def _draw(
        self,
        size: PictureSize,
        cameras: DeviceViews,
        movers: Movers,
        wanted: tuple[Array | None, Array | None],
    ) -> None:
        """Draw pictures, or measure their subjects, or both."""
        if size not in self._made:
            renderer = DeviceRenderer(self._device, self._geometry, self._light)
            self._made[size] = _Made(renderer, self._new_job(size))
        made, timed = self._made[size], cameras.instant.shape[0] > 0
        # Mostly the same arrays as the last time: cutting off a dozen takes some time.
        given = *wanted, *cameras[1:]
        if len(made.given) != len(given) or not all(map(operator.is_, given, made.given)):
            made.given = given
            made.cut = _with_cameras(made.job, cameras, timed=timed)
            made.output = _cut_output(*wanted, size.views)
        falls = int(timed and cameras.falling)
        made.renderer.draw(size, made.cut, movers, made.output, falls=falls, tent=self._tent)

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


def _cut_output(rgb: Array | None, subject: Array | None, views: int) -> Output:
    """Return the outputs that are not None, of V views."""
    output = NO_OUTPUT if rgb is None else NO_OUTPUT._replace(rgb=rgb[:views])
    return output if subject is None else output._replace(subject=subject[:views])


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
