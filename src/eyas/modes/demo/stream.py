"""H.264 for one viewer: each picture depends on those before it."""

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import ConfigError
from eyas.core.pyav import pyav

__all__ = ["Stream"]

ENCODER = "libx264"
_OPTIONS = {
    "preset": "ultrafast",
    "tune": "zerolatency",
    "profile": "baseline",  # every decoder gives back each picture at once
    # After the first picture no whole one is sent: nothing is ever lost on the way.
    "x264-params": "keyint=infinite:scenecut=0",
}


class Stream:
    """Codes pictures of one size; the first is whole.

    Args:
        height: Of the pictures, an even number [pixels].
        width: The same.
        factor: x264's constant rate factor; greater is smaller and blurrier.

    Raises:
        ConfigError: PyAV is not installed, or has been built without x264.
    """

    def __init__(self, height: int, width: int, factor: int) -> None:
        av = pyav("pictures: H.264")
        if ENCODER not in av.codecs_available:
            raise ConfigError(f"pictures: H.264 needs a PyAV with {ENCODER}; they go on as JPEG")
        self._av, self._colours = av, av.video.reformatter
        coder = av.CodecContext.create(ENCODER, "w")
        coder.height, coder.width, coder.pix_fmt = height, width, "yuv420p"
        coder.time_base = Fraction(1, 30)
        space, extent = self._colours.Colorspace.ITU709, self._colours.ColorRange.MPEG
        coder.colorspace, coder.color_range = space.value, extent.value
        coder.color_primaries = coder.color_trc = space.value
        coder.thread_count = 1
        coder.options = _OPTIONS | {"crf": str(factor)}
        self._coder, self._count = coder, 0

    def encode(self, rgb: NDArray[np.uint8]) -> bytes:
        """Return the next picture, shape (H, W, 3), in the format of Annex B."""
        picture = self._av.VideoFrame.from_ndarray(rgb, format="rgb24").reformat(
            format="yuv420p",
            dst_colorspace=self._colours.Colorspace.ITU709,
            dst_color_range=self._colours.ColorRange.MPEG,
        )
        picture.pts, self._count = self._count, self._count + 1
        return b"".join(bytes(packet) for packet in self._coder.encode(picture))
