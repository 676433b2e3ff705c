"""The stages of a graphics processor give the bytes of the processor, whoever does what share."""

import ast
import dataclasses
from pathlib import Path

import numpy as np
import pytest

import eyas.gpu.render.device as device_module
from eyas.engine.core.errors import ConfigError
from eyas.engine.render.kernels.visibility import items, records
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import DrawList, Picture
from eyas.engine.state.lighting import LightState
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.world.weather import AUTUMN, CLEAR_DAY, CLEAR_NIGHT, DUST, FOG, RAIN, WINTER_DAY
from eyas.gpu.render import stages
from eyas.gpu.render.read_back import ReadBackRenderer
from eyas.lanes.device import HostDevice

from ...kit.on_devices import EVERYTHING, differences
from ...kit.small_city import car_parts, city_scene, city_traffic, floor, looking, scene_of, tower

WEATHERS = {
    **{"day": CLEAR_DAY, "foggy": FOG, "night": CLEAR_NIGHT, "snow": WINTER_DAY},
    **{"rain": RAIN.day, "wet night": RAIN.night, "dust": DUST.day, "autumn": AUTUMN.day},
}
PLACES = [(-95.0, 2.0, 9.0), (-60.0, 0.0, 30.0), (-20.0, 5.0, 2.0)]


def at_instant(views, instant=3.7, wind=6.0):
    """Return views in which things fall and sway."""
    count = len(views.position)
    light = (np.full(count, value, np.float32) for value in (1.0, 0.9, 0.004, wind, 0.5 * wind))
    return dataclasses.replace(views, light=LightState(*light), instant=np.full(count, instant))


def street(subject=ACTOR_OBJECT + 3):
    return looking(PLACES, pitch=[0.12, 0.5, 0.05], fov=1.1, subject=subject)


@pytest.fixture(scope="module")
def renderers(renderer_of):
    windy = dataclasses.replace(CLEAR_DAY, windy=1.0)
    lights = {**WEATHERS, "windy": windy}
    return {
        name: renderer_of(city_scene(), car_parts(), lighting) for name, lighting in lights.items()
    }


@pytest.mark.slow
@pytest.mark.parametrize("samples", [1, 2, 4])
@pytest.mark.parametrize("weather", WEATHERS)
def test_everything_is_equal_in_all_weathers(renderers, weather, samples):
    views = at_instant(street())
    device = HostDevice(7, np.random.default_rng(samples))
    found = differences(
        device, renderers[weather], views, city_traffic(1), samples=samples, **EVERYTHING
    )
    assert found == []


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 3, 64])
def test_the_number_of_workers_changes_nothing(renderers, workers):
    found = differences(
        HostDevice(workers), renderers["night"], street(), city_traffic(1), **EVERYTHING
    )
    assert found == []


def test_plants_in_the_wind_are_equal(renderers):
    views, traffic = at_instant(street(), wind=14.0), city_traffic(1)
    still = Picture.create(3, 40, 52)
    swaying = Picture.create(3, 40, 52)
    renderers["windy"].draw(street(), traffic, still)
    renderers["windy"].draw(views, traffic, swaying)
    assert (still.rgb != swaying.rgb).any()
    assert differences(HostDevice(5), renderers["windy"], views, traffic, **EVERYTHING) == []


@pytest.mark.parametrize("most", [0, 1, 5])
def test_triangles_for_which_there_is_no_room_are_filled_where_they_are_found(
    renderers, monkeypatch, most
):
    monkeypatch.setattr(device_module, "RECORDS_PER_ROW", most)
    device = HostDevice(7, np.random.default_rng(most))
    assert differences(device, renderers["day"], street(), city_traffic(1), **EVERYTHING) == []


@pytest.mark.parametrize(("listed", "clusters"), [(0, 2048), (5, 2048), (512, 8), (7, 16)])
def test_items_and_clusters_for_which_there_is_no_room_are_drawn_at_once(
    renderers, monkeypatch, listed, clusters
):
    monkeypatch.setattr(device_module, "ITEMS", listed)
    monkeypatch.setattr(device_module, "CLUSTERS", clusters)
    device = HostDevice(7, np.random.default_rng(clusters))
    assert differences(device, renderers["day"], street(), city_traffic(1), **EVERYTHING) == []


