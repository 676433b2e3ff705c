"""Fleets of other vehicles than cars: driven, followed and drawn as what they are."""

import numpy as np
import pytest

from eyas.dat.settings.adapter import from_original
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index
from eyas.engine.task.config import StartConfig
from eyas.engine.traffic.config import Mix, TrafficConfig, VehicleType
from eyas.engine.traffic.library import CANONICAL_MIX

LOOKS_LIKE = {
    VehicleType.BUS: (ObjectClass.BUS, (8.0, 20.0)),
    VehicleType.TRUCK: (ObjectClass.TRUCK, (5.0, 14.0)),
    VehicleType.TRAILER: (ObjectClass.TRUCK, (12.0, 20.0)),
    VehicleType.MOTORCYCLE: (ObjectClass.MOTORCYCLE, (1.5, 3.0)),
}


OTHERS = [kind for kind in LOOKS_LIKE if kind is not VehicleType.TRUCK]
"""SUMO drives ten minutes of each; all are drawn in a mixed fleet below."""


@pytest.mark.slow
@pytest.mark.sumo
@pytest.mark.parametrize(
    "vehicle",
    [VehicleType.TRUCK, *(pytest.param(kind, marks=pytest.mark.thorough) for kind in OTHERS)],
)
def test_a_fleet_is_followed_and_drawn_as_what_it_is(vehicle):
    config = SimConfig(
        start=StartConfig(pitch=1.37, height=22.0),
        traffic=TrafficConfig(vehicle_type=vehicle, max_vehicles=8),
    )
    simulation = build_simulation(config, together(2))
    simulation.reset()
    simulation.carry(50)
    targets = simulation.snapshot.targets
    picture = Picture.create(2, 60, 80, object_id=True, class_id=True, subject=True)
    simulation.draw(np.arange(2, dtype=np.int32), picture)
    object_class, (shortest, longest) = LOOKS_LIKE[vehicle]
    for n in range(2):
        assert MODELS[targets.model[n]].kind == vehicle
        assert shortest < targets.size[n, 0] < longest
        shown = picture.object_id[n] == ACTOR_OBJECT + targets.actor[n]
        assert shown.any()
        assert set(picture.class_id[n][shown]) == {object_class}
        assert picture.subject_pixels[n, 0] == shown.sum()
        assert picture.rgb[n].std() > 3


@pytest.mark.slow
def test_a_mixed_fleet_shares_one_world_and_each_is_drawn_as_what_it_is():
    """The shipped recording of citystreet, found by its settings; no SUMO."""
    mix = Mix(passenger=0.7, bus=0.1, truck=0.1, trailer=0.05, motorcycle=0.05)
    config = SimConfig(
        start=StartConfig(pitch=1.37, height=22.0), traffic=TrafficConfig(vehicle_type=mix)
    )
    simulation = build_simulation(config, together(5))
    simulation.reset()
    kinds = [kind_index(name) for name in VehicleType]
    of_kind = [np.flatnonzero(simulation.traffic.motion.kind == kind)[0] for kind in kinds]
    for tracker, actor in enumerate(of_kind):
        simulation.follow(tracker, int(actor))
    simulation.carry(50)
    picture = Picture.create(5, 60, 80, object_id=True, class_id=True)
    simulation.draw(np.arange(5, dtype=np.int32), picture)
    for n, kind in enumerate(kinds):
        shown = picture.object_id[n] == ACTOR_OBJECT + of_kind[n]
        assert shown.any(), KINDS[kind].name
        assert set(picture.class_id[n][shown]) == {KINDS[kind].object_class}


def test_a_fixed_colour_is_seen_in_the_picture():
    """`fixed_color` and `normalize_color` of the original: every car is that colour."""

    def seen(values: dict[str, object]) -> np.ndarray:
        traffic = from_original({"Sumo_Params": {"keep_alive": True, **values}}).traffic
        config = SimConfig(start=StartConfig(pitch=1.5, height=16.0), traffic=traffic)
        simulation = build_simulation(config, together(4))
        simulation.reset()
        simulation.carry(50)
        picture = Picture.create(4, 60, 80, object_id=True, subject=True)
        simulation.draw(np.arange(4, dtype=np.int32), picture)
        targets = simulation.snapshot.targets.actor[:, None, None]
        return picture.rgb[picture.object_id == ACTOR_OBJECT + targets].mean(axis=0)

    red = seen({"fixed_color": True, "normalize_color": [1, 0, 0]})
    blue = seen({"fixed_color": True, "normalize_color": [0, 0, 1]})
    free = seen({"fixed_color": False, "normalize_color": [1, 0, 0]})
    assert red[0] > 1.5 * red[2]
    assert blue[2] > 1.5 * blue[0]
    assert abs(free[0] - free[2]) < 0.5 * (red[0] - red[2])


def test_only_vehicles_of_the_classes_that_are_asked_for_are_followed():
    config = SimConfig(
        start=StartConfig(vehicles=(VehicleType.BUS, VehicleType.TRAILER)),
        traffic=TrafficConfig(vehicle_type=CANONICAL_MIX),
    )
    simulation = build_simulation(config, together(6))  # four buses and two trailers
    simulation.reset()
    targets = simulation.snapshot.targets
    kinds = sorted(MODELS[model].kind for model in targets.model.tolist())
    assert kinds == ["bus"] * 4 + ["trailer"] * 2
    assert len(set(targets.actor.tolist())) == 6


def test_a_class_that_the_traffic_lacks_is_one_line():
    config = SimConfig(start=StartConfig(vehicles=(VehicleType.BUS,)))
    with pytest.raises(ConfigError) as caught:
        build_simulation(config, together(1))
    assert str(caught.value) == (
        "start.vehicles: the traffic has no bus; allowed: passenger, or another "
        "traffic.vehicle_type"
    )


def test_classes_of_vehicles_are_for_targets_that_are_vehicles():
    with pytest.raises(ConfigError, match=r"^start\.vehicles: .* must be left out"):
        updated(SimConfig(), {"target": "Pedestrian", "start": {"vehicles": ["bus"]}})
