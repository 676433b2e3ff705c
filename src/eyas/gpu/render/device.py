"""Pictures drawn by a device, such as a graphics processor, into its own memory."""

from typing import Any, NamedTuple

import numpy as np

from eyas.engine.render.kernels.bundles import Geometry, Job, Light, Movers, Output, Scratch, Task
from eyas.engine.render.kernels.visibility.clusters import CLUSTER
from eyas.engine.render.kernels.visibility.fill import SPAN_ROWS
from eyas.engine.render.kernels.visibility.items import ITEM_COLUMNS
from eyas.engine.render.kernels.visibility.key import MOST_INSTANCES
from eyas.engine.render.kernels.visibility.triangles import TRIANGLE_ROWS
from eyas.engine.state.draw import DrawStage
from eyas.gpu.render.stages import (
    ROWS,
    Shares,
    cast_lights,
    fill_triangles,
    filter_columns,
    filter_rows,
    find_triangles,
    list_views,
    look_for_clusters,
    shade,
    tell_facts,
)
from eyas.lanes import ParallelCall
from eyas.lanes.device import Device
from eyas.lanes.vector import WIDTH

MEMBERS, MOST_MEMBERS = 4, 128
"""Workers that share a view at least and at most: a warp of a graphics processor is four times
`WIDTH` threads."""

FILLERS = 64  # Workers that share the rows of its triangles at least

SEEKING, SHADING = 16384, 4096
"""Warps that keep a card busy while some wait: fewer views are shared by more workers. Those that
seek triangles have more or less to do, those that shade a view's rows about the same."""

CLUSTERS = 2048
"""Clusters of eight triangles of a view that are kept for those who project them; more are
projected where they are found."""

RECORDS_PER_ROW, UNITS_PER_ROW = 32, 256
"""Triangles of a view that are kept for the fillers, and their rows, for each row of samples; more
are filled where they are found."""

ITEMS = 512
"""Chunks and instances of a view that are kept for those who look for their clusters; more are
drawn where they are listed."""


class PictureSize(NamedTuple):
    """What decides how much memory pictures need while they are drawn."""

    views: int
    height: int  # [pixels]
    width: int  # [pixels]
    across: int = 1  # Samples along a row of each pixel
    down: int = 1  # Samples along a column of each pixel
    measured: bool = False  # Whether subjects or actors are measured

    @property
    def members(self) -> tuple[int, int]:
        """Workers that share the finding of triangles in a view, and its rows."""
        rows = self.height * self.down
        return _members(self.views, SEEKING), min(_members(self.views, SHADING), _power_below(rows))