def test_few_rows_to_share_are_equal(renderers, monkeypatch):
    monkeypatch.setattr(device_module, "UNITS_PER_ROW", 1)
    monkeypatch.setattr(device_module, "RECORDS_PER_ROW", 2)
    device = HostDevice(3, np.random.default_rng(1))
    assert differences(device, renderers["day"], street(), city_traffic(1)) == []


def test_what_the_near_plane_cuts_is_equal(renderer_of):
    scene = scene_of([floor(), tower(8.0, 0.0, 10.0, 30.0)], [0, 1])
    renderer = renderer_of(scene, car_parts())
    # One camera stands in the house, one on the ground, one a hand's breadth from a wall.
    places = [(8.0, 1.0, 3.0), (0.0, 0.0, 0.05), (2.9, 0.3, 1.0)]
    views = looking(places, yaw=[0.4, 0.0, 0.2], pitch=[0.3, 1.2, -0.1], fov=1.4)
    device = HostDevice(7, np.random.default_rng(5))
    assert differences(device, renderer, views, DrawList.create(1, 1), **EVERYTHING) == []


def test_all_actors_and_radiance_are_equal(renderers):
    wanted = {"rgb": False, "radiance": True, "actors": 8, "subject": True}
    found = differences(HostDevice(3), renderers["snow"], street(), city_traffic(1), **wanted)
    assert found == []


def test_a_width_that_is_no_multiple_of_the_lanes_and_several_worlds(renderers):
    views = dataclasses.replace(street(), world=np.array([1, 0, 1], np.int32))
    device, traffic = HostDevice(7), city_traffic(2)
    assert differences(device, renderers["day"], views, traffic, size=(31, 45), samples=4) == []


def test_a_real_map_is_equal():
    config = SimConfig()
    assets = load_assets(config.world, config.traffic, 1)
    movers = StillWorld(assets).movers(300.0)
    points = assets.scene.network.lane_points[[10, 200]]
    places = [
        (float(x), float(y), height) for (x, y), height in zip(points, (22.0, 6.0), strict=True)
    ]
    views = looking(places, yaw=[0.3, 2.0], pitch=[1.1, 0.3], fov=1.2)
    device = HostDevice(7, np.random.default_rng(1))
    assert differences(device, assets.renderer, views, movers, size=(84, 84), **EVERYTHING) == []


@pytest.mark.parametrize("module", [stages, items, records])
def test_drivers_compute_nothing_with_floats(module):
    """What is computed of a point is written once, in kernels that the processor calls too."""
    floats = {"f4", "f8", "to_f4", "to_f8", "root", "lesser", "greater"}
    for node in ast.walk(ast.parse(Path(module.__file__).read_text())):
        named = isinstance(node, ast.Name) and node.id in floats
        number = isinstance(node, ast.Constant) and isinstance(node.value, float)
        divided = isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div | ast.Pow)
        assert not any((named, number, divided)), f"line {node.lineno}"


def test_one_byte_more_of_light_is_seen(renderers):
    """What compares would find a difference."""
    day, night = renderers["day"], renderers["night"]
    near, far = Picture.create(3, 40, 52), Picture.create(3, 40, 52)
    day.draw(street(), city_traffic(1), near)
    ReadBackRenderer(HostDevice(2), night).draw(street(), city_traffic(1), far)
    assert not np.array_equal(near.rgb, far.rgb)


def test_lenses_are_refused(renderers):
    bent = dataclasses.replace(street(), lens=np.zeros((3, 10)))
    renderer = ReadBackRenderer(HostDevice(), renderers["day"])
    with pytest.raises(ConfigError, match=r"^device: lenses"):
        renderer.draw(bent, city_traffic(1), Picture.create(3, 40, 52))


@pytest.mark.parametrize(("samples", "tent"), [(1, False), (4, True)])
def test_pixels_are_filtered_where_that_is_asked_for(renderers, samples, tent):
    views = dataclasses.replace(street(), tent=tent)
    device = HostDevice(5, np.random.default_rng(7))
    assert differences(device, renderers["day"], views, city_traffic(1), samples=samples) == []
