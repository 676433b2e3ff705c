"""Defocus: discs of the size that is said, no light lost, the same in any company."""

import numpy as np
import pytest

from eyas.engine.camera.defocus import defocused, disc

SIZE = 21, 27


def test_a_disc_is_as_wide_as_said_and_keeps_all_light():
    for diameter in (0.5, 1.0, 3.0, 7.5):
        weight = disc(diameter)
        assert weight.sum() == pytest.approx(1.0, abs=1e-5)
        covered = weight / weight.max()
        area = np.pi * 0.25 * max(diameter, 1.0) ** 2
        assert covered.sum() == pytest.approx(area, rel=0.3 if diameter < 2.0 else 0.02)


def test_a_point_becomes_a_disc_and_an_even_picture_stays():
    radiance = np.zeros((2, 3, *SIZE), np.float32)
    radiance[0, :, 10, 13] = 1.0
    radiance[1] = 0.7
    blurred = defocused(radiance, np.array([5.0, 5.0]))
    assert np.allclose(blurred[0, 0, 8:13, 11:16], disc(5.0), atol=1e-7)
    assert blurred[0, 0].sum() == pytest.approx(1.0, abs=1e-5)
    assert np.allclose(blurred[1], 0.7, atol=1e-6)


def test_each_picture_has_its_own_disc_whatever_the_others_have():
    radiance = np.random.default_rng(0).random((3, 3, *SIZE), np.float32)
    together = defocused(radiance, np.array([0.0, 4.0, 9.3]))
    assert np.array_equal(together[0], radiance[0])
    for one, size in ((1, 4.0), (2, 9.3)):
        assert np.array_equal(
            together[one], defocused(radiance[one : one + 1], np.array([size]))[0]
        )
        assert not np.array_equal(together[one], radiance[one])
