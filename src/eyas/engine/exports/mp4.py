"""Pictures as one MP4 file."""

from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.codecs.pyav import pyav
from eyas.engine.core.files import refusals
from eyas.engine.exports.writer import Episode, Files, FilmEpisode, Run, Summary, Writer

if TYPE_CHECKING:
    from av.video.stream import VideoStream

MOVIE = "episode.mp4"

CODECS = {
    # A picture of 320 x 240 takes 1.8 ms; the default preset needs 5.7 ms for the same size.
    # x264's macroblock tree gives different bytes in about one run of fifty, so it is off.
    "libx264": {"crf": "18", "preset": "veryfast", "x264-params": "mbtree=0"},
    "mpeg4": {"qscale": "3"},
}
"""Encoders in order of preference, with settings of about equal, visually clean quality."""

LARGEST_DENOMINATOR = 1001  # Largest denominator of the frame rate; 30000/1001 is a common rate


class Mp4Writer(Writer):
    """`episode.mp4`.

    Raises:
        MissingExtraError: PyAV is not installed.
    """

    wants = frozenset({"rgb"})
    files = Files(episode=(MOVIE,))

    def __init__(self, run: Run) -> None:
        self._av = pyav("video.writers: 'mp4'")  # before anything is recorded

    def begin(self, episode: Episode) -> "Mp4Episode":
        """Return the writer of an episode's video."""
        path = episode.folder / MOVIE
        return Mp4Episode(path, episode.height, episode.width, episode.fps)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of pictures that the video's header states."""
        try:
            # Only as what it should be: of a playlist, FFmpeg would open what it names.
            with self._av.open(str(folder / MOVIE), format="mp4") as container:
                return Summary(container.streams.video[0].frames)
        except (self._av.error.FFmpegError, OSError, ValueError, IndexError):
            return None


class Mp4Episode(FilmEpisode):
    """Encodes pictures by FFmpeg. The same pictures give the same bytes: one encoder thread, no
    dates, no version tags.

    Args:
        path: The file.
        height: Height of the pictures [pixels].
        width: Width of the pictures [pixels].
        fps: Pictures per second of the video [Hz].

    Raises:
        OutputError: The file cannot be written; raised by every method.
        MissingExtraError: PyAV is not installed.
    """

    def __init__(self, path: Path, height: int, width: int, fps: float) -> None:
        self._av = pyav("MP4")
        super().__init__(path)
        # yuv420p shares colours among 2 x 2 pixels, so sizes must be even.
        self._padding = (0, height % 2), (0, width % 2), (0, 0)
        self._container = self._av.open(
            self._file, "w", format="mp4", container_options={"fflags": "+bitexact"}
        )
        self._stream = self._video_stream(height, width, fps)

    def _video_stream(self, height: int, width: int, fps: float) -> "VideoStream":
        codec = next(name for name in CODECS if name in self._av.codecs_available)
        rate = max(
            Fraction(fps).limit_denominator(LARGEST_DENOMINATOR), Fraction(1, LARGEST_DENOMINATOR)
        )
        stream: VideoStream = self._container.add_stream(codec, rate=rate, options=CODECS[codec])
        stream.height, stream.width = height + height % 2, width + width % 2
        stream.pix_fmt = "yuv420p"
        stream.codec_context.thread_count = 1
        stream.codec_context.flags |= self._av.codec.context.Flags.bitexact
        return stream

    def add_picture(self, rgb: NDArray[np.uint8]) -> None:
        """Append the next picture, shape (H, W, 3)."""
        rgb = np.pad(rgb, self._padding, mode="edge") if np.any(self._padding) else rgb
        image = self._av.VideoFrame.from_numpy_buffer(np.ascontiguousarray(rgb), format="rgb24")
        with refusals(self._path):
            self._container.mux(self._stream.encode(image))

    def _complete(self) -> None:
        self._container.mux(self._stream.encode(None))
        self._container.close()
