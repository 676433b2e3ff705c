"""What the options of commands mean together."""

from eyas.engine.settings.file import load_settings
from eyas.engine.terminal.options import gathered


def test_short_options_win_over_set() -> None:
    said = ["world.map=desert", "world.weather=snow", "seed=7", "camera.width=64"]
    config = load_settings(None, gathered(said, "lake", "foggy", 3))
    assert (config.world.map, config.world.weather, config.seed) == ("lake", "foggy", 3)
    assert config.camera.width == 64


def test_short_options_that_are_not_given_change_nothing() -> None:
    config = load_settings(None, gathered(["world.map=desert", "seed=7"]))
    assert (config.world.map, config.seed) == ("desert", 7)
