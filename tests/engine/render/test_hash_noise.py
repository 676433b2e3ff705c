"""Noise: neither its cells nor their neighbours follow a pattern."""

import numpy as np
import pytest
from numpy import float32 as f4
from numpy import int32 as i4

from eyas.engine.render.kernels.hash_noise import seen_swing, swing
from eyas.lanes import kernel
from eyas.lanes.vector import WIDTH, lane_numbers, splat, store, to_f4

SIDE = 256


@kernel
def corners(out, left, top):
    """Write the noise at the corners of its cells, where it is not blended."""
    for row in range(SIDE):
        for column in range(0, SIDE, WIDTH):
            x, y = to_f4(lane_numbers() + i4(left + column)), splat(f4(top + row))
            store(out, row * SIDE + column, swing(x, y))


@kernel
def faded(out, footprints):
    for at in range(0, len(footprints), WIDTH):
        x, y = to_f4(lane_numbers()) * f4(1.37), splat(f4(0.6))
        store(out, at, seen_swing(x, y, f4(0.5), splat(footprints[at])))


@pytest.mark.parametrize("place", [(0, 0), (-300, -77), (-128, 5000), (90_000, -40_000)])
def test_cells_look_random(place):
    values = np.zeros((SIDE, SIDE), f4)
    corners(values, *place)
    assert abs(values.mean()) < 0.01
    assert values.std() == pytest.approx(12**-0.5, rel=0.01)  # evenly from -0.5 to 0.5
    power = np.abs(np.fft.fft2(values - values.mean())) ** 2
    assert power.max() < 20 * power.mean()  # of noise, one in e^20 is larger
    alike = np.fft.ifft2(power).real / power.mean()
    assert np.abs(alike.ravel()[1:]).max() < 6 / SIDE  # six standard deviations


def test_no_row_of_cells_is_mirrored_at_the_origin():
    values = np.zeros((SIDE, SIDE), f4)
    corners(values, -SIDE // 2, -SIDE // 2)
    around = values[1:, 1:]  # the origin is in the middle
    for lines in (around, around.T):
        alike = (lines * lines[:, ::-1]).mean(axis=1) / values.var()
        assert np.abs(alike).max() < 0.5  # of numbers that are all alike: 1


def test_noise_fades_before_a_pixel_covers_its_cells():
    footprints = np.repeat(np.array([0.0, 0.5, 1.0, 1.2, 3.0], f4), WIDTH)
    out = np.zeros(len(footprints), f4)
    faded(out, footprints)
    near, whole, less, *gone = out.reshape(-1, WIDTH)
    np.testing.assert_array_equal(near, whole)
    assert 0.0 < np.abs(less).max() < np.abs(near).max()
    np.testing.assert_array_equal(gone, 0.0)
