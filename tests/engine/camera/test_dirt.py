"""Dirt and drops on the front glass."""

import numpy as np
import pytest

from eyas.engine.camera.dirt import Dirt, DirtConfig
from eyas.engine.core.errors import ConfigError
from eyas.lanes import limit_threads, thread_count


def covered(light, count=None, falling=0.0, **settings):
    count = len(light) if count is None else count
    dirt = Dirt(DirtConfig(**settings), falling, count)
    for n in range(count):
        dirt.begin(n, np.random.default_rng(n))
    changed = light.copy()
    dirt.cover(changed, np.arange(len(light)))
    return changed


def slope(views=1, size=64):
    """Return light that is 0 at the top and 1 at the bottom."""
    rows = np.linspace(0, 1, size, dtype=np.float32)
    return np.ascontiguousarray(np.broadcast_to(rows[:, None], (views, 3, size, size)))


def test_a_spot_takes_its_share_away_in_its_middle_and_nothing_outside():
    light = np.full((1, 3, 100, 100), 2.0, np.float32)
    light[:, 1] = 1.0
    changed = covered(light, spots=1, spot_size=0.2, opacity=0.5, scatter=0.0)
    share = changed / light
    np.testing.assert_allclose(share[0, 0], share[0, 1], rtol=1e-6)
    assert share.min() == pytest.approx(0.5, abs=0.01)
    assert share.max() == 1.0
    area = (share[0, 0] < 1.0).mean()
    assert 0.01 < area <= np.pi * 0.2**2 * 1.02


def test_dirt_scatters_the_light_of_the_whole_picture():
    light = np.zeros((1, 3, 64, 64), np.float32)
    light[..., :32, :] = 1.0
    dark, veiled = (
        covered(light, spots=20, spot_size=0.3, opacity=0.6, scatter=s) for s in (0.0, 0.5)
    )
    assert dark[..., 32:, :].max() == 0.0
    assert 0.1 < veiled[..., 32:, :].max() <= 0.6 * 0.5 * 0.5 * 20
    uniform = np.ones((1, 3, 64, 64), np.float32)
    np.testing.assert_allclose(covered(uniform, spots=20, scatter=1.0), 1.0, rtol=1e-5)


def test_a_drop_shows_the_world_upside_down():
    light = slope()
    changed = covered(light, spots=0, drops=1, drop_size=0.25)
    inside = changed[0, 0] != light[0, 0]
    rows, columns = np.nonzero(inside)
    middle = round(columns.mean())
    seen = changed[0, 0, rows.min() + 6 : rows.max() - 5, middle]
    assert len(seen) > 5
    assert np.diff(seen).mean() < -0.02  # beside it, light grows downwards
    assert 0.0 <= changed.min() <= changed.max() <= 1.0


def test_each_episode_has_its_own_pattern_and_keeps_it():
    light = slope(6, 48)
    first = covered(light, drops=3)
    assert len({one.tobytes() for one in first}) == 6
    threads = thread_count()
    dirt = Dirt(DirtConfig(drops=3), 0.0, 6)
    for n in range(6):
        dirt.begin(n, np.random.default_rng(n))
    try:
        limit_threads(1)
        for n in (4, 1, 5):
            one = light[n : n + 1].copy()
            dirt.cover(one, np.array([n]))
            np.testing.assert_array_equal(one[0], first[n])
    finally:
        limit_threads(threads)


def test_rain_and_snow_wet_the_glass():
    light = slope(1, 100)
    dry, some, many = (
        (covered(light, falling=f, spots=0, wet=30, drop_size=0.05) != light).mean()
        for f in (0.0, 0.3, 1.0)
    )
    assert dry == 0.0
    assert 0.0 < 2 * some < many


def test_no_dirt_changes_nothing_and_too_much_is_refused():
    np.testing.assert_array_equal(covered(slope(), spots=0), slope())
    with pytest.raises(ConfigError, match="spots: 65"):
        DirtConfig(spots=65)
