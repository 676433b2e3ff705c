"""Division of the work: views, or bands of views if there are few."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from eyas.render.kernels.bundles import Job
from eyas.state.draw import Picture, Views

__all__ = ["build_jobs", "picture_size", "write_subject"]

JOBS_PER_THREAD = 4
"""Few views are cut into bands until there are this many: sky is drawn faster than streets."""

SMALLEST_BAND = 3_500
"""Number of pixels below which cutting costs more than it gains."""


def build_jobs(
    views: Views, height: int, width: int, threads: int, density: float
) -> Job:
    """Return the cameras and the bands to draw.

    Args:
        views: V cameras.
        height: Height of the pictures [pixels].
        width: Width of the pictures [pixels].
        threads: Number of threads that share the work.
        density: Density of the weather's fog [1/m], for views without their own.
    """
    band = _bands(len(views.position), height, width, threads)
    return Job(
        band=band,
        begun=np.array([min(threads, len(band))], np.int64),
        eye=np.ascontiguousarray(views.position, np.float64),
        axes=np.ascontiguousarray(np.swapaxes(views.rotation, 1, 2), np.float64),
        world=np.ascontiguousarray(views.world, np.int32),
        subject=np.ascontiguousarray(views.subject, np.int32),
        light=_light_of(views, density),
        instant=np.array([] if views.instant is None else views.instant, np.float64),
        focal=views.focal(height, width),
    )


@lru_cache(maxsize=8)  # saves a fifth of a small picture's cost outside the kernels
def _bands(count: int, height: int, width: int, threads: int) -> NDArray[np.int32]:
    """Return `Job.band`, which must not be modified."""
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


def _light_of(views: Views, density: float) -> NDArray[np.float32]:
    if views.light is not None:
        return np.ascontiguousarray(views.light, np.float32)
    light = np.ones((len(views.position), 3), np.float32)
    light[:, 2] = density
    return light


def picture_size(picture: Picture) -> tuple[int, int]:
    """Return height and width [pixels].

    Raises:
        ValueError: No array with pixels is wanted, so the size is unknown.
    """
    for plane in (picture.rgb, picture.depth, picture.object_id, picture.class_id):
        if plane is not None:
            return plane.shape[1], plane.shape[2]
    raise ValueError("picture: rgb, depth, object_id or class_id is needed; it gives the size")


def write_subject(bands: NDArray[np.int32], measured: NDArray[np.int32], picture: Picture) -> None:
    """Combine the measurements from the bands of each view.

    Args:
        bands: From `Job.band`.
        measured: From `Output.subject`.
        picture: Its subject boxes and pixel counts are written, if wanted.
    """
    views = int(bands[-1, 0]) + 1 if len(bands) else 0
    by_view = measured.reshape(views, -1, 6)
    if picture.subject_box is not None:
        far = np.iinfo(np.int32).max
        low = np.where(by_view[:, :, 5:] > 0, by_view[:, :, :2], far).min(axis=1)
        high = by_view[:, :, 2:4].max(axis=1)
        box = np.concatenate([low, high], axis=1)
        picture.subject_box[:] = np.where(by_view[:, :, 5].sum(axis=1, keepdims=True) > 0, box, 0)
    if picture.subject_pixels is not None:
        picture.subject_pixels[:] = by_view[:, :, 4:].sum(axis=1)
