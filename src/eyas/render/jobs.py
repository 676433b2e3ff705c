"""Division of the work: views, or bands of views if there are few."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from eyas.render.kernels.bundles import Job, Output
from eyas.state.draw import Picture, Views
from eyas.state.scene import ACTOR_OBJECT

__all__ = ["build_jobs", "picture_size", "write_measured"]

JOBS_PER_THREAD = 4
"""Few views are cut into bands until there are this many: sky is drawn faster than streets."""

SMALLEST_BAND = 3_500
"""Number of pixels below which cutting costs more than it gains."""


def build_jobs(views: Views, height: int, width: int, threads: int, density: float) -> Job:
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


def write_measured(job: Job, output: Output, picture: Picture) -> None:
    """Write what the bands of each view measured into a picture, where it is wanted.

    Args:
        job: The cameras and bands.
        output: What they measured.
        picture: Its boxes and pixels of subjects and actors are written.
    """
    views = len(job.eye)
    if len(output.actor):
        box, pixels = _joined(output.actor.reshape(views, -1, *output.actor.shape[1:]))
        _write(box, pixels, picture.actor_box, picture.actor_pixels)
        actor = job.subject - ACTOR_OBJECT
        known = (actor >= 0) & (actor < box.shape[1])
        actor = np.where(known, actor, 0)[:, None, None]
        box = np.where(known[:, None], np.take_along_axis(box, actor, 1)[:, 0], 0)
        pixels = np.where(known[:, None], np.take_along_axis(pixels, actor, 1)[:, 0], 0)
        _write(box, pixels, picture.subject_box, picture.subject_pixels)
    elif len(output.subject):
        box, pixels = _joined(output.subject.reshape(views, -1, 6))
        _write(box, pixels, picture.subject_box, picture.subject_pixels)


def _joined(by_band: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Return boxes, shape (V, ..., 4), and pixels, shape (V, ..., 2), of whole views.

    Args:
        by_band: See `Output.actor`, shape (V, bands, ..., 6).
    """
    pixels = by_band[..., 4:].sum(axis=1, dtype=np.int32)
    far = np.iinfo(np.int32).max
    low = np.where(by_band[..., 5:] > 0, by_band[..., :2], far).min(axis=1)
    box = np.concatenate([low, by_band[..., 2:4].max(axis=1)], axis=-1)
    return np.where(pixels[..., 1:] > 0, box, 0), pixels


def _write(
    box: NDArray[np.int32],
    pixels: NDArray[np.int32],
    box_out: NDArray[np.int32] | None,
    pixels_out: NDArray[np.int32] | None,
) -> None:
    if box_out is not None:
        box_out[:] = box
    if pixels_out is not None:
        pixels_out[:] = pixels
