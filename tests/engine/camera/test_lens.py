"""LensSet of trackers: settings, samples, what they do to light; and overlays behind them."""

import cv2
import numpy as np
import pytest

from eyas.engine.camera.glass import change_light
from eyas.engine.camera.lens import LensConfig, LensSet
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.optics import pinhole
from eyas.engine.core.optics.lens import BROWN, FISHEYE, NO_LENS, Lens, rays
from eyas.engine.core.variation import Uniform
from eyas.engine.overlay.canvas import Canvas
from eyas.engine.state.draw import Views


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"k1": 0.1}, "k1: 0.1 .* must be 0; coefficients of pinhole: none"),
        ({"model": "brown", "k4": 0.1}, "must be 0; coefficients of brown: k1, k2, k3, p1, p2"),
        ({"model": "fisheye", "p1": 0.1}, "must be 0; coefficients of fisheye: k1, k2, k3, k4"),
        ({"model": "brown", "k1": {"uniform": [-20, 0]}}, "within -10 and 10"),
        ({"vignetting": 1.0}, "within 0 and 0.99"),
    ],
)
def test_settings_that_no_lens_has_are_refused(values, said):
    with pytest.raises(ConfigError, match=said):
        LensConfig(**values)


def test_what_is_off_is_not_there():
    assert LensSet.of(LensConfig(), 3) is None
    assert not LensSet.of(LensConfig(vignetting=0.3), 3).bend
    assert not LensSet.of(LensConfig(model="fisheye"), 3).change_light


def test_numbers_are_sampled_for_each_episode():
    lenses = LensSet.of(LensConfig(model="fisheye", k1=Uniform(uniform=(-0.1, 0.1)), red=0.01), 2)
    for tracker in range(2):
        lenses.begin(tracker, np.random.default_rng(tracker))
    first, second = lenses.of_tracker(0), lenses.of_tracker(1)
    assert first.model == second.model == FISHEYE
    assert first.k1 != second.k1
    assert max(abs(first.k1), abs(second.k1)) <= 0.1
    lenses.begin(1, np.random.default_rng(0))
    assert lenses.of_tracker(1) == first
    np.testing.assert_array_equal(lenses.fringes, [[0.01, 0.0], [0.01, 0.0]])


def vignette(strength: float, middle: tuple[float, float], size: tuple[int, int]) -> np.ndarray:
    """Return the share of light that reaches each pixel, shape (height, width).

    By the law of cos⁴ (natural vignetting): cos² = 1 / (1 + tan²), and tan grows with the distance
    from the principal point; at a corner's distance from the middle, 1 - `strength` is left.
    """
    column, row = np.meshgrid(*(np.arange(side) + 0.5 for side in size))
    half = 0.5 * np.array(size)
    away = ((column - middle[0]) ** 2 + (row - middle[1]) ** 2) / (half @ half)
    return 1.0 / np.square(1.0 + away * (1.0 / np.sqrt(1.0 - strength) - 1.0))


def test_vignetting_takes_its_share_of_the_corners_by_cos_4():
    share = vignette(0.6, (160.0, 120.0), (320, 240))
    assert share[119:121, 159:161].min() > 0.999
    away = np.hypot(159.5, 119.5) / np.hypot(160.0, 120.0)
    tangent = away * np.sqrt(1.0 / np.sqrt(0.4) - 1.0)
    assert share[0, 0] == pytest.approx(np.cos(np.arctan(tangent)) ** 4)
    assert share[0, 0] == pytest.approx(0.4, abs=0.01)


@pytest.mark.parametrize("width", [84, 85, 8])
def test_light_is_darkened_and_shown_larger(width):
    lenses = LensSet.of(LensConfig(vignetting=0.5, right=0.1), 2)
    light = np.random.default_rng(0).random((2, 3, 20, width)).astype(np.float32)
    share = vignette(0.5, (0.6 * width, 10.0), (width, 20))
    behind = change_light(light.copy(), np.array([0, 1]), lenses)
    np.testing.assert_allclose(behind, light * share, rtol=2e-6)
    lenses = LensSet.of(LensConfig(red=0.05, blue=-0.02, right=0.1), 1)
    behind = change_light(light[:1].copy(), np.array([0]), lenses)
    for channel, size in enumerate((1.05, 1.0, 0.98)):
        # OpenCV's places are counted from the middles of pixels.
        middle = 0.6 * width - 0.5, 9.5
        warp = np.array([[1 / size, 0, middle[0] - middle[0] / size],
                         [0, 1 / size, middle[1] - middle[1] / size]])  # fmt: skip
        rows, columns = np.mgrid[:20, :width].astype(np.float32)
        across = (warp[0, 0] * columns + warp[0, 2]).astype(np.float32)
        down = (warp[1, 1] * rows + warp[1, 2]).astype(np.float32)
        meant = cv2.remap(light[0, channel], across, down, cv2.INTER_LINEAR,
                          borderMode=cv2.BORDER_REPLICATE)  # fmt: skip
        np.testing.assert_allclose(behind[0, channel], meant, atol=0.02)


@pytest.mark.parametrize("lens", [NO_LENS, Lens(BROWN, -0.3, 0.1, 0, 0, 0, 0, 0.02, 0, 1.2)])
def test_areas_of_the_overlay_end_where_their_edges_are(lens):
    """A line on the ground: pixels are as far from it as their points on the ground are."""
    eye, rotation = np.array([0.0, 0.0, 10.0]), np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])
    views = Views(eye[None], rotation[None], np.zeros(1, np.int32), np.zeros(1, np.int32), 1.2)
    if lens is not NO_LENS:
        views.lens = np.array([lens], np.float64)
    canvas = Canvas(views, 0, np.zeros((240, 320, 3), np.uint8), np.ones((240, 320), np.float32))
    point, along = np.array([13.0, -3.0, 0.0]), np.array([1.0, 0.5, 0.0])
    normal = rotation.T @ np.cross(along, point - eye)
    away = canvas.distance(normal, (slice(0, 240), slice(0, 320)))
    ends = canvas.project(point + np.linspace(-2.0, 4.0, 25)[:, None] * along)
    rows, columns = ends[:, 1].astype(int), ends[:, 0].astype(int)
    inside = (rows >= 0) & (rows < 240) & (columns >= 0) & (columns < 320)
    assert inside.sum() > 10
    assert np.abs(away[rows[inside], columns[inside]]).max() < 0.8
    shown = rays(np.eye(3), (320, 240), (1.2, None), lens)
    assert np.isfinite(shown).all()
    assert canvas.across == pytest.approx(pinhole.focal_length(320, 1.2))
