"""PNG files, against the decoder of Pillow and, for colours of 16 bits, that of OpenCV."""

import hashlib
import io
import zlib

import cv2
import numpy as np
import pytest
from PIL import Image

from eyas.engine.core.codecs.deflate import deflated
from eyas.engine.core.codecs.png import png_bytes


def pictures():
    """Pictures of every type: noise, ramps, runs, a single pixel."""
    rng = np.random.default_rng(3)
    for dtype in (np.uint8, np.uint16):
        most = np.iinfo(dtype).max
        for shape in ((1, 1), (7, 5), (60, 83), (60, 83, 3), (1, 400, 3), (400, 1)):
            yield rng.integers(0, most, shape, dtype, endpoint=True)
            yield np.full(shape, most, dtype)
            ramp = np.linspace(0, most, int(np.prod(shape))).reshape(shape)
            yield ramp.astype(dtype)
            yield np.where(rng.random(shape) < 0.01, rng.integers(0, most, shape), 3).astype(dtype)


def decoded(data: bytes) -> np.ndarray:
    read = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    return read[..., ::-1] if read.ndim == 3 else read


def test_pictures_come_back():
    for picture in pictures():
        data = png_bytes(picture)
        np.testing.assert_array_equal(decoded(data), picture)
        if picture.dtype == np.uint8 or picture.ndim == 2:
            np.testing.assert_array_equal(np.array(Image.open(io.BytesIO(data))), picture)


@pytest.mark.parametrize("size", [1, 2, 3, 4, 257, 258, 259, 260, 261, 5000])
def test_runs_of_any_length_come_back(size):
    for data in (np.zeros(size, np.uint8), np.arange(size).astype(np.uint8)):
        assert zlib.decompress(deflated(data), -15) == data.tobytes()


def test_rare_bytes_get_no_code_that_is_too_long():
    # Counts that grow like this need codes of more than 15 bits if nothing limits them.
    counts = [1, 1]
    while sum(counts) < 600_000:
        counts.append(counts[-1] + counts[-2])
    data = np.repeat(np.arange(len(counts)), counts).astype(np.uint8)
    np.random.default_rng(0).shuffle(data)
    assert zlib.decompress(deflated(data), -15) == data.tobytes()


def test_bytes_are_the_same_on_every_machine():
    row = np.arange(96) ** 2 // 7 % 251
    picture = np.stack([row + k * k for k in range(40)]).astype(np.uint8)
    assert hashlib.sha256(png_bytes(picture)).hexdigest()[:16] == "b01a5c7ecb7e6a80"
