"""Pictures as one animated WebP file, which every browser plays: a film without PyAV.

The container is written here (RFC 9649), picture by picture, as Pillow would keep all of a film in
memory until its end. Each picture is whole: the camera moves, so little of the last one could stay.
"""

import io
import struct
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from eyas.engine.core.errors import OutputError
from eyas.engine.core.files import refusals
from eyas.engine.exports.writer import Episode, Files, FilmEpisode, Summary, Writer

MOVIE = "episode.webp"
_QUALITY, _EFFORT = 75, 0
"""A picture of 320 x 240 pixels takes 1.8 ms and 15 kB, and is nearer to the true one than in our
MP4 (1.7 ms, 5.6 kB). The default effort, 4, makes it 12 kB in 6.3 ms."""

_HEAD = struct.Struct("<4sI4s")
_CHUNK = struct.Struct("<4sI")
_ANIMATED, _UNBLENDED = 0x02, 0x02  # Flags of the chunks VP8X and ANMF (RFC 9649, 2.7)
_LARGEST = 0xFFFF_FFF6  # Largest file [bytes]
_LONGEST = 0xFF_FFFF  # Longest duration of one frame [ms]


class WebpWriter(Writer):
    """`episode.webp`."""

    wants = frozenset({"rgb"})
    files = Files(episode=(MOVIE,))

    def begin(self, episode: Episode) -> "WebpEpisode":
        """Return the writer of an episode's film."""
        return WebpEpisode(episode.folder / MOVIE, episode.height, episode.width, episode.fps)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of pictures in the film."""
        path = folder / MOVIE
        try:
            with path.open("rb") as file:
                return Summary(_pictures(file, path.stat().st_size))
        except (OSError, ValueError, struct.error):
            return None


class WebpEpisode(FilmEpisode):
    """Encodes pictures by Pillow; no more than one is in memory.

    Args:
        path: The file.
        height: Height of the pictures [pixels].
        width: Width of the pictures [pixels].
        fps: Pictures per second [Hz]. Browsers show more than 90 a second slower.

    Raises:
        OutputError: The file cannot be written, or would be larger than 4 GiB, which no WebP can
            be; raised by every method.
    """

    def __init__(self, path: Path, height: int, width: int, fps: float) -> None:
        super().__init__(path)
        self._size = _three(width - 1) + _three(height - 1)
        self._fps, self._count, self._length = fps, 0, 0
        with refusals(path):
            self._write(_HEAD.pack(b"RIFF", 0, b"WEBP"))
            self._write(_chunk(b"VP8X", struct.pack("<I", _ANIMATED) + self._size))
            self._write(_chunk(b"ANIM", bytes(6)))  # again and again

    def _write(self, data: bytes) -> None:
        self._length += len(data)
        if self._length > _LARGEST:
            raise OutputError(
                f"{self._path}: cannot write: a WebP cannot be larger than 4 GiB; record shorter "
                "episodes (video.episode_frames), or MP4"
            )
        self._file.write(data)

    def add_picture(self, rgb: NDArray[np.uint8]) -> None:
        """Append the next picture, shape (H, W, 3)."""
        file = io.BytesIO()
        Image.fromarray(rgb).save(file, "WEBP", quality=_QUALITY, method=_EFFORT)
        picture = file.getvalue()[_HEAD.size :]  # a file of its own, without the head
        begins, ends = (round(1000 * (self._count + k) / self._fps) for k in (0, 1))
        self._count += 1
        shown = _three(min(ends - begins, _LONGEST)) + bytes([_UNBLENDED])
        with refusals(self._path):
            self._write(_chunk(b"ANMF", bytes(6) + self._size + shown + picture))

    def _complete(self) -> None:
        self._file.seek(0)
        self._file.write(_HEAD.pack(b"RIFF", self._length - _CHUNK.size, b"WEBP"))


def _three(number: int) -> bytes:
    return number.to_bytes(3, "little")


def _chunk(name: bytes, data: bytes) -> bytes:
    """Return a chunk whose content has an even length, as all here have."""
    return _CHUNK.pack(name, len(data)) + data


def _pictures(file: BinaryIO, size: int) -> int:
    """Return the number of pictures in a film of a size [bytes].

    Raises:
        ValueError, struct.error: It is not a whole WebP.
    """
    riff, length, webp = _HEAD.unpack(file.read(_HEAD.size))
    if (riff, webp, length + _CHUNK.size) != (b"RIFF", b"WEBP", size):
        raise ValueError("cut off")
    count, at = 0, _HEAD.size
    while at < size:
        name, length = _CHUNK.unpack(file.read(_CHUNK.size))
        count += name == b"ANMF"
        at = file.seek(at + _CHUNK.size + length + length % 2)
    if at != size:
        raise ValueError("cut off")
    return count