class DeviceRenderer:
    """Draws a scene, and what moves in it, for many views at once.

    The bytes are those of `eyas.engine.render.renderer.CpuRenderer`.

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
        size: PictureSize,  # Size and number of the pictures
        job: Job,  # The cameras; `band` is `whole_views`
        movers: Movers,  # The moving things
        output: Output,  # Where to
        *,
        falls: int = 0,  # See `Task`
        until: DrawStage = DrawStage.SHADING,  # Last stage to run, to measure the cost of each
        tent: bool,  # See `Views`
    ) -> None:
        """Draw views into the arrays of `output` that are not empty, all on the device."""
        device, slots = self._device, movers.part.shape[1]
        key = size, slots
        if key not in self._scratch:
            scratch = self._new_scratch(size, slots)
            shares = Shares(size.views, MEMBERS, device.zeros(size.views, np.int32))
            few, many = size.members
            counts = {1, MEMBERS, few, many, max(FILLERS, many)}
            of = {n: device.held(shares._replace(members=n)) for n in counts}
            self._scratch = {key: (scratch, device.held(scratch), of)}
        scratch, held, of = self._scratch[key]
        task = Task(size.across, size.down, size.width, size.height, falls, int(until), job)
        bundles = (*self._held, held, device.held(movers), device.held(output), device.held(task))
        few, many = size.members
        device.clear(scratch.key)
        device.clear(scratch.recorded)
        device.clear(scratch.found)

        def launch(stage: ParallelCall, members: int) -> None:
            workers = size.views * members
            device.launch(stage, workers, of[members], *bundles, threads=WIDTH)

        launch(list_views, MEMBERS)
        launch(look_for_clusters, few)
        launch(find_triangles, few)
        launch(fill_triangles, max(FILLERS, many))
        coloured = len(output.rgb) > 0 or len(output.radiance) > 0
        if coloured and until > DrawStage.RASTERISING:
            launch(cast_lights, many)
            launch(shade, many)
        if tent and len(output.rgb) > 0 and until == DrawStage.SHADING:
            pieces = size.views * -(-size.height // ROWS) * -(-size.width // WIDTH)
            device.launch(filter_rows, pieces, held, bundles[4], threads=WIDTH)
            device.launch(filter_columns, pieces, held, bundles[4], threads=WIDTH)
        measured = len(output.subject) + len(output.actor) > 0
        if measured:
            device.clear(scratch.alone)
            launch(tell_facts, 1)
        elif any(
            len(one) for one in (output.depth, output.object_id, output.class_id, output.normal)
        ):
            launch(tell_facts, many)

    def _new_scratch(self, size: PictureSize, slots: int) -> Scratch:
        """Return working memory for all views."""
        device, views, (few, many) = self._device, size.views, size.members
        chunks, fixtures = len(self._geometry.chunk_range), len(self._geometry.fixture_object)
        instances = min(fixtures + slots * (2 if size.measured else 1), MOST_INSTANCES)
        plane = (views, size.height * size.down, (size.width + -size.width % WIDTH) * size.across)
        none = (views, 0, 0)
        listed = chunks + instances
        records = -(-RECORDS_PER_ROW * plane[1] // WIDTH) * WIDTH
        swaying = instances if len(self._light.sway) else 0
        shade_bytes = device.empty((*plane, 4), np.uint8)
        return Scratch(
            key=device.zeros(plane, np.int64),
            alone=device.zeros(plane if size.measured else none, np.int64),
            shade=shade_bytes,
            drawn=device.empty((views, instances, 2), np.int32),
            mesh=device.empty((views, instances), np.int32),
            tiles=device.empty((views, 1, 1), np.float32),
            order=device.empty((views, listed), np.int64),
            triangle=device.empty((views * few, TRIANGLE_ROWS, CLUSTER), np.float64),
            polygon=device.zeros((views * few, 15, CLUSTER), np.float64),
            span=device.empty((views * max(FILLERS, few, many), SPAN_ROWS, WIDTH), np.int32),
            word=device.empty(none, np.uint32),
            bent_key=device.empty(none, np.int64),
            bent_shade=device.empty((*none, 4), np.uint8),
            leaning=device.empty((views, swaying, 3, 4), np.float32),
            item=device.empty((views, min(listed, ITEMS), ITEM_COLUMNS), np.float64),
            item_row=device.empty((views, min(listed, ITEMS) + 1), np.int64),
            seen=device.empty((views, CLUSTERS), np.int64),
            found=device.zeros((views, 2), np.int64),
            record=device.empty((views, records // WIDTH, TRIANGLE_ROWS, CLUSTER), np.float64),
            record_shown=device.empty((views, records, 2), np.int64),
            unit=device.empty((views, UNITS_PER_ROW * plane[1]), np.int32),
            recorded=device.zeros((views, 1), np.int64),
            line=device.empty((0, 0, 0), np.uint8),
            total=device.empty((0, 0, 0, 0), np.uint32),
            bent_tile=device.empty((0, 0, 4), np.int32),
        )


def _power_below(number: int) -> int:
    """Return the largest power of two that is not above a number."""
    return 1 << (number.bit_length() - 1)


def _members(views: int, warps: int) -> int:
    """Return how many workers share a view, a power of two, so that there are so many warps."""
    wanted = _power_below(max(MEMBERS * warps // views, 1))
    return min(max(wanted, MEMBERS), MOST_MEMBERS)
