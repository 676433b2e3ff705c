"""What a picture wants to be written, and what the bands of its views measured."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Job, Output
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT

MEASURES = 10  # Numbers that are measured of a thing, see `Output.subject`.

NO_OUTPUT = Output(
    rgb=np.empty((0, 0, 0, 3), np.uint8),
    radiance=np.empty((0, 0, 0, 0), np.float32),
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
        radiance=NO_OUTPUT.radiance if picture.radiance is None else picture.radiance,
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
    if picture.radiance is not None:
        return picture.radiance.shape[2], picture.radiance.shape[3]
    raise ValueError(
        "picture: rgb, radiance, depth, object_id, class_id or normal is needed; it gives the size"
    )


def write_measured(
    job: Job,  # The cameras and bands
    output: Output,  # What they measured
    picture: Picture,  # Its boxes and pixels of subjects and actors are written
) -> None:
    """Write what the bands of each picture measured into it, where it is wanted."""
    # The jobs of a picture follow each other.
    shown = job.picture[job.band[:, 0]]
    first = np.flatnonzero(np.diff(shown, prepend=-1))
    if len(output.actor):
        actors = _joined(output.actor, first)
        _write(actors, picture.actor_box, picture.actor_pixels, picture.actor_visible_box)
        actor = job.subject[job.band[first, 0]] - ACTOR_OBJECT
        known = (actor >= 0) & (actor < output.actor.shape[1])
        actor = np.where(known, actor, 0)[:, None, None]
        subject = _Measured(
            *(np.where(known[:, None], np.take_along_axis(of, actor, 1)[:, 0], 0) for of in actors)
        )
        _write(subject, picture.subject_box, picture.subject_pixels, picture.subject_visible_box)
    elif len(output.subject):
        subject = _joined(output.subject, first)
        _write(subject, picture.subject_box, picture.subject_pixels, picture.subject_visible_box)


class _Measured(NamedTuple):
    """What is measured of things in whole pictures."""

    box: NDArray[np.int32]  # Shape (P, ..., 4).
    pixels: NDArray[np.int32]  # Shape (P, ..., 2).
    visible_box: NDArray[np.int32]  # Shape (P, ..., 4).


def _joined(
    by_band: NDArray[np.int32],  # What was measured in each of J bands, shape (J, ..., MEASURES)
    first: NDArray[np.int64],  # The first band of each picture, shape (P,)
) -> _Measured:
    """Return what was measured in pictures."""
    box, pixels, visible = by_band[..., :4], by_band[..., 4:6], by_band[..., 6:]
    return _Measured(
        _around(box, pixels[..., 1:], first),
        np.add.reduceat(pixels, first, axis=0, dtype=np.int32),
        _around(visible, pixels[..., :1], first),
    )


def _around(
    box: NDArray[np.int32], pixels: NDArray[np.int32], first: NDArray[np.int64]
) -> NDArray[np.int32]:
    """Return the box around those of the bands that have pixels."""
    low = np.where(pixels > 0, box[..., :2], np.iinfo(np.int32).max)
    joined = np.concatenate(
        [np.minimum.reduceat(low, first, axis=0), np.maximum.reduceat(box[..., 2:], first, axis=0)],
        axis=-1,
    )
    return np.where(np.maximum.reduceat(pixels, first, axis=0) > 0, joined, 0)


def _write(measured: _Measured, *wanted: NDArray[np.int32] | None) -> None:
    for array, out in zip(measured, wanted, strict=True):
        if out is not None:
            out[:] = array
