"""What a picture wants to be written, and what the bands of its views measured."""

import numpy as np
from numpy.typing import NDArray

from eyas.render.kernels.bundles import Job, Output
from eyas.state.draw import Picture
from eyas.state.scene import ACTOR_OBJECT

__all__ = ["NO_OUTPUT", "measured_alone", "picture_size", "wanted_output", "write_measured"]

NO_OUTPUT = Output(
    rgb=np.empty((0, 0, 0, 3), np.uint8),
    depth=np.empty((0, 0, 0), np.float32),
    object_id=np.empty((0, 0, 0), np.int32),
    class_id=np.empty((0, 0, 0), np.uint8),
    subject=np.empty((0, 6), np.int32),
    actor=np.empty((0, 0, 6), np.int32),
)


def wanted_output(picture: Picture) -> Output:
    """Return the wanted arrays; those of measurements are only flags, jobs get their own.

    If all actors are measured, the subjects are among them.
    """
    actors = picture.actor_box if picture.actor_pixels is None else picture.actor_pixels
    subject = picture.subject_box is not None or picture.subject_pixels is not None
    return Output(
        rgb=NO_OUTPUT.rgb if picture.rgb is None else picture.rgb,
        depth=NO_OUTPUT.depth if picture.depth is None else picture.depth,
        object_id=NO_OUTPUT.object_id if picture.object_id is None else picture.object_id,
        class_id=NO_OUTPUT.class_id if picture.class_id is None else picture.class_id,
        subject=np.empty((1, 6), np.int32) if subject and actors is None else NO_OUTPUT.subject,
        actor=NO_OUTPUT.actor if actors is None else np.empty((1, actors.shape[1], 6), np.int32),
    )


def measured_alone(output: Output, jobs: int) -> Output:
    """Return an output with measurements, which are wanted, of so many jobs."""
    return output._replace(
        subject=np.zeros((jobs if len(output.subject) else 0, 6), np.int32),
        actor=np.zeros((jobs if len(output.actor) else 0, *output.actor.shape[1:]), np.int32),
    )


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
