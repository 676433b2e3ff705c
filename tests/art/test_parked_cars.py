"""Parked cars: which there are, and what they are made of."""

from collections import Counter

import numpy as np
import pytest

from art.cars.parked import KINDS, TAXI, TYPES, levels_of, pack_parked
from art.vehicles.models import VEHICLES
from eyas.engine.state.mesh import Surface
from eyas.maps.street import parked_cars
from eyas.maps.street.parked_cars import VARIANTS, parked_car, parked_taxi, solid_size

EACH = pytest.mark.parametrize("variant", range(0, VARIANTS, 3))


def test_types_and_paint_are_as_frequent_as_the_statistics_say():
    types = Counter(kind.type for kind in KINDS)
    assert set(types) == set(TYPES)
    assert types["compact"] / VARIANTS == pytest.approx(0.25, abs=0.02)
    assert types["small"] / VARIANTS == pytest.approx(0.19, abs=0.02)
    assert types["crossover"] / VARIANTS == pytest.approx(0.099, abs=0.02)
    paint = Counter(kind.colour for kind in KINDS)
    assert paint["white"] / VARIANTS == pytest.approx(0.28, abs=0.03)
    assert paint["blue"] / VARIANTS == pytest.approx(0.11, abs=0.03)
    grey = sum(paint[name] for name in ("white", "black", "grey", "silver"))
    assert grey / VARIANTS == pytest.approx(0.76, abs=0.03)
    assert len(set(KINDS)) == VARIANTS


@EACH
def test_the_solid_shape_holds_the_body_at_every_level(variant):
    half = np.array(solid_size(variant)) * (0.5, 0.5, 1.0)
    for mesh in parked_car(variant):
        body = mesh.positions[np.abs(mesh.positions[:, 0]) < half[0]]
        assert (np.abs(body[:, 1]) < half[1] + 0.11).all()  # mirrors, and wheels that are turned
        assert np.abs(mesh.positions[:, 0]).max() < half[0] + 0.05
        assert half[2] - 0.4 < mesh.positions[:, 2].max() < half[2] + 0.05
        assert mesh.positions[:, 2].min() > -1e-6


@pytest.mark.slow
@EACH
def test_lamps_are_off_and_snow_lies_on_all_of_it(variant):
    moving = {one for model in VEHICLES for mesh in model.body(model) for one in mesh.palette}
    for mesh in parked_car(variant):
        assert {one.surface for one in mesh.palette} <= {Surface.MATT, Surface.PAINT, Surface.GLASS}
        assert not moving & set(mesh.palette)


def test_a_covered_car_shows_neither_paint_nor_panes():
    (covered,) = (k for k, kind in enumerate(KINDS) if kind.look == "covered")
    for mesh in parked_car(covered):
        assert {one.surface for one in mesh.palette} == {Surface.MATT}


def test_front_wheels_are_turned_where_a_kind_says_so():
    straight, turned = KINDS.index(KINDS[0]), next(k for k, kind in enumerate(KINDS) if kind.steer)
    widths = [np.ptp(parked_car(k)[0].positions[:, 1]) for k in (straight, turned)]
    assert widths[1] > widths[0] + 0.01


def test_what_ships_is_what_is_made():
    for shipped, kind in ((parked_car(5), KINDS[5]), (parked_taxi(), TAXI)):
        for mesh, made in zip(shipped, levels_of(kind), strict=True):
            assert mesh.palette == made.palette
            for name in ("positions", "normals", "uvs", "triangles", "materials"):
                assert np.array_equal(getattr(mesh, name), getattr(made, name))


@pytest.mark.slow
def test_all_that_ships_is_what_is_made():
    assert pack_parked()[1] == parked_cars.SHA256, "run `python -m art.ship parked`"


def test_taxis_are_yellow():
    paint = {one for one in parked_taxi()[0].palette if one.surface is Surface.PAINT}
    assert all(one.tint[0] > one.tint[1] > 3 * one.tint[2] for one in paint)
