"""Pictures as H.264 in RTP (RFC 6184), over UDP."""

import socket
from fractions import Fraction
from queue import Empty, Full, Queue
from threading import Thread
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.codecs.pyav import pyav
from eyas.engine.core.errors import ConfigError

_LONGEST = 1200  # Largest packet, well below what networks carry whole [bytes]
_CLOCK = 90_000  # Clock of the time stamps [Hz]
_TYPE = 96  # Payload type, the first of those that are free
_FRAGMENT = 28  # FU-A
_ENCODER = "libx264"


class RtpPacker:
    """Cuts access units of H.264 into packets of RTP."""

    def __init__(
        self,
        source: int,  # Number of the sender, SSRC
    ) -> None:
        self._source, self._sequence = source, 0

    def packets(self, unit: bytes, seconds: float) -> list[bytes]:
        """Return the packets of a picture in the format of Annex B, at a time [s]."""
        stamp = round(seconds * _CLOCK) & 0xFFFF_FFFF
        pieces = [piece for part in _parts(unit) for piece in _fragments(part)]
        last = len(pieces) - 1
        return [self._packet(piece, stamp, last=at == last) for at, piece in enumerate(pieces)]

    def _packet(self, payload: bytes, stamp: int, *, last: bool) -> bytes:
        head = bytes((0x80, _TYPE | last << 7)) + self._sequence.to_bytes(2, "big")
        self._sequence = (self._sequence + 1) & 0xFFFF
        return head + stamp.to_bytes(4, "big") + self._source.to_bytes(4, "big") + payload


def _parts(unit: bytes) -> list[bytes]:
    """Return the parts (NAL units) of a picture, without their start codes."""
    found = unit.split(b"\0\0\1")[1:]
    # A start code of four bytes leaves its first at the end of the part before.
    return [part[:-1] if part.endswith(b"\0") else part for part in found if part]


def _fragments(part: bytes) -> list[bytes]:
    """Return a part as it is, if it is short, or in fragments."""
    if len(part) <= _LONGEST:
        return [part]
    indicator, kind, body = part[0] & 0xE0 | _FRAGMENT, part[0] & 0x1F, part[1:]
    step = _LONGEST - 2
    starts = range(0, len(body), step)
    return [
        bytes((indicator, kind | (at == 0) << 7 | (at + step >= len(body)) << 6))
        + body[at : at + step]
        for at in starts
    ]


class VideoStream(NamedTuple):
    """Encoder and destination of pictures."""

    address: tuple[str, int]  # Host and port
    height: int  # [pixels]
    width: int  # [pixels]
    rate: float  # Pictures per second [Hz]
    quality: int  # Constant rate factor of x264


class VideoSender:
    """Encodes the pictures of one vehicle in a thread, and sends them.

    A picture that comes while two others wait is left out.

    Args:
        stream: How.

    Raises:
        MissingExtraError: PyAV is not installed.
        ConfigError: It has been built without x264.
    """

    def __init__(self, stream: VideoStream, source: int) -> None:
        av = pyav("mavlink.video: H.264")
        if _ENCODER not in av.codecs_available:
            raise ConfigError(f"mavlink.video: needs a PyAV with {_ENCODER}; or leave it empty")
        self._av, self._address = av, stream.address
        self._coder = _coder(av, stream)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._packer = RtpPacker(source)
        self._waiting: Queue[tuple[NDArray[np.uint8], float] | None] = Queue(2)
        self._thread = Thread(target=self._run, name="eyas-video", daemon=True)
        self._thread.start()

    @property
    def waits(self) -> bool:
        """Whether a picture waits to be encoded."""
        return not self._waiting.empty()

    def send(self, rgb: NDArray[np.uint8], seconds: float) -> None:
        """Send a picture, shape (H, W, 3), of a time [s]; it is copied."""
        if not self._waiting.full():
            self._waiting.put((rgb.copy(), seconds))

    def close(self) -> None:
        """End; pictures that wait are dropped."""
        while True:
            try:
                self._waiting.put_nowait(None)
                break
            except Full:
                try:
                    self._waiting.get_nowait()
                except Empty:
                    continue
        self._thread.join()
        self._socket.close()

    def _run(self) -> None:
        while (item := self._waiting.get()) is not None:
            rgb, seconds = item
            for packet in self._packer.packets(self._encoded(rgb), seconds):
                try:
                    self._socket.sendto(packet, self._address)
                except OSError:  # nobody listens, or the network is away: the next may get through
                    break

    def _encoded(self, rgb: NDArray[np.uint8]) -> bytes:
        height, width = rgb.shape[:2]
        even = rgb[: height - height % 2, : width - width % 2]
        picture = self._av.VideoFrame.from_ndarray(np.ascontiguousarray(even), format="rgb24")
        return b"".join(bytes(packet) for packet in self._coder.encode(picture))


def _coder(av: ModuleType, stream: VideoStream) -> Any:  # noqa: ANN401  # a `VideoCodecContext`
    """Return an encoder whose every second has a whole picture, so that anyone can join late."""
    coder = av.CodecContext.create(_ENCODER, "w")
    coder.height, coder.width = stream.height - stream.height % 2, stream.width - stream.width % 2
    coder.pix_fmt = "yuv420p"
    whole = max(round(stream.rate), 1)
    coder.time_base = Fraction(1, whole)
    coder.thread_count = 1
    coder.options = {
        **{"preset": "ultrafast", "tune": "zerolatency", "profile": "baseline"},
        "crf": str(stream.quality),
        "x264-params": f"keyint={whole}:scenecut=0:repeat-headers=1",
    }
    return coder
