"""Division of the work: views, or bands of views if there are few."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Job, Task
from eyas.engine.state.draw import Views
from eyas.engine.state.lighting import LightState

JOBS_PER_THREAD = 6
"""Few views are cut into bands until there are this many: sky is drawn faster than streets."""

SMALLEST_BAND = 7_500
"""Number of pixels below which cutting costs more than it gains: waking a second thread takes a
fifth of a picture of 84 x 84."""


class Size(NamedTuple):
    """All that decides which arrays a task has, and what is written in them but the cameras."""

    views: int
    height: int  # Height of the pictures [pixels]
    width: int  # Width of the pictures [pixels]
    across: int  # Samples along a row of each pixel
    down: int  # Samples along a column of each pixel
    until: int  # See `Task`
    falls: bool  # Whether flakes, drops and leaves are drawn
    parts: bool  # Whether each view draws some rows only, which are then one band
    threads: int  # Number of threads that share the work
    bent: bool = False  # Whether lenses bend the pictures
    timed: bool = False  # Whether the views have instants
    tent: bool = False  # Whether bytes go through the tent filter


def new_task(size: Size) -> Task:
    """Return a task without its cameras, see `set_views`."""
    views = size.views
    threads = 1 if size.parts else size.threads
    job = Job(
        picture=np.arange(views, dtype=np.int32),
        band=_bands(views, size.height, size.width, threads),
        begun=np.zeros(1, np.int64),
        eye=np.empty((views, 3)),
        axes=np.empty((views, 3, 3)),
        world=np.empty(views, np.int32),
        subject=np.empty(views, np.int32),
        light=LightState.create(views),
        instant=np.empty(views if size.timed else 0),
        focal=np.empty((views, 2)),
        lens=np.zeros(views if size.bent else 0, np.int32),
    )
    return Task(
        size.across, size.down, size.width, size.height, int(size.falls), size.until, job,
        int(size.tent and len(job.band) == views and not size.parts),
    )  # fmt: skip


def set_views(
    task: Task,  # Of the size of the views
    views: Views,  # V cameras
    density: float,  # Density of the weather's fog [1/m], for views without their own
    workers: int,  # Number of workers that begin with a band each
) -> None:
    """Write the cameras into a task, and that none of its bands is drawn."""
    job = task.job
    job.begun[0] = workers
    job.picture[:] = np.arange(len(job.picture)) if views.picture is None else views.picture
    if views.rows is not None:
        job.band[:, 1:] = views.rows
    job.eye[:] = views.position
    job.axes[:] = views.rotation.swapaxes(1, 2)
    job.world[:] = views.world
    job.subject[:] = views.subject
    calm = (1.0, 1.0, density, 0.0, 0.0)
    given: Sequence[NDArray[np.float32] | float] = calm if views.light is None else views.light
    for array, values in zip(job.light, given, strict=True):
        array[:] = values
    if views.instant is not None:
        job.instant[:] = views.instant
    job.focal[:] = views.focal(task.height, task.width)


def _bands(count: int, height: int, width: int, threads: int) -> NDArray[np.int32]:
    """Return `Job.band`."""
    bands = min(
        math.ceil(JOBS_PER_THREAD * threads / max(count, 1)),
        height * width // SMALLEST_BAND,
        height,
    )
    bands = 1 if threads == 1 or count >= JOBS_PER_THREAD * threads else max(bands, 1)
    edges = np.linspace(0, height, bands + 1).astype(np.int32)
    view = np.empty((count, bands, 3), np.int32)
    view[:, :, 0] = np.arange(count)[:, None]
    view[:, :, 1] = edges[:-1]
    view[:, :, 2] = edges[1:]
    return view.reshape(-1, 3)
