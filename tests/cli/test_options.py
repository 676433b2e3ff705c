"""What the options of commands mean together."""

import typer
from typer.testing import CliRunner

from eyas.cli.app import _quiet, app
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


def test_quiet_before_a_command_makes_all_quiet_that_can_be() -> None:
    defaults = _quiet(typer.main.get_command(app))
    assert defaults["video"] == defaults["train"] == defaults["evaluate"] == {"quiet": True}
    assert defaults["dataset"]["make"] == {"quiet": True}
    assert defaults["config"]["show"] == {}


def test_verify_has_an_exit_code_of_its_own_if_anything_differs(monkeypatch) -> None:
    for same, code in ((True, 0), (False, 1)):
        monkeypatch.setattr("eyas.cli.verify.run.run", lambda same=same, **_: same)
        assert CliRunner().invoke(app, ["verify", "--quick"]).exit_code == code
