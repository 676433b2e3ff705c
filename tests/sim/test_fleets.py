"""Fleets of other vehicles than cars: driven, followed and drawn as what they are."""

import numpy as np
import pytest

from eyas.sim.build import build_simulation
from eyas.sim.config import SimConfig
from eyas.sim.worlds import together
from eyas.state.draw import Picture
from eyas.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.targets.catalogue import MODELS
from eyas.task.config import StartConfig
from eyas.traffic.config import TrafficConfig, VehicleType

LOOKS_LIKE = {
    VehicleType.BUS: (ObjectClass.BUS, (8.0, 20.0)),
    VehicleType.TRUCK: (ObjectClass.TRUCK, (5.0, 14.0)),
    VehicleType.TRAILER: (ObjectClass.TRUCK, (12.0, 20.0)),
    VehicleType.MOTORCYCLE: (ObjectClass.MOTORCYCLE, (1.5, 3.0)),
}


@pytest.mark.sumo
@pytest.mark.parametrize("vehicle", LOOKS_LIKE)
def test_a_fleet_is_followed_and_drawn_as_what_it_is(vehicle):
    config = SimConfig(
        start=StartConfig(pitch=1.37, height=22.0), traffic=TrafficConfig(vehicle_type=vehicle)
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
