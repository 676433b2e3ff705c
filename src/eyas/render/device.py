"""Pictures drawn by a device, such as a graphics processor, into its own memory."""

from typing import Any, NamedTuple

import numpy as np

from eyas.core.errors import ConfigError
from eyas.lanes.device import Device
from eyas.lanes.vector import WIDTH
from eyas.render.kernels.bundles import Geometry, Job, Light, Movers, Output, Scratch, Task
from eyas.render.kernels.stages import (
    Shares,
    cast_lights,
    fill_triangles,
    find_triangles,
    shade,
    tell_facts,
)
from eyas.render.kernels.visibility.clusters import CLUSTER
from eyas.render.kernels.visibility.fill import SPAN_ROWS
from eyas.render.kernels.visibility.key import MOST_INSTANCES
from eyas.render.kernels.visibility.triangles import TRIANGLE_ROWS
from eyas.render.outputs import NO_OUTPUT
from eyas.state.draw import DrawStage
from eyas.state.lighting import LightState

__all__ = ["DeviceRenderer", "PictureSize"]

MEMBERS = 4
"""Workers that share a view: a warp of a graphics processor is four times `WIDTH` threads."""

FILLERS = 32
"""Workers that share the rows of its triangles."""

RECORDS, UNITS = 2048, 4096
"""Triangles, and eights of their rows, that are kept for them; more are filled where they are found.
"""

_INSTANCES = 2048
"""Instances that a view shows at most."""


class PictureSize(NamedTuple):
    """What decides how much memory pictures need while they are drawn."""

    views: int
    height: int
    """[pixels]"""
    width: int
    """[pixels]"""
    across: int = 1
    """Samples along a row of each pixel."""
    down: int = 1
    """Samples along a column of each pixel."""
    measured: bool = False
    """Whether subjects or actors are measured."""


class DeviceRenderer:
    """Draws a scene, and what moves in it, for many views at once.

    The bytes are those of `eyas.render.renderer.CpuRenderer`.

    Args:
        device: The device.
        geometry: Everything that can be drawn.
        light: Light and air.
    """

    def __init__(self, device: Device, geometry: Geometry, light: Light) -> None:
        self._device = device
        self._geometry, self._light = geometry, light
        self._held = device.held(geometry), device.held(light)
        self._scratch: dict[tuple[PictureSize, int], Any] = {}

    def draw(
        self,
        size: PictureSize,
        job: Job,
        movers: Movers,
        output: Output,
        *,
        falls: int = 0,
        until: DrawStage = DrawStage.SHADING,
    ) -> None:
        """Draw views into the arrays of `output` that are not empty, all on the device.

        Args:
            size: Size and number of the pictures.
            job: The cameras; `band` is `whole_views`.
            movers: The moving things.
            output: Where to.
            falls: See `Task`.
            until: Last stage to run, to measure the cost of each.
        """
        device, slots = self._device, movers.part.shape[1]
        key = size, slots
        if key not in self._scratch:
            scratch = self._new_scratch(size, slots)
            shares = Shares(size.views, MEMBERS, device.zeros(size.views, np.int32))
            shared = [device.held(shares._replace(members=n)) for n in (1, MEMBERS, FILLERS)]
            self._scratch = {key: (scratch, device.held(scratch), shared)}
        scratch, held, (alone, shared, many) = self._scratch[key]
        task = Task(
            size.across, size.down, size.width, size.height, falls, int(until), job
        )
        bundles = (*self._held, held, device.held(movers), device.held(output), device.held(task))
        workers = size.views * MEMBERS
        device.clear(scratch.key)
        device.clear(scratch.recorded)
        device.launch(find_triangles, workers, shared, *bundles, threads=WIDTH)
        device.launch(fill_triangles, size.views * FILLERS, many, *bundles, threads=WIDTH)
        coloured = len(output.rgb) > 0 or len(output.radiance) > 0
        if coloured and until > DrawStage.RASTERISING:
            device.launch(cast_lights, workers, shared, *bundles, threads=WIDTH)
            device.launch(shade, workers, shared, *bundles, threads=WIDTH)
        measured = len(output.subject) + len(output.actor) > 0
        if measured:
            device.clear(scratch.alone)
            device.launch(tell_facts, size.views, alone, *bundles, threads=WIDTH)
        elif any(map(len, (output.depth, output.object_id, output.class_id, output.normal))):
            device.launch(tell_facts, workers, shared, *bundles, threads=WIDTH)

    def _new_scratch(self, size: PictureSize, slots: int) -> Scratch:
        """Return working memory for all views."""
        device, views = self._device, size.views
        chunks, fixtures = len(self._geometry.chunk_range), len(self._geometry.fixture_object)
        instances = min(fixtures + slots * (2 if size.measured else 1), _INSTANCES)
        if instances > MOST_INSTANCES:
            raise ConfigError(f"device: {instances} instances; allowed: {MOST_INSTANCES}")
        plane = (
            views,
            size.height * size.down,
            (size.width + -size.width % WIDTH) * size.across,
        )
        none = (views, 0, 0)
        swaying = instances if len(self._light.sway) else 0
        shade_bytes = device.empty((*plane, 4), np.uint8)
        return Scratch(
            key=device.zeros(plane, np.int64),
            alone=device.zeros(plane if size.measured else none, np.int64),
            shade=shade_bytes,
            drawn=device.empty((views, instances, 2), np.int32),
            mesh=device.empty((views, instances), np.int32),
            tiles=device.empty((views, 1, 1), np.float32),
            order=device.empty((views, chunks + instances), np.int64),
            triangle=device.empty((views * FILLERS, TRIANGLE_ROWS, CLUSTER), np.float64),
            polygon=device.zeros((views * FILLERS, 15, CLUSTER), np.float64),
            span=device.empty((views * FILLERS, SPAN_ROWS, WIDTH), np.int32),
            word=device.empty(none, np.uint32),
            bent_key=device.empty(none, np.int64),
            bent_shade=device.empty((*none, 4), np.uint8),
            leaning=device.empty((views, swaying, 3, 4), np.float32),
            record=device.empty((views, RECORDS // WIDTH, TRIANGLE_ROWS, CLUSTER), np.float64),
            record_shown=device.empty((views, RECORDS, 2), np.int64),
            unit=device.empty((views, UNITS), np.int32),
            recorded=device.zeros((views, 1), np.int64),
            bent_tile=device.empty((0, 0, 4), np.int32),
        )
