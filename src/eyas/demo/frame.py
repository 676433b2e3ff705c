"""Frames, and how each viewer gets them coded: as JPEG or H.264, by what its line can take."""

import io
import json
import struct
import threading
from fractions import Fraction
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from eyas.engine.core.codecs.pyav import pyav
from eyas.engine.core.errors import ConfigError

Coding = Literal["auto", "jpeg", "h264"]

IN_FLIGHT = 2  # Largest number of frames that a viewer has not acknowledged

FACTORS = (23, 28, 33)
"""x264's constant rate factors; flying at 640 x 360 pixels, 15, 6 and 3 kB for each picture."""
_RANGES: dict[Coding, tuple[int, int]] = {
    "auto": (0, len(FACTORS)),
    "jpeg": (0, 0),
    "h264": (1, len(FACTORS)),
}

WANTED = 25.0
"""Frames that should get through in a second. If fewer do, the line is to blame if it takes longer
for each than the time between them."""
EASY = 0.024  # A line that takes less time for a frame may have room for larger pictures [s]
PERIOD = 2.0  # Time from one decision to the next [s]
PATIENCE = 5  # Easy periods after which larger pictures are tried; it doubles each time
HELP = 1.3  # If smaller pictures do not shorten the time by this factor, no smaller ones will
PAUSE = 60.0  # After that, for how long smaller pictures are not tried [s]
SETTLING = 4
"""Frames after a change that do not count: those on their way, and the first, which is whole."""


class CodingChoice:
    """Measures the line of one viewer.

    Attributes:
        level: 0: JPEG; k: H.264 with the k-th of `FACTORS`.

    Args:
        now: The time [s].
    """

    def __init__(self, now: float) -> None:
        self.choose("jpeg", now)

    def choose(self, coding: Coding, now: float) -> None:
        """Let the viewer choose; `auto` begins with JPEG."""
        self._lowest, self._highest = _RANGES[coding]
        self.level = self._lowest
        self._patience, self._easy = PATIENCE, 0
        self._before: float | None = None
        self._paused_until = now
        self._settling = SETTLING
        self._begin(now)

    def _begin(self, now: float) -> None:
        self._begun, self._taken, self._count = now, 0.0, 0

    def arrive(
        self,
        taken: float,  # Time from sending the frame, without what the page has taken for it [s]
        now: float,  # The time [s]
    ) -> None:
        """Take an answer to a frame; decide anew from time to time."""
        if self._settling > 0:
            self._settling -= 1
            self._begin(now)
            return
        self._taken, self._count = self._taken + taken, self._count + 1
        if now >= self._begun + PERIOD:
            before = self.level
            rate = self._count / (now - self._begun)
            self._decide(self._taken / self._count, rate, now)
            self._settling = SETTLING if self.level != before else 0
            self._begin(now)

    def _decide(self, taken: float, rate: float, now: float) -> None:
        self._easy = self._easy + 1 if taken < EASY else 0
        if rate >= WANTED or taken <= 1.0 / WANTED:
            self._before = None
            if self._easy >= self._patience and self.level > self._lowest:
                self.level -= 1
                self._easy, self._patience = 0, 2 * self._patience
        elif self._before is not None and HELP * taken > self._before:
            # The way is long: no size of pictures mends that.
            self.level -= 1
            self._before, self._paused_until = None, now + PAUSE
        elif now >= self._paused_until and self.level < self._highest:
            self.level += 1
            self._before = taken


ENCODER = "libx264"
_OPTIONS = {
    "preset": "ultrafast",
    "tune": "zerolatency",
    "profile": "baseline",  # every decoder gives back each picture at once
    # After the first picture no whole one is sent: nothing is ever lost on the way.
    "x264-params": "keyint=infinite:scenecut=0",
}


class Stream:
    """Codes pictures of one size, with an even height; the first is whole.

    Raises:
        MissingExtraError: PyAV is not installed.
        ConfigError: It has been built without x264.
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


QUALITY = 82  # JPEG quality: 640 x 360 pixels take about 45 kB


class DemoFrame:
    """A frame to send; each viewer gets the picture as it can take it.

    Attributes:
        number: From 1.
        state: What is told beside the picture, as a JSON object.
        rgb: The picture, shape (H, W, 3).

    Args:
        number: As above.
        state: As above, with at least one entry.
        rgb: As above; it is copied.
    """

    def __init__(self, number: int, state: dict[str, Any], rgb: NDArray[np.uint8]) -> None:
        self.number, self.rgb = number, rgb.copy()
        self.state = json.dumps(state, separators=(",", ":")).encode()
        self._jpeg: bytes | None = None
        self._coding = threading.Lock()

    def jpeg(self) -> bytes:
        """Return the picture as JPEG; it is coded once for all viewers."""
        with self._coding:
            if self._jpeg is None:
                picture = io.BytesIO()
                Image.fromarray(self.rgb).save(picture, "JPEG", quality=QUALITY)
                self._jpeg = picture.getvalue()
            return self._jpeg


def packed(frame: DemoFrame, kind: str, picture: bytes) -> bytes:
    """Return what is sent: the state's length, the state as JSON, the picture.

    The length has 4 bytes, little-endian.

    Args:
        kind: What the picture is, see `Viewer.coded`.
    """
    text = frame.state[:-1] + f',"picture":"{kind}"}}'.encode()
    return struct.pack("<I", len(text)) + text + picture
