"""What the options of commands mean together."""

import pytest
import typer
from typer.testing import CliRunner

from eyas.cli.app import _quiet, app
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.settings.file import load_settings
from eyas.engine.terminal.options import followed, gathered, recorded
from eyas.engine.traffic.library import CANONICAL_MIX


def test_short_options_win_over_set() -> None:
    said = ["world.map=desert", "world.weather=snow", "seed=7", "camera.width=64"]
    config = load_settings(None, gathered(said, "lake", "foggy", 3))
    assert (config.world.map, config.world.weather, config.seed) == ("lake", "foggy", 3)
    assert config.camera.width == 64


def test_short_options_that_are_not_given_change_nothing() -> None:
    config = load_settings(None, gathered(["world.map=desert", "seed=7"]))
    assert (config.world.map, config.seed) == ("desert", 7)


def test_quiet_before_a_command_makes_all_quiet_that_can_be() -> None:
    defaults = _quiet(typer.main.get_command(app))
    assert defaults["video"] == defaults["train"] == defaults["evaluate"] == {"quiet": True}
    assert defaults["dataset"]["make"] == {"quiet": True}
    assert defaults["config"]["show"] == {}


def test_verify_has_an_exit_code_of_its_own_if_anything_differs(monkeypatch) -> None:
    for same, code in ((True, 0), (False, 1)):
        monkeypatch.setattr("eyas.cli.verify.run.run", lambda same=same, **_: same)
        assert CliRunner().invoke(app, ["verify", "--quick"]).exit_code == code


def test_the_options_of_a_recording_are_its_settings() -> None:
    said = recorded(frames=7, episodes=3, drones=2, size="320x240", fps=10.0)
    config = load_settings(None, said)
    video, camera = config.video, config.camera
    assert (video.episode_frames, video.episodes, video.channels, video.fps) == (7, 3, 2, 10.0)
    assert (camera.width, camera.height) == (320, 240)
    assert recorded(frames=None, episodes=None, drones=None, size=None, fps=None) == []


def test_episodes_without_frames_last_as_long_as_a_recording_without_either() -> None:
    said = recorded(frames=None, episodes=2, drones=None, size=None, fps=None)
    video = load_settings(None, said).video
    assert (video.episodes, video.episode_frames) == (2, 150)
    assert video.episode_frames == video.total_time * video.fps


@pytest.mark.parametrize("size", ["640", "640x", "640*480", "x480", "640x480x3", "-1x480"])
def test_a_size_of_another_form_is_one_line(size) -> None:
    with pytest.raises(ConfigError, match=r"^--size: .*WxH in pixels, such as 640x480$"):
        recorded(frames=None, episodes=None, drones=None, size=size, fps=None)


def test_a_class_of_vehicles_is_followed_in_a_mixed_fleet_by_a_drone_each() -> None:
    config = load_settings(None, followed("motorbike"))
    assert config.start.vehicles == ("motorcycle",)
    assert config.traffic.vehicle_type == CANONICAL_MIX
    assert config.video.channels == 2  # of forty vehicles
    assert load_settings(None, followed("bus")).video.channels == 4
    cars = load_settings(None, followed("car"))
    assert (cars.start.vehicles, cars.traffic.vehicle_type) == (("passenger",), "passenger")
    assert load_settings(None, followed("Pedestrian")).target == "Pedestrian"


def test_an_unknown_target_is_one_line_with_the_nearest_name() -> None:
    with pytest.raises(UnknownNameError, match=r"^--target: 'Shrim' .*did you mean 'Shrimp'"):
        followed("Shrim")
