import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import eyas
from eyas.engine.core.errors import ConfigError
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import (
    KINDS,
    MODELS,
    kind_index,
    kind_of,
    model_index,
    models_of,
    register,
)
from eyas.engine.targets.config import TargetName
from art.vehicles.models import VEHICLES
from art.vehicles.vehicle import BODY_COLOURS
from eyas.engine.traffic.config import VehicleType

ORIGINAL = {
    # name: length, width, height, wheelbase, wheel radius, number of wheels
    # The trucks before a trailer have a wheelbase of ours: the original's trailers do not turn.
    "BmwX5Simple": (4.85, 1.9, 1.8, 3.0, 0.374, 4),
    "CitroenCZeroSimple": (3.5, 1.5, 1.6, 2.55, 0.285, 4),
    "ToyotaPriusSimple": (4.5, 1.8, 1.5, 2.8, 0.317, 4),
    "LincolnMKZSimple": (5.0, 1.85, 1.5, 2.94, 0.358, 4),
    "RangeRoverSportSVRSimple": (4.7, 1.95, 1.7, 2.71, 0.358, 4),
    "TeslaModel3Simple": (4.8, 1.85, 1.5, 2.94, 0.36, 4),
    "MercedesBenzSprinterSimple": (6.9, 2.0, 2.7, 4.33, 0.40, 4),
    "BusSimple": (9.73, 2.64, 3.36, 4.5, 0.56, 4),
    "TruckSimple": (7.7, 2.8, 4.5, 5.25, 0.50, 4),
    "TruckTrailerSimple": (14.3, 2.8, 4.5, 3.7, 0.50, 10),
    "TruckTankSimple": (14.3, 2.8, 4.5, 3.7, 0.50, 10),
    "ScooterSimple": (1.95, 0.66, 1.7, 1.48, 0.23, 2),
    "MotorbikeSimple": (2.48, 1.1, 1.55, 1.78, 0.25, 2),
}


@pytest.mark.parametrize("name", ORIGINAL)
def test_sizes_and_wheels_are_those_of_the_original(name):
    vehicle = MODELS[model_index(name)]
    wheels = sum(2 if axle.track else 1 for axle in vehicle.axles)
    said = (*vehicle.size, vehicle.wheelbase, vehicle.wheel_radius, wheels)
    assert said == pytest.approx(ORIGINAL[name])
    assert vehicle.axles[0].x - vehicle.axles[1].x == pytest.approx(vehicle.wheelbase)


def test_every_model_is_of_one_kind():
    assert MODELS == [model for kind in KINDS for model in kind.models]
    assert [model for k in range(len(KINDS)) for model in models_of(k)] == list(range(len(MODELS)))
    for index in range(len(MODELS)):
        assert MODELS[index] in kind_of(index).models
    for k, kind in enumerate(KINDS):
        assert kind_index(kind.name) == k
        assert [MODELS[m] for m in models_of(k)] == list(kind.models)


def test_every_class_that_sumo_drives_is_a_kind():
    assert len(VEHICLES) == len(ORIGINAL)
    counts = {name.value: len(models_of(kind_index(name))) for name in VehicleType}
    assert counts == {"passenger": 7, "bus": 1, "truck": 1, "trailer": 2, "motorcycle": 2}
    classes = [KINDS[kind_index(name)].object_class.name for name in VehicleType]
    assert classes == ["CAR", "BUS", "TRUCK", "TRUCK", "MOTORCYCLE"]


@pytest.mark.parametrize("model", [MODELS.index(vehicle) for vehicle in VEHICLES])
def test_what_the_reward_looks_for_is_a_metre_behind_a_vehicles_reference(model):
    assert kind_of(model).ahead == -1.0
    assert kind_of(model).lamps
    assert MODELS[model].rise == MODELS[model].wheel_radius


def test_a_trailer_has_the_type_of_its_truck_as_in_the_original():
    others = {model.name: model.typename for model in VEHICLES if model.name != model.typename}
    assert others == {"TruckTrailerSimple": "TruckSimple", "TruckTankSimple": "TruckSimple"}


def test_every_pedestrian_has_the_type_of_the_original():
    people = {MODELS[m].typename for m in models_of(kind_index("Pedestrian"))}
    assert people == {"Pedestrian"}


def test_a_kind_is_added_behind_the_others(walker):
    before = list(MODELS)
    register(walker)
    assert MODELS[: len(before)] == before
    assert MODELS[len(before) :] == list(walker.models)
    assert kind_of(len(before)) is walker
    assert KINDS[kind_index("walker")].object_class is ObjectClass.PERSON


