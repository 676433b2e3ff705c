"""Pictures without loss: colours, masks, classes, depth, normals as PNG files, or as arrays."""

import io

import numpy as np

from eyas.engine.core.png import png_bytes
from eyas.engine.exports.frame import Frame
from eyas.engine.exports.per_frame import PerFrameWriter
from eyas.engine.exports.writer import Files, Run
from eyas.engine.state.scene import ACTOR_OBJECT, LABELLED, LAST_PARKED

__all__ = [
    "ArrayWriter",
    "ClassWriter",
    "CleanWriter",
    "DepthWriter",
    "MaskWriter",
    "NormalWriter",
    "PngWriter",
]

_MOST = np.iinfo(np.uint16).max
_LABELLED = sorted(map(int, LABELLED))


class PngWriter(PerFrameWriter):
    """`NNNNNN.png`: the colours."""

    name = "{:06d}.png"
    wants = frozenset({"rgb"})
    files = Files(frame=(name,))

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's picture."""
        assert frame.rgb is not None
        return png_bytes(frame.rgb)


class CleanWriter(PerFrameWriter):
    """`clean/NNNNNN.png`: the colours without noise, blur, dirt and the like, of the same instant,
    pose and lens as the picture.
    """

    name = "clean/{:06d}.png"
    wants = frozenset({"clean"})
    files = Files(frame=(name,))

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's clean picture."""
        assert frame.clean is not None
        return png_bytes(frame.clean)


class MaskWriter(PerFrameWriter):
    """`masks/NNNNNN.png`: which object of the labels each pixel shows, 16 bits: 0 for none, the
    number among the actors + 1 of what moves, that is the label's id - 65535, and 65535 less the id
    of what is parked.
    """

    name = "masks/{:06d}.png"
    wants = frozenset({"object_id", "class_id"})
    files = Files(frame=(name,))

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's masks."""
        assert frame.object_id is not None
        assert frame.class_id is not None
        shown = frame.object_id
        masks = np.maximum(shown - (ACTOR_OBJECT - 1), 0)
        parked = np.isin(frame.class_id, _LABELLED) & (shown > 0) & (shown <= LAST_PARKED)
        return png_bytes(np.where(parked, _MOST - shown, masks).astype(np.uint16))


class ClassWriter(PerFrameWriter):
    """`classes/NNNNNN.png`: the `ObjectClass` of each pixel, 8 bits."""

    name = "classes/{:06d}.png"
    wants = frozenset({"class_id"})
    files = Files(frame=(name,))

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's classes."""
        assert frame.class_id is not None
        return png_bytes(frame.class_id)


class DepthWriter(PerFrameWriter):
    """`depth/NNNNNN.png`: distance along the optical axis in units of `video.depth_unit`, 16 bits;
    0 for the sky and what is too far.
    """

    name = "depth/{:06d}.png"
    wants = frozenset({"depth"})
    files = Files(frame=(name,))

    def __init__(self, run: Run) -> None:
        self._unit = run.depth_unit

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's depth."""
        assert frame.depth is not None
        units = np.maximum(np.rint(frame.depth / np.float64(self._unit)), 1.0)
        return png_bytes(np.where(units <= _MOST, units, 0.0).astype(np.uint16))


class NormalWriter(PerFrameWriter):
    """`normals/NNNNNN.png`: the surface normal of each pixel in the camera's frame, right, down and
    ahead, each from -1 to 1 as 0 to 255; all 0 for the sky.
    """

    name = "normals/{:06d}.png"
    wants = frozenset({"normal"})
    files = Files(frame=(name,))

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's normals."""
        assert frame.normal is not None
        return png_bytes(frame.normal)


class ArrayWriter(PerFrameWriter):
    """`arrays/NNNNNN.npz`: `depth` [m], `object_id` and `class_id` as the renderer has them; not
    compressed.
    """

    name = "arrays/{:06d}.npz"
    wants = frozenset({"depth", "object_id", "class_id"})
    files = Files(frame=(name,))

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's arrays."""
        assert frame.depth is not None
        assert frame.object_id is not None
        assert frame.class_id is not None
        file = io.BytesIO()
        np.savez(file, depth=frame.depth, object_id=frame.object_id, class_id=frame.class_id)
        return file.getvalue()
