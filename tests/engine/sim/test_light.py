"""Light and fog that vary: the original's `Env_Params`."""

import numpy as np
import pytest

from eyas.dat.settings.adapter import from_original
from eyas.engine.core.optics.pinhole import rays
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.render.kernels.light.tone import TONE_TOP
from eyas.engine.render.pack.light import tone_table
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.draw import Picture
from eyas.maps.citystreet import CITYSTREET

RANDOM = {"background": {"uniform": [0.4, 1.6]}, "background_replaces": True,
          "sun": {"uniform": [-0.5, 0.5]}}  # fmt: skip


def started(light=None, *, weather="day", count=1, shared=False, seed=0):
    settings = {"seed": seed, "world": {"weather": weather}, "light": light or {}}
    simulation = build_simulation(
        SimConfig(**settings), together(count) if shared else each_alone(count)
    )
    simulation.reset()
    return simulation


def pictures(simulation):
    picture = Picture.create(simulation.count, 24, 32)
    simulation.draw(np.arange(simulation.count, dtype=np.int32), picture)
    return picture.rgb.astype(float)


def test_what_is_added_to_sky_and_sun_is_seen():
    usual = pictures(started()).mean()
    assert pictures(started({"background": 0.5})).mean() > usual + 5
    assert pictures(started({"sun": -0.6})).mean() < usual - 4
    assert pictures(started({"background": -5.0, "sun": -5.0})).max() < 10


def test_luminosities_refer_to_the_originals_own():
    night = started({"background": 0.3, "sun": 0.15, "sun_replaces": True}, weather="night")
    light = night.snapshot.light
    np.testing.assert_allclose([light.sky[0], light.sun[0]], [2.0, 0.5], rtol=1e-6)
    assert CITYSTREET.light("night").luminosity == 0.3


def test_visibility_is_that_of_the_fog_and_only_foggy_weather_has_some():
    thick = pictures(started({"visibility": 30.0}, weather="foggy"))
    usual = pictures(started(weather="foggy"))
    # At 22 m, 1 - exp(-22 / 30) = 52 % of everything is the grey of the air.
    assert thick.std(axis=(1, 2)).mean() < 0.75 * usual.std(axis=(1, 2)).mean()
    foggy = started({"visibility": 30.0}, weather="foggy")
    assert foggy.snapshot.light.fog_density[0] == pytest.approx(1 / 30)
    clear = started({"visibility": 30.0})
    np.testing.assert_array_equal(pictures(clear), pictures(started()))


def test_the_air_veils_what_lies_at_a_distance_as_one_over_the_visibility_says():
    """What is left of the difference to the air's own light is `exp(-distance / visibility)`; in
    banks and gaps of fog it is less and more, and seen from above the air is darker.
    """
    count, seen, depth = 16, [], []
    for visibility in (1e6, 40.0):
        simulation = started({"visibility": visibility}, weather="foggy", count=count)
        picture = Picture.create(count, 60, 80, depth=True)
        simulation.draw(np.arange(count, dtype=np.int32), picture)
        seen.append(radiance(picture.rgb))
        depth.append(picture.depth)
    np.testing.assert_array_equal(*depth)
    turned = simulation.snapshot.cameras.rotation
    rise = np.stack([rays(each, 80, 60, 0.7854)[..., 2] for each in turned])
    stretch = np.linalg.norm(rays(np.eye(3), 80, 60, 0.7854), axis=-1)
    air = CITYSTREET.light("foggy").fog_colour[1] * (1.0 + 0.6 * np.minimum(rise / stretch, 0.0))
    left = (seen[1][..., 1] - air) / (seen[0][..., 1] - air)
    distance = depth[0] * stretch
    far = (np.abs(seen[0][..., 1] - air) > 0.15) & np.isfinite(distance)
    assert far.sum(axis=(1, 2)).min() > 1000
    over = left / np.exp(-distance / 40.0)
    assert np.mean([np.median(over[k][far[k]]) for k in range(count)]) == pytest.approx(1, abs=0.06)


def radiance(rgb):
    """Undo `tone_table`."""
    table = tone_table()
    return np.interp(rgb, table, np.arange(len(table))) * (TONE_TOP / len(table))


def test_visibility_where_there_is_no_fog_is_told_to_have_no_effect(caplog):
    started({"visibility": 30.0}, weather="foggy")
    assert not caplog.records
    started({"visibility": 30.0})
    assert [record.getMessage() for record in caplog.records] == [
        "light.visibility (Env_Params.foggy_use_default): without effect in the weather 'day', "
        "which has no fog"
    ]


def test_each_episode_draws_anew_within_the_limits_or_only_the_first():
    simulation = started(RANDOM, count=3)
    drawn = [np.array(simulation.snapshot.light)]
    for _ in range(4):
        simulation.reset()
        drawn.append(np.array(simulation.snapshot.light))
    sky, sun = np.stack(drawn)[:, 0], np.stack(drawn)[:, 1]
    assert len(np.unique(sky)) == sky.size
    assert ((sky >= 0.4) & (sky <= 1.6) & (sun >= 0.5) & (sun <= 1.5)).all()
    once = started(RANDOM | {"each_reset": False}, count=2)
    first = np.array(once.snapshot.light)
    once.reset()
    np.testing.assert_array_equal(once.snapshot.light, first)
    np.testing.assert_array_equal(first, drawn[0][:, :2])


def test_a_tracker_draws_the_same_alone_and_changes_nothing_else():
    alone, among = started(RANDOM), started(RANDOM, count=5)
    np.testing.assert_array_equal(alone.snapshot.light.sky[0], among.snapshot.light.sky[0])
    np.testing.assert_array_equal(pictures(alone)[0], pictures(among)[0])
    plain = started()
    for part in ("trackers", "cameras", "targets", "episodes"):
        for same, array in zip(
            getattr(plain.snapshot, part), getattr(alone.snapshot, part), strict=True
        ):
            np.testing.assert_array_equal(same, array)


def test_in_a_shared_world_all_see_one_light():
    simulation = started(RANDOM, count=3, shared=True)
    assert len(np.unique(simulation.snapshot.light.sky)) == 1
    before = simulation.snapshot.light.sky.copy()
    simulation.reset(np.array([False, True, False]))
    np.testing.assert_array_equal(simulation.snapshot.light.sky, before)
    simulation.reset(np.array([True, False, False]))
    assert (simulation.snapshot.light.sky != before).all()


def test_env_params_of_the_original_work_and_are_told_in_info():
    values = {"background_luminosity_random": True, "bgl_random_min": 0.2, "bgl_random_max": 0.3}
    env = TrackingEnv(from_original({"Env_Params": values}))
    _, info = env.reset(seed=1)
    assert 0.2 <= info["light"][0] <= 0.3
    assert info["light"][1] == 1.0


def test_flakes_fall_with_the_simulation_unless_they_are_turned_off():
    falling = started({}, weather="snow")
    clear = started({"flakes": False}, weather="snow")
    pictures = []
    for simulation in (falling, clear):
        picture = Picture.create(1, 240, 320)
        for _ in range(2):
            simulation.draw(np.zeros(1, np.int32), picture)
            pictures.append(picture.rgb.copy())
            # Nothing but the time changes: the traffic stands, and so does the camera.
            simulation.snapshot.episodes.tick[:] += 1
    assert (pictures[0] != pictures[2]).any()
    assert (pictures[0] != pictures[1]).sum() > (pictures[2] != pictures[3]).sum()
