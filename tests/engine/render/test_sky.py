"""The sky: closed forms of the air, clouds that cover what they should, hills with no seam."""

from dataclasses import replace

import numpy as np
import pytest

from eyas.engine.render.bake.clouds import build_clouds, plan_directions
from eyas.engine.render.bake.hills import build_hills
from eyas.engine.render.kernels.sky.night import azimuth
from eyas.engine.render.kernels.sky.radiance import HILL_TOP
from eyas.engine.render.pack.light import tone_table
from eyas.engine.state.lighting import Horizon, LightState
from eyas.lanes import kernel
from eyas.maps.citystreet import CITYSTREET

from ...kit.small_city import DAY, GROUND, floor, looking, scene_of

SUN = (-0.45, 0.45, 0.7713624)
AWAY = np.arctan2(-0.45, 0.45)
"""Azimuth opposite of the sun."""


@pytest.fixture(scope="module")
def sky_of(renderer_of, drawn):
    """Draw a view, of nothing but sky if there is no scene."""

    def draw(light, yaw=AWAY, pitch=0.0, scene=None, fov=0.3, height=30.0):
        renderer = renderer_of(scene or scene_of([], []), lighting=light)
        views = looking([(5.0, -3.0, height)], yaw=yaw, pitch=pitch, fov=fov)
        return drawn(renderer, views, size=(160, 200)).rgb[0].astype(int)

    return draw


def rising(rows, columns, pitch, fov):
    """Return the sine of elevation of each pixel, shape (rows, columns)."""
    focal = 0.5 * columns / np.tan(0.5 * fov)
    up = (0.5 * rows - np.arange(rows) - 0.5)[:, None] / focal
    left = (0.5 * columns - np.arange(columns) - 0.5)[None] / focal
    rise = -np.sin(pitch) + up * np.cos(pitch)
    return rise / np.sqrt(1.0 + up**2 + left**2)


def test_without_clouds_the_sky_is_air_alone(sky_of):
    pitch, fov = -0.5, 0.4
    picture = sky_of(DAY, pitch=pitch, fov=fov)
    z = rising(160, 200, pitch, fov)
    assert z.min() > HILL_TOP
    low = ((1 - z) ** 4)[..., None]
    clear = ((z / (z + 37.5 * DAY.fog_density)) ** 4)[..., None]
    zenith, horizon, fog = DAY.zenith_colour, DAY.horizon_colour, np.array(DAY.fog_colour)
    air = fog + clear * (np.array(zenith) * (1 - low) + np.array(horizon) * low - fog)
    expected = tone_table()[(air * 4096.0).astype(int)].astype(int)
    # The wide glow of the sun reaches 120 degrees away from it with nearly nothing.
    assert np.abs(picture - expected).max() <= 1


@pytest.mark.parametrize("cover", [0.2, 0.4])
def test_clouds_cover_about_the_share_they_are_asked_for(cover):
    clouds = build_clouds(cover, SUN)
    # From 20 to 50 degrees up; lower down, clouds hide each other's gaps.
    middle = clouds[80:150, :, 0]
    assert 0.7 * cover < (middle > 128).mean() < 1.4 * cover
    assert build_clouds(0.0, SUN).max() == 0


def test_an_overcast_sky_has_no_hole():
    # Down to an elevation of 10 degrees; the rays lower down lose themselves.
    assert build_clouds(1.0, SUN)[60:, :, 0].min() > 200


def test_clouds_are_brighter_on_the_side_of_the_sun():
    sun = (-0.684, 0.684, 0.254)
    clouds = build_clouds(0.35, sun).astype(float)
    facing = plan_directions(clouds.shape[1]) @ np.array(sun[:2])
    low = clouds[20:80]
    dense = low[..., 0] > 230
    lit = [low[dense & side][:, 1].mean() for side in (facing < -0.6, facing > 0.6)]
    # Who looks away from the sun sees the lit sides.
    assert lit[0] > 1.05 * lit[1]


def test_clouds_cover_the_picture_and_darken_with_the_sky(sky_of, renderer_of, drawn):
    plain, cloudy = (sky_of(replace(DAY, clouds=c), pitch=-0.5, fov=1.2) for c in (0.0, 0.4))
    changed = (np.abs(plain - cloudy).max(axis=2) > 12).mean()
    assert 0.1 < changed < 0.95
    assert cloudy[np.abs(plain - cloudy).max(axis=2) > 60].min(axis=1).mean() > 170
    renderer = renderer_of(scene_of([], []), lighting=replace(DAY, clouds=0.4))
    night = replace(
        looking([(0.0, 0.0, 30.0)], pitch=-0.5, fov=1.2),
        light=LightState(*np.zeros((5, 1), np.float32)),
    )
    assert drawn(renderer, night).rgb.max() <= 1


@kernel
def azimuth_of(x, y):
    return azimuth(x, y)


