import pytest

from eyas.targets.catalogue import BODY_COLOURS, VEHICLES, model_index, models_of
from eyas.traffic.config import VehicleType

ORIGINAL = {
    # name: length, width, height, wheelbase, wheel radius, number of wheels
    "BmwX5Simple": (4.85, 1.9, 1.8, 3.0, 0.374, 4),
    "CitroenCZeroSimple": (3.5, 1.5, 1.6, 2.55, 0.285, 4),
    "ToyotaPriusSimple": (4.5, 1.8, 1.5, 2.8, 0.317, 4),
    "LincolnMKZSimple": (5.0, 1.85, 1.5, 2.94, 0.358, 4),
    "RangeRoverSportSVRSimple": (4.7, 1.95, 1.7, 2.71, 0.358, 4),
    "TeslaModel3Simple": (4.8, 1.85, 1.5, 2.94, 0.36, 4),
    "MercedesBenzSprinterSimple": (6.9, 2.0, 2.7, 4.33, 0.40, 4),
    "BusSimple": (9.73, 2.64, 3.36, 4.5, 0.56, 4),
    "TruckSimple": (7.7, 2.8, 4.5, 5.25, 0.50, 4),
    "TruckTrailerSimple": (14.3, 2.8, 4.5, 5.25, 0.50, 10),
    "TruckTankSimple": (14.3, 2.8, 4.5, 5.25, 0.50, 10),
    "ScooterSimple": (1.95, 0.66, 1.7, 1.48, 0.23, 2),
    "MotorbikeSimple": (2.48, 1.1, 1.55, 1.78, 0.25, 2),
}


@pytest.mark.parametrize("name", ORIGINAL)
def test_sizes_and_wheels_are_those_of_the_original(name):
    vehicle = VEHICLES[model_index(name)]
    wheels = sum(2 if axle.track else 1 for axle in vehicle.axles)
    assert (*vehicle.size, vehicle.wheelbase, vehicle.wheel_radius, wheels) == ORIGINAL[name]
    assert vehicle.axles[0].x - vehicle.axles[1].x == pytest.approx(vehicle.wheelbase)


def test_every_model_is_driven_by_one_class():
    assert len(VEHICLES) == len(ORIGINAL)
    driven = [model for vehicle_type in VehicleType for model in models_of(vehicle_type)]
    assert sorted(driven) == list(range(len(VEHICLES)))
    counts = {vehicle_type.value: len(models_of(vehicle_type)) for vehicle_type in VehicleType}
    assert counts == {"passenger": 7, "bus": 1, "truck": 1, "trailer": 2, "motorcycle": 2}


def test_there_are_the_eight_body_colours_of_the_original():
    assert len(set(BODY_COLOURS)) == 8
    assert (0.85, 0.85, 0.05) in BODY_COLOURS
