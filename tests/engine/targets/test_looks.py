import numpy as np
import pytest

from eyas.engine.core.rng import room_key, stream
from eyas.engine.targets.catalogue import KINDS, kind_index, models_of
from eyas.engine.targets.looks import LookSampler, sample_looks
from eyas.engine.traffic.config import VehicleType
from eyas.lanes import interpreted
from eyas.lanes.pcg64 import STATE, begin_stream

PINK = (0.9, 0.3, 0.6)


def drawn(vehicle_type, colour=None, seed=3):
    kind = np.full(400, kind_index(vehicle_type))
    return LookSampler(kind, colour).sample(stream(seed, "targets"))


@pytest.mark.parametrize("vehicle_type", VehicleType)
def test_all_models_and_colours_of_a_class_appear(vehicle_type):
    model, colour = drawn(vehicle_type)
    assert set(model) == set(models_of(kind_index(vehicle_type)))
    palette = KINDS[kind_index(vehicle_type)].colours
    assert set(map(tuple, colour)) == set(map(tuple, np.array(palette, np.float32)))
    assert (model.dtype, colour.dtype) == (np.int32, np.float32)


def test_models_are_about_equally_frequent():
    model, _ = LookSampler(np.zeros(7000, int)).sample(stream(0, "targets"))
    assert np.bincount(model, minlength=7)[:7] == pytest.approx(np.full(7, 1000), abs=130)


def test_same_seed_same_looks_and_another_seed_other_looks():
    first, again, other = drawn("passenger"), drawn("passenger"), drawn("passenger", seed=4)
    assert np.array_equal(first[0], again[0])
    assert np.array_equal(first[1], again[1])
    assert not np.array_equal(first[0], other[0])


def test_a_fixed_colour_holds_for_cars_and_changes_no_model():
    model, colour = drawn(VehicleType.PASSENGER, PINK)
    assert np.array_equal(model, drawn(VehicleType.PASSENGER)[0])
    assert np.array_equal(colour, np.tile(np.float32(PINK), (400, 1)))


def test_a_fixed_colour_does_not_hold_for_motorcycles():
    fixed, free = drawn(VehicleType.MOTORCYCLE, PINK), drawn(VehicleType.MOTORCYCLE)
    assert np.array_equal(fixed[1], free[1])


def test_a_mixed_fleet_has_models_and_colours_of_each_actors_kind():
    kind = np.tile([kind_index(t) for t in VehicleType], 80)
    model, colour = LookSampler(kind, PINK).sample(stream(1, "targets"))
    for vehicle_type in VehicleType:
        of_kind = kind == kind_index(vehicle_type)
        assert set(model[of_kind]) == set(models_of(kind_index(vehicle_type)))
        pink = (colour[of_kind] == np.float32(PINK)).all(axis=1)
        assert pink.all() == (vehicle_type != VehicleType.MOTORCYCLE)


def test_other_kinds_that_join_change_no_look_of_the_first():
    alone = LookSampler(np.zeros(30, int)).sample(stream(1, "targets"))
    joined = LookSampler(np.repeat([0, 2], [30, 5])).sample(stream(1, "targets"))
    assert np.array_equal(alone[0], joined[0][:30])
    assert np.array_equal(alone[1], joined[1][:30])


@pytest.mark.parametrize("colour", [None, PINK])
def test_kernels_draw_the_same(colour):
    kinds = ["passenger", "bus", "motorcycle", "Pedestrian"]
    kind = np.random.default_rng(0).choice([kind_index(name) for name in kinds], 60)
    sampler, state = LookSampler(kind, colour), [0] * STATE
    interpreted(begin_stream)(state, 5, room_key("looks"), 2, 9)
    model, painted = np.empty(60, np.int32), np.empty((60, 3), np.float32)
    interpreted(sample_looks)(sampler.table, model, painted, state)
    expected = sampler.sample(stream(5, "looks", 2, 9))
    np.testing.assert_array_equal(model, expected[0])
    np.testing.assert_array_equal(painted, expected[1])
