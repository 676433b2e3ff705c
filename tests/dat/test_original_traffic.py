"""The original's file means the original's traffic, from the file to what drives."""

import json
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.core.errors import MissingExtraError
from eyas.engine.settings.file import load_settings
from eyas.engine.sim import assets
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import ALONE, each_alone, largest_world, together
from eyas.engine.traffic import library
from eyas.engine.world.config import WorldConfig

MANUAL = Path(__file__).parent / "settings" / "data" / "manual_example.json"


@pytest.fixture(autouse=True)
def no_sumo(monkeypatch):
    """Nothing is recorded, and nothing recorded earlier is found."""

    def missing(purpose: str) -> str:
        raise MissingExtraError(purpose, "sumo")

    monkeypatch.setattr(library, "sumo_version", missing)
    monkeypatch.setattr(library, "_cached", lambda *_: None)
    assets._traffic.cache_clear()  # what other tests have loaded is looked up again


@pytest.mark.parametrize(
    ("world_of", "largest"),
    [(each_alone(64), 1), (together(4), 4), (np.array([0, 0, 1, ALONE, 0, ALONE]), 3), ([], 1)],
)
def test_trackers_are_counted_in_their_worlds(world_of, largest):
    assert largest_world(world_of) == largest


def test_the_manuals_example_runs_its_groups_without_sumo(caplog):
    config = load_settings(MANUAL)
    assert not config.traffic.update_routes  # as in the manual's example
    simulation = build_simulation(config, together(4))
    simulation.reset()
    said = [line for line in caplog.messages if line.startswith("traffic")]
    assert said == [
        "traffic.group_size (Sumo_Params.car_group_num): 5 raised to 12, 3 for each tracker, "
        "of which a world has 4"
    ]
    traffic = load_assets(config.world, config.traffic, 4).traffic
    there = (traffic.motion.sampled().table["present"] > 0.0).sum(axis=1)
    assert there.mean() == pytest.approx(15.0, abs=0.1)
    targets = simulation.snapshot.targets.actor
    assert len(set(targets.tolist())) == 4
    for count in (1, 64):  # each in a world of its own: the manual's five are enough
        build_simulation(config, each_alone(count)).reset()
    assert sum(line.startswith("traffic") for line in caplog.messages) == 1


def test_a_file_with_changed_traffic_says_what_to_install(tmp_path):
    values = json.loads(MANUAL.read_text())
    values["Sumo_Params"]["max_car_speed"] = 10
    (tmp_path / "env_config.json").write_text(json.dumps(values))
    config = load_settings(tmp_path / "env_config.json")
    with pytest.raises(MissingExtraError, match=r"^new traffic, as no recording fits.*pip install"):
        load_assets(WorldConfig(), config.traffic, 1)
