"""Pictures as JPEG files."""

from eyas.engine.core.jpeg import jpeg_bytes
from eyas.engine.exports.frame import Frame
from eyas.engine.exports.per_frame import PerFrameWriter
from eyas.engine.exports.writer import Files, Run

__all__ = ["JpegWriter"]


class JpegWriter(PerFrameWriter):
    """`NNNNNN.jpeg` for each frame; the same picture gives the same bytes."""

    name = "{:06d}.jpeg"
    wants = frozenset({"rgb"})
    files = Files(frame=(name,))

    def __init__(self, run: Run) -> None:
        self._quality = run.jpeg_quality

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's picture."""
        assert frame.rgb is not None
        return jpeg_bytes(frame.rgb, self._quality)