def test_columns_of_panoramas_go_round_by_azimuth():
    directions = plan_directions(64)
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1.0)
    turn = np.unwrap(np.arctan2(directions[:, 1], directions[:, 0]))
    assert (np.diff(turn) > 0).all()
    assert turn[-1] - turn[0] < 2 * np.pi
    found = [azimuth_of(np.float32(x), np.float32(y)) for x, y in directions]
    assert found == pytest.approx((np.arange(64) + 0.5) / 16, abs=1e-5)


@pytest.mark.parametrize(
    "build", [lambda: build_clouds(0.4, SUN), lambda: build_hills(Horizon(), SUN)]
)
def test_panoramas_close_without_a_seam(build):
    values = build().astype(int)
    steps = np.abs(np.diff(values, axis=1)).mean(axis=(0, 2))
    assert np.abs(values[:, 0] - values[:, -1]).mean() <= steps.max()


def test_hills_stand_on_the_horizon_and_end_below_their_top():
    cover = build_hills(Horizon(), SUN)[..., 0].astype(int)
    assert (cover[0] == 255).all()
    assert cover[-1].max() == 0
    # Solid from the ground up: a ridge has sky above it only.
    assert (np.diff(cover, axis=0) <= 0).all()
    ridge = (cover > 127).sum(axis=0) * HILL_TOP / len(cover)
    assert 0.01 < ridge.min() < ridge.max() < HILL_TOP
    assert ridge.std() > 0.003


def ridge_of(hills) -> np.ndarray:
    """The sine of the elevation of the highest hill in each direction."""
    return (hills[..., 0] > 127).sum(axis=0) * HILL_TOP / len(hills)


def test_each_map_has_hills_of_its_own():
    usual = build_hills(Horizon(), SUN)
    low, others, dunes, bare = (
        build_hills(Horizon(**changed), SUN)
        for changed in ({"height": 0.01}, {"name": "dunes"}, {"ridges": 0.0}, {"woods": 0.0})
    )
    assert ridge_of(low).max() < 0.4 * ridge_of(usual).max()
    assert abs(np.corrcoef(ridge_of(others), ridge_of(usual))[0, 1]) < 0.6
    assert np.abs(np.diff(ridge_of(dunes))).sum() < np.abs(np.diff(ridge_of(usual))).sum()
    assert (bare[..., 2].max(), usual[..., 2].max()) == (0, 255)
    assert build_hills(Horizon(height=0.0), SUN)[2:, :, 0].max() == 0  # a plain to the horizon


def test_fog_hides_the_hills(sky_of):
    fog = replace(CITYSTREET.light("foggy"), clouds=0.0)
    thick = sky_of(replace(fog, fog_density=1 / 300))
    assert np.ptp(thick[55:85].reshape(-1, 3), axis=0).max() <= 2
    clear = sky_of(CITYSTREET.light("day"))
    assert np.ptp(clear[55:85].reshape(-1, 3), axis=0).max() > 20


@pytest.mark.parametrize("range_m", [300.0, 1000.0])
@pytest.mark.parametrize("height", [20.0, 300.0])
def test_an_endless_plain_meets_the_sky_in_fog_without_an_edge(sky_of, range_m, height):
    fog = replace(CITYSTREET.light("foggy"), fog_density=1.0 / range_m)
    land = scene_of([floor(12000.0)], [GROUND])
    picture = sky_of(fog, scene=land, height=height)
    around = picture[77:83].mean(axis=1)
    assert np.abs(np.diff(around, axis=0)).max() <= 2


def test_land_ends_without_an_edge_in_clear_air(sky_of):
    light = CITYSTREET.light("day")
    land = scene_of([floor(9000.0)], [GROUND])
    picture = sky_of(light, scene=land, height=300.0)
    # The plain ends 1.9 degrees under the horizon; there the sky goes on with its colour.
    rows = picture[82:120].mean(axis=1)
    assert np.abs(np.diff(rows, axis=0)).max() <= 3


def test_the_sun_is_a_small_white_disc_in_a_glow(sky_of):
    yaw, pitch = np.arctan2(0.45, -0.45), -np.arcsin(SUN[2])
    picture = sky_of(DAY, yaw=yaw, pitch=pitch, fov=0.3)
    middle, edge = picture[78:82, 98:102], picture[80, [0, -1]]
    assert middle.min() >= 250
    assert edge.max() < 235
    white = (picture.min(axis=2) >= 250).sum()
    # 0.6 degrees across, a pixel is 0.087 degrees: some 40 to 250 with the inner glow.
    assert 30 < white < 700


def test_the_sky_depends_on_the_direction_only(renderer_of, drawn):
    renderer = renderer_of(scene_of([], []), lighting=replace(DAY, clouds=0.4))
    places = [(0.0, 0.0, 10.0), (700.0, -300.0, 90.0)]
    picture = drawn(renderer, looking(places, yaw=[1.0, 1.0], pitch=-0.2, fov=1.2))
    assert (picture.rgb[0] == picture.rgb[1]).all()
