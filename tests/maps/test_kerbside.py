"""Cars that park along the kerbs of imported towns, as tagged or as is usual."""

import importlib
from pathlib import Path

import numpy as np
import pytest
import shapely

from eyas.engine.sim.scenes import load_network
from eyas.engine.world.maps import MAPS
from eyas.engine.world.roads.areas import streets
from eyas.maps.osm import importing
from eyas.maps.osm.parking import _sides
from eyas.maps.plan.file import read_plan
from eyas.maps.plan.plan import Roadway, Things

pytestmark = pytest.mark.sumo

STOP = (100.0, 56.0)
DRIVEWAY = -60.0  # East of its middle [m]


def streets_of(out) -> None:
    """Three streets from west to east, joined at their ends, with houses along them.

    On the northern one cars park in the north only, by its tag; along the middle one as is usual;
    beside the southern one, a primary street, nowhere.
    """
    ends = [[out.node((x, y)) for y in (-50, 0, 50)] for x in (-200, 200)]
    home = out.node((DRIVEWAY, 0))
    for k, (kind, tags) in enumerate(
        [("primary", {}), ("residential", {}),
         ("residential", {"parking:left": "lane", "parking:right": "no"})]
    ):  # fmt: skip
        nodes = [ends[0][k], *([home] if k == 1 else []), ends[1][k]]
        out.way(nodes, highway=kind, sidewalk="both", lanes="2", maxspeed="50", **tags)
    for column in ends:
        out.way(column, highway="secondary", lanes="2", maxspeed="50")
    out.way([home, out.node((DRIVEWAY, 20))], highway="service", service="driveway")
    out.node(STOP, highway="bus_stop")
    for x in range(-180, 180, 30):
        for y in (-38, 16, 68):
            out.area(shapely.box(x, y, x + 20, y + 10), building="house")


def imported(writer, folder, drive_on, **options):
    out, path = writer(), folder / "town.osm"
    streets_of(out)
    path.write_text("\n".join(out.lines((260, 120))), encoding="utf-8")
    importing.run(path, "kerbs", out=folder / drive_on, record=False, drive_on=drive_on,
                  overwrite=True, **options)  # fmt: skip
    return str(folder / drive_on)


@pytest.fixture(scope="module")
def writer():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(Path(__file__).parents[2] / "tools")
        yield importlib.import_module("synthetic_osm").Writer


@pytest.fixture(scope="module", params=["right", "left"])
def town(request, writer, tmp_path_factory):
    """The name of a town, its roads and its completed plan."""
    name = imported(writer, tmp_path_factory.mktemp("kerbs"), request.param)
    network = load_network(name, 0)
    return name, network, MAPS.get(name).complete_plan(network, 0)


def cars_of(plan):
    """Middle [m] and heading [rad] of each parked car, shape (K, 3)."""
    (cars,) = [
        one for one in plan.layers if isinstance(one, Things) and "parked car 0" in one.kinds
    ]
    return cars.pose[:, [0, 1, 3]] if len(cars.pose) else np.zeros((0, 3))


def test_cars_park_where_tags_say_so_or_as_is_usual(town):
    _, _, plan = town
    cars = cars_of(plan)
    assert len(cars) > 25
    rows = {y: cars[np.abs(cars[:, 1] - y) < 1.5] for y in (50 + 4.7, 50 - 4.7, 4.7, -4.7)}
    assert sum(map(len, rows.values())) == len(cars)  # nowhere else
    north, south, *middle = rows.values()
    assert len(north) > 8
    assert len(south) == 0
    assert min(map(len, middle)) > 8
    assert np.abs(north[:, 0] - STOP[0]).min() > 12.0
    assert np.abs(middle[0][:, 0] - DRIVEWAY).min() > 4.5
    assert np.abs(cars[:, 0]).max() < 200.0 - 9.0


def test_parked_cars_stand_in_bays_beyond_the_kerb_and_face_as_the_traffic(town):
    _, network, plan = town
    (roadway,) = [one for one in plan.layers if isinstance(one, Roadway)]
    kerbs = [shapely.LineString(street.right) for street in streets(network)]
    for x, y, heading in cars_of(plan):
        point = shapely.Point(x, y)
        assert roadway.bays.contains(point)
        assert roadway.area.distance(point) > 0.9
        kerb = kerbs[int(np.argmin(shapely.distance(kerbs, point)))]
        along = kerb.project(point)
        low, high = (
            shapely.get_coordinates(kerb.interpolate(s))[0] for s in (along - 1, along + 1)
        )
        way = (high - low) / np.hypot(*(high - low))
        assert way @ (np.cos(heading), np.sin(heading)) > 0.99
    assert shapely.intersection(roadway.area, roadway.bays).area < 0.01


def test_towns_have_signs_and_their_bus_stops(town):
    _, _, plan = town
    placed = [(one.kinds[k], pose[:2]) for one in plan.layers if isinstance(one, Things)
              for k, pose in zip(one.kind, one.pose, strict=True)]  # fmt: skip
    assert sum(name.startswith("road sign") for name, _ in placed) > 3
    (stop,) = [place for name, place in placed if name == "bus stop"]
    assert np.hypot(*(stop - np.array(STOP))) < 4.0


def test_without_parked_cars_the_plan_says_nothing_of_them(writer, tmp_path):
    name = imported(writer, tmp_path, "right", parked=False)
    plan = read_plan(Path(name) / "map.plan.json")
    assert not plan.survey.parking
    assert "parking" not in (Path(name) / "map.plan.json").read_text()
    assert len(cars_of(MAPS.get(name).complete_plan(load_network(name, 0), 0))) == 0


@pytest.mark.parametrize(
    ("tags", "left", "right"),
    [
        ({"highway": "residential"}, "", ""),
        ({"highway": "residential", "parking:both": "no"}, "no", "no"),
        ({"highway": "primary", "parking:left": "street_side"}, "yes", "no"),
        ({"highway": "residential", "parking:right": "separate"}, "", "mapped"),
        ({"highway": "residential", "parking:both": "lane", "parking:both:restriction":
          "no_stopping"}, "no", "no"),
        ({"highway": "tertiary", "parking:lane:right": "parallel"}, "", "yes"),
        ({"highway": "tertiary", "parking:lane:both": "no_parking"}, "no", "no"),
        ({"highway": "residential", "bridge": "yes"}, "no", "no"),
        ({"highway": "residential", "junction": "roundabout"}, "no", "no"),
    ],
)  # fmt: skip
def test_tags_say_where_cars_park(tags, left, right):
    assert _sides(tags) == {"left": left, "right": right}
