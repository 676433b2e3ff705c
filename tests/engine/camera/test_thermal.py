"""Thermal pictures: who is warm when, the imager's noise, and what they do not depend on."""

import numpy as np
import pytest

from eyas.engine.camera.temperature import SurfaceTemperatures, direction_of
from eyas.engine.camera.thermal import HEAT, ThermalConfig, ThermalFrames, ThermalImager, slot_heat
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.optics.lens import FISHEYE, lens_of, rays
from eyas.engine.state.draw import DrawList
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.engine.world.weather import DAY, FOGGY, SNOW
from eyas.lanes import interpreted, limit_threads

_cell = interpreted(direction_of)
UP, EAST, WEST = (_cell(0.0, 0.0, 1.0), _cell(1.0, 0.0, 0.0), _cell(-1.0, 0.0, 0.0))
SIZE = 24, 32


def _at(hour: float, kind: ObjectClass, facing: tuple[int, int], weather=DAY) -> float:
    return float(SurfaceTemperatures(weather.light(hour), hour).table[kind][facing])


def test_a_road_warms_up_later_than_a_lawn_and_keeps_its_warmth():
    road, lawn = ObjectClass.ROAD, ObjectClass.GROUND
    assert _at(14.0, road, UP) > _at(14.0, lawn, UP) + 8.0
    assert _at(23.0, road, UP) > _at(23.0, lawn, UP) + 2.0
    hottest = max(range(24), key=lambda hour: _at(float(hour), road, UP))
    assert 13 <= hottest <= 16
    assert _at(5.0, road, UP) < _at(5.0, ObjectClass.TREE, UP) + 3.0


def test_walls_are_warm_where_the_sun_was():
    wall = ObjectClass.BUILDING
    assert _at(9.0, wall, EAST) > _at(9.0, wall, WEST) + 4.0
    assert _at(18.0, wall, WEST) > _at(18.0, wall, EAST) + 4.0


def test_fog_keeps_the_sun_off_and_snow_stays_frozen():
    road = ObjectClass.ROAD
    assert _at(14.0, road, UP, FOGGY) < _at(14.0, road, UP) - 12.0
    assert _at(14.0, ObjectClass.GROUND, UP, SNOW) <= 0.0


def _frames(count: int, object_id: int, heat: np.ndarray | None = None) -> ThermalFrames:
    """Return views that look down at one thing from 10 m."""
    down = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    return ThermalFrames(
        object_id=np.full((count, *SIZE), object_id, np.int32),
        depth=np.full((count, *SIZE), 10.0, np.float32),
        normal=np.tile(np.array([128, 128, 0], np.uint8), (count, *SIZE, 1)),
        eye=np.tile([0.0, 0.0, 10.0], (count, 1)),
        rotation=np.tile(down, (count, 1, 1)),
        ray=np.full((count, 2), 1.0 / 20.0),
        lens=np.zeros((0, 10)),
        world=np.zeros(count, np.int32),
        heat=np.zeros((1, 1), HEAT) if heat is None else heat,
        fog=np.zeros(count, np.float32),
        seed=np.full(count, 7),
        step=np.arange(count),
    )


def _imager(**config: object) -> ThermalImager:
    classes = np.array([ObjectClass.ROAD, ObjectClass.GROUND], np.uint8)
    return ThermalImager(
        ThermalConfig(**config), SurfaceTemperatures(DAY.light(14.0), 14.0), classes
    )


def test_noise_is_that_of_the_settings():
    frames, imager = _frames(400, 0), _imager(noise=0.06, fixed_pattern=0.2)
    degrees = imager.measure(frames, np.empty((400, *SIZE, 3), np.uint8)).astype(np.float64)
    assert degrees.mean() == pytest.approx(_at(14.0, ObjectClass.ROAD, UP), abs=0.1)
    assert degrees.std(axis=0).mean() == pytest.approx(0.06, rel=0.05)
    # The pattern of pixels and that of columns.
    assert degrees.mean(axis=0).std() == pytest.approx(0.2 * 2.0**0.5, rel=0.2)


def test_behind_a_fisheye_the_sky_is_as_cold_as_its_elevation_says():
    fisheye = lens_of(FISHEYE, (0.0, 0.0, 0.0, 0.0), (0.0, 0.0), 0.1, -0.05)
    frames, imager = _frames(1, -1), _imager(noise=0.0, fixed_pattern=0.0)
    frames = frames._replace(
        rotation=np.eye(3)[None], lens=np.array([fisheye]), ray=np.full((1, 2), 1.0 / 9.0)
    )
    degrees = imager.measure(frames, np.empty((1, *SIZE, 3), np.uint8))[0]
    field = 2.0 * np.arctan(SIZE[1] / 2 / 9.0)
    ray = rays(np.eye(3), SIZE[::-1], (field, None), fisheye)
    high = ray[..., 2] / np.linalg.norm(ray, axis=-1)
    warm = SurfaceTemperatures(DAY.light(14.0), 14.0)
    expected = warm.air + np.clip(high / 0.12, 0.0, 1.0) * (warm.sky - warm.air)
    dark = np.isnan(expected)
    assert dark.any()
    np.testing.assert_allclose(degrees, np.where(dark, warm.air, expected), atol=1e-3)


def test_pictures_depend_neither_on_threads_nor_on_other_views():
    frames, imager = _frames(5, 1), _imager()
    together = np.empty((5, *SIZE, 3), np.uint8)
    imager.measure(frames, together)
    alone = np.empty((1, *SIZE, 3), np.uint8)
    last = ThermalFrames(
        *(
            array if name in ("world", "heat") else array[3:4]
            for name, array in frames._asdict().items()
        )
    )._replace(world=frames.world[3:4])
    limit_threads(1)
    try:
        imager.measure(last, alone)
    finally:
        limit_threads(2)
    assert np.array_equal(together[3], alone[0])
    assert not np.array_equal(together[3], together[4])


def test_bonnets_and_tyres_are_warm_and_heads_are_skin():
    movers = DrawList.create(1, 4)
    movers.part[0] = [0, 1, 2, -1]
    movers.object_id[0] = ACTOR_OBJECT + np.array([0, 0, 1, -1])
    movers.pose[0, :, :, :3] = np.eye(3)
    movers.object_class = np.array([[ObjectClass.CAR, ObjectClass.PERSON]], np.uint8)
    heat = slot_heat(movers, np.array([2.8, 0.5, 0.2]), 22.0)[0]
    assert heat["hot"][0] > 10.0
    assert heat["x"][0] > 1.0
    assert heat["above"][1] > 5.0
    assert heat["hot"][1] == 0.0
    assert (heat["own"][2], heat["above"][2]) == (1.0, pytest.approx(33.0))
    body = _frames(1, ACTOR_OBJECT, heat[None])
    degrees = _imager().measure(body, np.empty((1, *SIZE, 3), np.uint8))[0]
    # Looking down with the top of the picture to the east: the bonnet is above the middle.
    assert degrees[4:10, 16].max() > degrees[-4:, 16].max() + 5.0


def test_a_span_must_rise():
    with pytest.raises(ConfigError, match="must rise, from the black to the white one"):
        ThermalConfig(span=(30.0, 10.0))
