"""Models as they are made: what ships, what is refused, and a new one."""

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from art.catalogue import driven, entries, jointed
from art.jointed.layout import JointedLayout
from art.jointed.people.people import PEDESTRIANS
from art.jointed.robots import ROBOTS
from art.packing import Packer
from art.vehicles.layout import VehicleLayout
from art.vehicles.models import VEHICLES
from eyas.engine.core.errors import ConfigError
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.shapes import read_index
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
    vehicle = next(one for one in VEHICLES if one.name == name)
    wheels = sum(2 if axle.track else 1 for axle in vehicle.axles)
    said = (*vehicle.size, vehicle.wheelbase, vehicle.wheel_radius, wheels)
    assert said == pytest.approx(ORIGINAL[name])
    assert vehicle.rise == vehicle.wheel_radius
    assert vehicle.axles[0].x - vehicle.axles[1].x == pytest.approx(vehicle.wheelbase)


def digests(entry):
    """What ships of a kind, but for the places of its blocks."""
    return entry.facts, entry.drives, [block and block.digest for block in entry.shapes]


SHIPPED = {entry.facts.name: digests(entry) for entry in read_index().kinds}


def test_a_few_kinds_are_what_is_made():
    robot = next(model for model in ROBOTS if model.name == "Scout")
    for made in (
        driven(VehicleType.TRUCK, Packer()),
        jointed((robot,), ObjectClass.ROBOT, Packer()),
    ):
        assert digests(made) == SHIPPED[made.facts.name], "run `python -m art.ship models`"


@pytest.mark.slow
def test_all_kinds_are_what_is_made():
    made = {entry.facts.name: digests(entry) for entry in entries(Packer())}
    assert [*made] == [*SHIPPED]
    stale = [name for name in made if made[name] != SHIPPED[name]]
    assert not stale, "run `python -m art.ship models`"


@pytest.mark.parametrize("name", [VEHICLES[0].name, "BusSimple", PEDESTRIANS[-1].name, "Create"])
def test_a_size_that_the_meshes_do_not_have_is_refused(name):
    model = next(one for one in (*VEHICLES, *PEDESTRIANS, *ROBOTS) if one.name == name)
    layout = VehicleLayout if model in VEHICLES else JointedLayout
    layout([model]).part_levels()
    length, width, height = model.size
    wrong = replace(model, size=(1.12 * length, width, height))
    with pytest.raises(ConfigError, match=rf"targets: '{name}' says that it is .* m; allowed"):
        layout([wrong]).part_levels()


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
def test_a_new_car_in_one_file_is_everywhere_after_one_command(tmp_path):
    root = Path(__file__).parents[2]
    for name in ("art", "src"):
        shutil.copytree(root / name, tmp_path / name, copy_function=os.link,
                        ignore=shutil.ignore_patterns("__pycache__", "*.npz"))  # fmt: skip
    for written in ("shapes.py", "models.eya"):  # no link to the clone's own
        place = tmp_path / "src/eyas/engine/targets" / written
        place.unlink()
        shutil.copy(root / "src/eyas/engine/targets" / written, place)
    (tmp_path / "art/vehicles/models/test_car.py").write_text(NEW_CAR)
    environment = os.environ | {"PYTHONPATH": str(tmp_path / "src")}

    def run(*arguments):
        return subprocess.run(
            [sys.executable, *arguments], cwd=tmp_path, env=environment,
            capture_output=True, text=True, check=True,
        ).stdout  # fmt: skip

    run("-m", "art.ship", "models")
    assert run("-c", ASK).splitlines() == ["7 TestCarSimple", "True", "True", "a red test car"]
