from dataclasses import replace

import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import (
    KINDS,
    MODELS,
    VEHICLE_KINDS,
    kind_index,
    kind_of,
    models_of,
    register,
)
from eyas.engine.targets.colour_names import colour_name
from eyas.engine.targets.config import TargetName
from eyas.engine.traffic.config import VehicleType

VEHICLES = [model for kind in VEHICLE_KINDS for model in kind.models]


def test_every_model_is_of_one_kind():
    assert MODELS == [model for kind in KINDS for model in kind.models]
    assert [model for k in range(len(KINDS)) for model in models_of(k)] == list(range(len(MODELS)))
    for index in range(len(MODELS)):
        assert MODELS[index] in kind_of(index).models
    for k, kind in enumerate(KINDS):
        assert kind_index(kind.name) == k
        assert [MODELS[m] for m in models_of(k)] == list(kind.models)


def test_every_class_that_sumo_drives_is_a_kind():
    counts = {name.value: len(models_of(kind_index(name))) for name in VehicleType}
    assert counts == {"passenger": 7, "bus": 1, "truck": 1, "trailer": 2, "motorcycle": 2}
    classes = [KINDS[kind_index(name)].object_class.name for name in VehicleType]
    assert classes == ["CAR", "BUS", "TRUCK", "TRUCK", "MOTORCYCLE"]


@pytest.mark.parametrize("model", [MODELS.index(vehicle) for vehicle in VEHICLES])
def test_what_the_reward_looks_for_is_a_metre_behind_a_vehicles_reference(model):
    assert kind_of(model).ahead == -1.0
    assert kind_of(model).lamps


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


@pytest.mark.parametrize("kind", ["passenger", "bus", "truck", "trailer"])
def test_three_in_four_bodies_are_white_black_grey_or_silver(kind):
    names = [colour_name(colour) for colour in KINDS[kind_index(kind)].colours]
    dull = sum(name in ("white", "black", "dark grey", "grey") for name in names)
    assert dull / len(names) == 0.75
    assert len(set(names)) == 8


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


def test_every_target_of_the_settings_has_an_entry():
    kinds = {kind.name for kind in KINDS}
    assert {name.value for name in TargetName} - {"SUMO_VEHICLE"} <= kinds
    assert all(model.mass for model in VEHICLES)