def test_names_are_taken_once_and_models_are_their_kinds(walker):
    register(walker)
    with pytest.raises(
        ConfigError, match=r"\['walker', 'walker of 2 parts'\] are in the catalogue"
    ):
        register(walker)
    stranger = replace(walker, name="bus 2")
    KINDS.pop()
    del MODELS[-1:]
    with pytest.raises(ConfigError, match="'bus 2' needs models of its own"):
        register(stranger)


def test_there_are_the_eight_body_colours_of_the_original():
    assert len(set(BODY_COLOURS)) == 8
    assert (0.85, 0.85, 0.05) in BODY_COLOURS


def with_model(kind, **changes):
    """The kind with another model."""
    return replace(kind, models=(replace(kind.models[0], **changes),))


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"words": ()}, "targets: 'walker of 2 parts' has no words; allowed: phrases like"),
        ({"words": ("a {} walker", " ")}, "targets: 'walker of 2 parts' has no words"),
        ({"size": (1.0, 0.0, 1.0)}, r"targets: 'walker of 2 parts' is \(1.0, 0.0, 1.0\) m"),
        ({"name": "BmwX5Simple"}, r"targets: \['BmwX5Simple'\] are in the catalogue already"),
    ],
)
def test_an_entry_that_lacks_something_is_refused_when_it_is_read(walker, changes, line):
    before = len(MODELS)
    with pytest.raises(ConfigError, match=line):
        register(with_model(walker, **changes))
    assert len(MODELS) == before


def test_a_name_twice_in_one_kind_is_refused(walker):
    with pytest.raises(ConfigError, match="'walker of 2 parts'"):
        register(replace(walker, models=walker.models * 2))


@pytest.mark.parametrize("kind", ["passenger", "bus", "Pedestrian", "Create"])
def test_a_size_that_the_meshes_do_not_have_is_refused_before_anything_is_drawn(kind):
    entry = KINDS[kind_index(kind)].models[-1]
    length, width, height = entry.size
    wrong = replace(entry, size=(1.12 * length, width, height))
    rig = type(KINDS[kind_index(kind)].rig())
    rig([entry]).part_levels()
    with pytest.raises(
        ConfigError, match=rf"targets: '{entry.name}' says that it is .* m; allowed"
    ):
        rig([wrong]).part_levels()


NEW_CAR = """
from art.vehicles.models.toyota_prius import MODEL as _PRIUS
from dataclasses import replace

MODEL = replace(
    _PRIUS, name="TestCarSimple", typename="TestCarSimple",
    words=("a {} car", "a {} test car"),
)
"""

ASK = """
import numpy as np
from eyas.cli.targets.listing import entries
from eyas.engine.targets.catalogue import MODELS, kind_index, model_index, models_of
from eyas.engine.targets.looks import LookSampler
from eyas.engine.targets.words import ObjectInView, distinguishing_phrase

car = model_index("TestCarSimple")
print(car, [MODELS[m].name for m in models_of(kind_index("passenger"))][-1])
print("TestCarSimple" in [line.name for line in entries()])
sampler = LookSampler(np.zeros(100, np.int32))
print(car in sampler.sample(np.random.default_rng(1))[0])
seen = ObjectInView(car, (0.74, 0.10, 0.09), 10.0, 0.0, 0.5, 25.0)
print(distinguishing_phrase(seen, [seen._replace(model=0), seen._replace(model=2)]))
"""


@pytest.mark.slow
def test_a_new_car_in_one_file_of_the_package_is_everywhere(tmp_path):
    copy = tmp_path / "eyas"
    shutil.copytree(Path(eyas.__file__).parent, copy, copy_function=os.link,
                    ignore=shutil.ignore_patterns("__pycache__", "*.npz"))  # fmt: skip
    (copy / "engine" / "targets" / "vehicles" / "models" / "test_car.py").write_text(NEW_CAR)
    asked = subprocess.run(
        [sys.executable, "-c", ASK], env=os.environ | {"PYTHONPATH": str(tmp_path)},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert asked.stdout.splitlines() == [
        "7 TestCarSimple", "True", "True", "a red test car"
    ]  # fmt: skip


def test_every_target_of_the_settings_has_an_entry():
    kinds = {kind.name for kind in KINDS}
    assert {name.value for name in TargetName} - {"SUMO_VEHICLE"} <= kinds
    assert all(model.mass for model in VEHICLES)
