"""The boxes by which moving things block light: eight points at once, and point by point."""

import numpy as np
import pytest

from eyas.engine.render.kernels.bundles import Direction
from eyas.engine.render.kernels.light.shadow_boxes import Box, darken, shadow_boxes
from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import kernel
from eyas.lanes.vector import WIDTH, load, store


@kernel
def _boxes(sun):
    """A body 4 m long, 1.8 m wide and 0.8 m high, with a cabin of 1.5 m on it."""
    lower = Box(f4(-2.0), f4(2.0), f4(-0.9), f4(0.9), f4(0.0), f4(0.8))
    upper = Box(f4(-1.2), f4(0.8), f4(-0.8), f4(0.8), f4(0.8), f4(1.5))
    return shadow_boxes(lower, upper, Direction(sun[0], sun[1], sun[2]), 0.9, 0.85, False)


@kernel
def one_by_one(points, sun, out):
    boxes = _boxes(sun)
    for i in range(points.shape[1]):
        out[0, i], out[1, i] = darken(boxes, points[0, i], points[1, i], points[2, i])


@kernel
def eight_at_once(points, sun, out):
    boxes = _boxes(sun)
    for i in range(0, points.shape[1], WIDTH):
        x, y, z = load(points[0], i), load(points[1], i), load(points[2], i)
        direct, ambient = darken(boxes, x, y, z)
        store(out[0], i, direct)
        store(out[1], i, ambient)


def shares(kernel_, points, sun):
    out = np.zeros((2, points.shape[1]), np.float32)
    kernel_(np.ascontiguousarray(points, np.float32), np.asarray(sun, np.float64), out)
    return out


@pytest.mark.parametrize("sun", [(0.3, -0.5, 0.81), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)])
def test_eight_points_at_once_get_what_each_gets(sun):
    points = np.random.default_rng(4).uniform((-6, -6, -1), (6, 6, 2), (4000, 3)).T
    single = shares(one_by_one, points, sun)
    np.testing.assert_array_equal(shares(eight_at_once, points, sun), single)
    assert single.min() >= 0.0
    assert single.max() == 1.0
    assert (single < 1.0).any(axis=1).all()


def soft_part(x):
    """Width of the shadow's edge beside the body, at x [m] along it; the sun is 45 degrees high."""
    y = np.linspace(0.8, 3.0, 4400)
    points = np.stack([np.full_like(y, x), y, np.zeros_like(y)])
    direct, _ = shares(one_by_one, points, (0.0, -np.sqrt(0.5), np.sqrt(0.5)))
    assert (np.diff(direct) >= -1e-5).all()
    return np.ptp(y[(direct > 0.01) & (direct < 0.99)])


def test_the_edge_of_a_shadow_is_wider_the_farther_it_is_from_the_thing():
    # The bonnet's ends 0.8 m beside the body, the cabin's 1.4 m.
    assert soft_part(0.0) > 1.2 * soft_part(1.8) > 0.1


def test_the_sky_is_hidden_under_the_thing_and_less_beside_it():
    y = np.array([0.0, 0.95, 1.3, 1.6, 1.8])
    ground = np.stack([np.zeros_like(y), y, np.zeros_like(y)])
    _, ambient = shares(one_by_one, ground, (0.0, 0.0, 1.0))
    assert (np.diff(ambient) > 0).all()
    assert ambient[0] < 0.2
    assert ambient[-1] == 1.0
    raised = ground + np.array([[0.0], [0.0], [0.5]])
    _, above = shares(one_by_one, raised, (0.0, 0.0, 1.0))
    assert (above == 1.0).all()
