"""What is special in each protocol."""

from dataclasses import replace

import numpy as np
import pytest

from eyas.benchmark.episodes.episode import Place, episodes_of
from eyas.benchmark.episodes.episode_batch import episode_groups
from eyas.benchmark.episodes.neighbours import NEAR, with_neighbours
from eyas.benchmark.flight.batch_flight import clear_shares
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.engine.camera.config import CameraConfig
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.env import EnvConfig

HOME = [Place("citystreet", "day", "SUMO_VEHICLE")]


def starts(name, count=2):
    protocol = PROTOCOLS.get(name)
    episodes = episodes_of(HOME, protocol.directions, count)
    return episodes, episode_groups(episodes, protocol, EnvConfig())


def test_more_episodes_include_the_fewer():
    directions = PROTOCOLS.get("paper").directions
    few, many = episodes_of(HOME, directions, 2), episodes_of(HOME, directions, 5)
    assert many[: len(few)] == few
    assert len({episode.name for episode in many}) == len(many)


def test_the_paper_starts_above_the_target_in_four_directions():
    episodes, groups = starts("paper")
    (group,) = groups
    snapshot = group.simulation.snapshot
    turned = snapshot.trackers.euler[:, 2] - snapshot.targets.yaw
    wanted = np.array([episodes[row].direction for row in group.rows])
    assert np.exp(1j * turned) == pytest.approx(np.exp(1j * wanted))
    assert len(set(wanted)) == 4
    for group in groups:
        assert group.config.reward.view_range == 1.0
        assert (group.simulation.snapshot.episodes.reward > 0.9).all()


def test_a_search_starts_with_the_target_out_of_view():
    _, groups = starts("search", 4)
    for group in groups:
        assert (group.simulation.snapshot.episodes.reward == 0.0).all()
        pixels, _ = group.subjects()
        assert (pixels == 0).all()


def test_what_can_be_seen_in_a_search_is_measured_above_the_target():
    episodes, _ = starts("search", 1)
    assert max(clear_shares(episodes, PROTOCOLS.get("search"))) > 0.5


def test_distractors_look_like_the_target_and_one_is_beside_it():
    protocol = PROTOCOLS.get("distractor")
    episodes = with_neighbours(HOME, protocol, 2, 5)
    assert len(episodes) == 8
    for group in episode_groups(episodes, protocol, EnvConfig()):
        simulation, targets = group.simulation, group.simulation.snapshot.targets
        for tracker in range(len(group.rows)):
            actors, models = simulation.actors_around(tracker)
            assert len(set(models.tolist())) == 1
            away = np.linalg.norm(actors.position[0, :, :2] - targets.position[tracker, :2], axis=1)
            assert np.sort(away)[1] <= NEAR
    other = episode_groups(
        episodes_of(HOME, protocol.directions, 1), PROTOCOLS.get("long"), EnvConfig()
    )
    _, models = other[0].simulation.actors_around(0)
    assert len(set(models.tolist())) > 1


def test_the_rules_are_those_that_results_were_published_with():
    """A change of a hash makes all results so far incomparable, and has to be meant."""
    hashes = {
        "paper": "3509d940d9cb",
        "long": "226a9a65cbc8",
        "search": "54d18beb8abf",
        "distractor": "bb02db821cc8",
    }
    assert {name: PROTOCOLS.get(name).hash for name in hashes} == hashes


def test_a_flown_drone_flies_as_in_the_original_unless_told_and_its_results_are_apart():
    flown = PROTOCOLS.get("paper").changed({"tracker": {"supervised": False}})
    assert flown.settings.tracker.flight == "original"
    assert not flown.settings.tracker.off_centre  # as when the first results were published
    mended = flown.changed({"tracker": {"flight": "mended"}})
    assert len({PROTOCOLS.get("paper").hash, flown.hash, mended.hash}) == 3


@pytest.mark.parametrize(
    "changes",
    [
        {"lidar": {"max_range": 50.0, "noise": 0.3}},  # nobody has one
        {"tracker": {"flight": "original"}},  # nobody flies
        {"traffic": {"update_routes": False}},
        {"control": {"frequency": 125.0}, "sensors": {"imu": {"noise": 0.0}}},  # the defaults
        {"world": {"weather": "night"}, "target": "Pedestrian"},  # each episode has its own
        {"seed": 3},
    ],
)
def test_a_setting_without_effect_is_no_other_protocol(changes):
    assert PROTOCOLS.get("paper").changed(changes).hash == PROTOCOLS.get("paper").hash


@pytest.mark.parametrize(
    "changes",
    [
        {"lidar": {"enabled": True}},
        {"control": {"frequency": 100.0}},
        {"sensors": {"imu": {"noise": 0.1}}},
        {"traffic": {"max_vehicles": 41}},
        {"traffic": {"group_size": 4}},
        {"world": {"hour": 17.0}},
        {"camera": {"width": 85}},
    ],
)
def test_a_setting_with_an_effect_is_another_protocol(changes):
    assert PROTOCOLS.get("paper").changed(changes).hash != PROTOCOLS.get("paper").hash


class Lens(CameraConfig):
    distortion: float | None = None


class Later(EyasConfig):
    camera: Lens = Lens()


@pytest.mark.parametrize(("distortion", "same"), [(None, True), (0.1, False)])
def test_a_setting_that_comes_with_a_default_is_no_other_protocol(distortion, same):
    paper = PROTOCOLS.get("paper")
    camera = Lens(**paper.settings.camera.model_dump(), distortion=distortion)
    others = {name: getattr(paper.settings, name) for name in EyasConfig.model_fields}
    new = replace(paper)
    new.__dict__["settings"] = Later.model_construct(**{**others, "camera": camera})
    assert (new.hash == paper.hash) is same
