"""What a picture wants to be written, and what the bands of its views measured."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.render.kernels.bundles import Job, Output
from eyas.state.draw import Picture
from eyas.state.scene import ACTOR_OBJECT

__all__ = ["NO_OUTPUT", "measured_alone", "picture_size", "wanted_output", "write_measured"]

MEASURES = 10
"""Numbers that are measured of a thing, see `Output.subject`."""

NO_OUTPUT = Output(
    rgb=np.empty((0, 0, 0, 3), np.uint8),
    depth=np.empty((0, 0, 0), np.float32),
    object_id=np.empty((0, 0, 0), np.int32),
    class_id=np.empty((0, 0, 0), np.uint8),
    normal=np.empty((0, 0, 0, 3), np.uint8),
    subject=np.empty((0, MEASURES), np.int32),
    actor=np.empty((0, 0, MEASURES), np.int32),
)


def wanted_output(picture: Picture) -> Output:
    """Return the wanted arrays; those of measurements are only flags, jobs get their own.

    If all actors are measured, the subjects are among them.
    """
    of_actors = (picture.actor_box, picture.actor_pixels, picture.actor_visible_box)
    actors = next((array for array in of_actors if array is not None), None)
    of_subject = (picture.subject_box, picture.subject_pixels, picture.subject_visible_box)
    subject = any(array is not None for array in of_subject)
    return Output(
        rgb=NO_OUTPUT.rgb if picture.rgb is None else picture.rgb,
        depth=NO_OUTPUT.depth if picture.depth is None else picture.depth,
        object_id=NO_OUTPUT.object_id if picture.object_id is None else picture.object_id,
        class_id=NO_OUTPUT.class_id if picture.class_id is None else picture.class_id,
        normal=NO_OUTPUT.normal if picture.normal is None else picture.normal,
        subject=np.empty((1, MEASURES), np.int32)
        if subject and actors is None
        else NO_OUTPUT.subject,
        actor=NO_OUTPUT.actor
        if actors is None
        else np.empty((1, actors.shape[1], MEASURES), np.int32),
    )


def measured_alone(output: Output, jobs: int) -> Output:
    """Return an output with measurements, which are wanted, of so many jobs."""
    return output._replace(
        subject=np.zeros((jobs if len(output.subject) else 0, MEASURES), np.int32),
        actor=np.zeros((jobs if len(output.actor) else 0, *output.actor.shape[1:]), np.int32),
    )


def picture_size(picture: Picture) -> tuple[int, int]:
    """Return height and width [pixels].

    Raises:
        ValueError: No array with pixels is wanted, so the size is unknown.
    """
    planes = (picture.rgb, picture.depth, picture.object_id, picture.class_id, picture.normal)
    for plane in planes:
        if plane is not None:
            return plane.shape[1], plane.shape[2]
    raise ValueError(
        "picture: rgb, depth, object_id, class_id or normal is needed; it gives the size"
    )


def write_measured(job: Job, output: Output, picture: Picture) -> None:
    """Write what the bands of each view measured into a picture, where it is wanted.

    Args:
        job: The cameras and bands.
        output: What they measured.
        picture: Its boxes and pixels of subjects and actors are written.
    """
    views = len(job.eye)
    if len(output.actor):
        actors = _joined(output.actor.reshape(views, -1, *output.actor.shape[1:]))
        _write(actors, picture.actor_box, picture.actor_pixels, picture.actor_visible_box)
        actor = job.subject - ACTOR_OBJECT
        known = (actor >= 0) & (actor < output.actor.shape[1])
        actor = np.where(known, actor, 0)[:, None, None]
        subject = _Measured(
            *(np.where(known[:, None], np.take_along_axis(of, actor, 1)[:, 0], 0) for of in actors)
        )
        _write(subject, picture.subject_box, picture.subject_pixels, picture.subject_visible_box)
    elif len(output.subject):
        subject = _joined(output.subject.reshape(views, -1, MEASURES))
        _write(subject, picture.subject_box, picture.subject_pixels, picture.subject_visible_box)


class _Measured(NamedTuple):
    """What is measured of things in whole views."""

    box: NDArray[np.int32]
    """Shape (V, ..., 4)."""
    pixels: NDArray[np.int32]
    """Shape (V, ..., 2)."""
    visible_box: NDArray[np.int32]
    """Shape (V, ..., 4)."""


def _joined(by_band: NDArray[np.int32]) -> _Measured:
    """Return what was measured in the bands of views, shape (V, bands, ..., MEASURES)."""
    box, pixels, visible = by_band[..., :4], by_band[..., 4:6], by_band[..., 6:]
    return _Measured(
        _around(box, pixels[..., 1:]),
        pixels.sum(axis=1, dtype=np.int32),
        _around(visible, pixels[..., :1]),
    )


def _around(box: NDArray[np.int32], pixels: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the box around those of the bands that have pixels."""
    low = np.where(pixels > 0, box[..., :2], np.iinfo(np.int32).max).min(axis=1)
    joined = np.concatenate([low, box[..., 2:].max(axis=1)], axis=-1)
    return np.where((pixels > 0).any(axis=1), joined, 0)


def _write(measured: _Measured, *wanted: NDArray[np.int32] | None) -> None:
    for array, out in zip(measured, wanted, strict=True):
        if out is not None:
            out[:] = array
