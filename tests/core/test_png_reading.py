"""Our PNG files, read as fast as they allow; those of others are left to Pillow."""

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from PIL import Image

from eyas.core.png import png_bytes
from eyas.core.png_reading import grey_pixels

SHAPES = array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=30)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@given(data=st.data())
def test_pictures_that_are_empty_for_the_most_part_come_back(dtype, data):
    values = st.sampled_from([0, 0, 0, 0, 1, 255, int(np.iinfo(dtype).max)])
    pixels = data.draw(arrays(dtype, SHAPES, elements=values))
    found = grey_pixels(png_bytes(pixels))
    assert found.dtype == dtype
    assert np.array_equal(found, pixels)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_noise_and_blocks_come_back(dtype):
    rng = np.random.default_rng(1)
    pixels = rng.integers(0, np.iinfo(dtype).max, (50, 70), dtype, endpoint=True)
    blocks = np.kron(rng.integers(0, 3, (8, 9)), np.ones((9, 11))).astype(dtype) * dtype(257 % 250)
    for each in (pixels, blocks, np.zeros_like(pixels)):
        assert np.array_equal(grey_pixels(png_bytes(each)), each)


def of_pillow(pixels) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "png")
    return file.getvalue()


def test_files_of_others_and_spoilt_ones_are_not_read():
    ours = png_bytes(np.arange(600, dtype=np.uint16).reshape(20, 30))
    assert grey_pixels(png_bytes(np.zeros((4, 5, 3), np.uint8))) is None
    assert grey_pixels(b"") is None
    assert grey_pixels(b"\xff\xd8" + bytes(100)) is None
    assert grey_pixels(ours[:60]) is None
    spoilt = bytearray(ours)
    spoilt[60] ^= 255
    assert grey_pixels(bytes(spoilt)) is None
    other = of_pillow(np.arange(600, dtype=np.uint8).reshape(20, 30))
    found = grey_pixels(other)
    assert found is None or np.array_equal(found, np.asarray(Image.open(io.BytesIO(other))))
