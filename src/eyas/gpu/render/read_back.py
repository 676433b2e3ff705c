"""Pictures drawn by a device and read back: the device in the place of this processor."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.render.jobs import Size, new_task, set_views
from eyas.engine.render.kernels.bundles import Job, Movers, Output
from eyas.engine.render.outputs import (
    NO_OUTPUT,
    measured_alone,
    picture_size,
    wanted_output,
    write_measured,
)
from eyas.engine.render.renderer import GRIDS, CpuRenderer
from eyas.engine.state.draw import DrawList, DrawStage, Picture, Views
from eyas.engine.state.lighting import LightState
from eyas.gpu.render.device import DeviceRenderer, PictureSize
from eyas.lanes.device import Device


class UploadedViews(NamedTuple):
    """Cameras and moving things on a device, and what is to be drawn of them there."""

    size: PictureSize
    job: Job
    movers: Movers
    output: Output
    falls: int
    tent: bool


class ReadBackRenderer:
    """Draws on a device, into pictures of this processor; see `eyas.engine.state.draw.Renderer`.

    It is for comparisons and timings: programs leave pictures on the device. Lenses, and pictures
    of which views draw some rows, are refused.

    Args:
        device: The device.
        renderer: What draws the same here.
    """

    def __init__(self, device: Device, renderer: CpuRenderer) -> None:
        self._device, self._near = device, renderer
        geometry, light = renderer.packed
        self._density = float(light.weather.fog_density)
        self._renderer = DeviceRenderer(device, geometry, light)

    def part_reach(self) -> NDArray[np.float64]:
        """See `Renderer`."""
        return self._near.part_reach()

    def influence(self, reach: NDArray[np.float64]) -> NDArray[np.float64]:
        """See `Renderer`."""
        return self._near.influence(reach)

    def draw(
        self,
        views: Views,
        draw_list: DrawList,
        picture: Picture,
        samples: int = 1,
        until: DrawStage = DrawStage.SHADING,
    ) -> None:
        """Draw views into the arrays of a picture that are not None, see `Renderer`."""
        output = wanted_output(picture)
        colours = NO_OUTPUT._replace(rgb=output.rgb, radiance=output.radiance)
        for part in _alone(colours):
            self._draw(views, draw_list, picture, part, samples, until)
        facts = output._replace(rgb=NO_OUTPUT.rgb, radiance=NO_OUTPUT.radiance)
        if _arrays(facts):
            self._draw(views, draw_list, picture, facts, 1, until)

    def _draw(
        self,
        views: Views,
        draw_list: DrawList,
        picture: Picture,
        output: Output,
        samples: int,
        until: DrawStage,
    ) -> None:
        device = self._device
        output = measured_alone(output, len(views.position))
        given = self.uploaded(views, draw_list, picture_size(picture), output, samples)
        self.draw_uploaded(given, until)
        for name, array in _arrays(output).items():
            array[:] = device.read(getattr(given.output, name))
        if given.size.measured:
            here = _job(views, picture_size(picture), samples, self._density)
            write_measured(here, output, picture)

    def uploaded(
        self,
        views: Views,  # V cameras
        draw_list: DrawList,  # The moving things
        size: tuple[int, int],  # Height and width of the pictures [pixels]
        output: Output,  # What is wanted: arrays of these shapes and types are made on the device
        samples: int = 1,  # Colour samples per pixel, 1, 2 or 4
    ) -> UploadedViews:
        """Return views and moving things on the device, to be drawn there."""
        if samples not in GRIDS:
            raise ConfigError(f"camera.samples: {samples} is not allowed; allowed: 1, 2, 4")
        if views.lens is not None or views.rows is not None or views.picture is not None:
            raise ConfigError("device: lenses, and views of some rows of pictures, are not drawn")
        device, count = self._device, len(views.position)
        measured = len(output.subject) + len(output.actor) > 0
        movers = Movers(*(device.upload(getattr(draw_list, name)) for name in Movers._fields))
        return UploadedViews(
            PictureSize(count, *size, *GRIDS[samples], measured),
            _sent(_job(views, size, samples, self._density), device.upload),
            movers,
            Output(*(device.zeros(array.shape, array.dtype) for array in output)),
            int(views.instant is not None and views.falling),
            views.filters(samples),
        )

    def draw_uploaded(
        self,
        given: UploadedViews,  # From `uploaded`
        until: DrawStage = DrawStage.SHADING,  # Last stage to run
    ) -> None:
        """Draw into `given.output`; the device may be at it when this returns."""
        size, job, movers, output, falls, tent = given
        self._renderer.draw(size, job, movers, output, falls=falls, until=until, tent=tent)


def _arrays(output: Output) -> dict[str, NDArray[Any]]:
    """Return what is wanted, by name."""
    return {name: array for name, array in output._asdict().items() if len(array)}


def _alone(colours: Output) -> list[Output]:
    """Return outputs that want bytes or radiance, not both: a canvas holds one of them."""
    return [NO_OUTPUT._replace(**{name: array}) for name, array in _arrays(colours).items()]


def _job(views: Views, size: tuple[int, int], samples: int, density: float) -> Job:
    """Return the cameras for kernels, each with a whole view; `density` see `set_views`."""
    timed, falls = views.instant is not None, views.instant is not None and views.falling
    height, width = size
    whole = Size(
        len(views.position), height, width, *GRIDS[samples], int(DrawStage.SHADING), falls,
        parts=False, threads=1, timed=timed,
    )  # fmt: skip
    task = new_task(whole)
    set_views(task, views, density, 1)
    return task.job


def _sent(job: Job, upload: Callable[[NDArray[Any]], Any]) -> Job:
    """Return a job whose arrays are on the device."""
    sent: dict[str, Any] = {
        name: LightState(*map(upload, part)) if isinstance(part, LightState) else upload(part)
        for name, part in job._asdict().items()
    }
    return Job(**sent)
