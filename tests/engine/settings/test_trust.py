"""Code that settings name: run only if its user has named it, or trusts the file that does."""

import json
import os
import subprocess
import sys

import pytest

from eyas.cli.main import main
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.named_code import code_named
from eyas.engine.core.registry import Registry
from eyas.engine.custom.user_class import made
from eyas.engine.envs.choice import chosen_settings
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.trust import TRUST_VARIABLE, code_of
from eyas.engine.task.config import RewardConfig
from eyas.engine.task.terms import RewardTerms
from eyas.engine.trackers.config import TrackerConfig
from eyas.engine.trackers.kinds import tracker_of

NAMING = {
    "world.map": {"world": {"map": "someones:IT"}},
    "reward.terms": {"reward": {"terms": {"someones:IT": 1.0}}},
    "evader.reward": {"evader": {"reward": {"someones:IT": 1.0}}},
    "custom.path": {"custom": {"path": "someones:IT"}},
    "tracker.kind": {"tracker": {"kind": "someones:IT"}},
    "video.writers": {"video": {"writers": ["jpeg", "someones:IT"]}},
}
INSIDE = {
    "env.mixture.1.settings.": lambda inner: {"env": {"mixture": [{}, {"settings": inner}]}},
    "train.stages.0.settings.": lambda inner: {
        "train": {"stages": [{"total_timesteps": 1000, "settings": inner}]}
    },
}
HARMFUL = "raise BaseException('it was imported')"


@pytest.fixture
def someones(tmp_path, monkeypatch):
    """A module that must not be imported, and a folder for files."""
    (tmp_path / "someones.py").write_text(HARMFUL)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delenv(TRUST_VARIABLE, raising=False)
    return tmp_path


def file_with(folder, values):
    path = folder / "settings.json"
    path.write_text(json.dumps(values))
    return path


@pytest.mark.parametrize("setting", NAMING)
@pytest.mark.parametrize("place", ["", *INSIDE])
def test_a_file_that_names_code_is_refused_with_all_that_would_run(someones, setting, place):
    values = INSIDE[place](NAMING[setting]) if place else NAMING[setting]
    path = file_with(someones, values)
    with pytest.raises(ConfigError) as caught:
        load_settings(path)
    line = str(caught.value)
    assert line.startswith(f"{path}: this file would run code: 'someones:IT' ({place}{setting}); ")
    assert "--trust" in line
    assert TRUST_VARIABLE in line
    assert list(code_of(load_settings(path, trust=True))) == [(place + setting, "someones:IT")]
    with pytest.raises(ConfigError, match="would run code"):
        chosen_settings(str(path))
    assert chosen_settings(values) == load_settings(path, trust=True)  # a user's own dictionary


def test_code_that_the_command_line_names_again_is_the_user_s(someones):
    path = file_with(someones, NAMING["reward.terms"] | NAMING["world.map"])
    with pytest.raises(ConfigError, match=r"run code: 'someones:IT' \(world\.map\)"):
        load_settings(path, ['reward.terms={"speed": 1}'])
    load_settings(path, ['reward.terms={"speed": 1}', "world.map=lake"])
    load_settings(path, ['reward.terms={"someones:IT": 2}'])


def test_a_folder_can_be_trusted(someones, monkeypatch):
    path = file_with(someones, NAMING["custom.path"])
    (someones / "other").mkdir()
    (someones / "other" / "link").symlink_to(path)
    monkeypatch.setenv(TRUST_VARIABLE, f":{someones / 'other'}:")
    for refused in (path, someones / "other" / "link", someones / "other" / ".." / path.name):
        with pytest.raises(ConfigError, match="would run code"):
            load_settings(refused)
    monkeypatch.setenv(TRUST_VARIABLE, f"{someones / 'other'}:{someones}")
    load_settings(path)
    monkeypatch.setenv(TRUST_VARIABLE, ".")
    monkeypatch.chdir(someones)
    with pytest.raises(ConfigError, match=r"^EYAS_TRUST: '\.' is not allowed: absolute folders"):
        load_settings(path)


@pytest.mark.parametrize(
    "command",
    [["video"], ["train"], ["demo", "--headless"], ["traffic", "record"], ["serve", "--root", "."]],
    ids=lambda command: command[0],
)
def test_each_command_refuses_and_is_told_to_trust_by_a_flag(someones, command, monkeypatch, capfd):
    monkeypatch.chdir(someones)
    file_with(someones, NAMING["world.map"] | NAMING["custom.path"])
    for flag, line in (([], "would run code"), (["--trust"], "tried to end the program")):
        monkeypatch.setattr(sys, "argv", ["eyas", *command, "--config", "settings.json", *flag])
        with pytest.raises(SystemExit) as caught:
            main()
        said = capfd.readouterr().err
        assert caught.value.code == 2
        assert line in said
        assert "Traceback" not in said
    assert "someones" not in sys.modules


def test_every_table_s_setting_is_marked_as_one_that_names_code():
    import eyas.engine.custom.user_class
    import eyas.engine.exports.registry
    import eyas.engine.trackers.kinds
    import eyas.engine.world.maps

    modules = (
        eyas.engine.custom.user_class,
        eyas.engine.exports.registry,
        eyas.engine.trackers.kinds,
        eyas.engine.world.maps,
    )
    tables = [each for m in modules for each in vars(m).values() if isinstance(each, Registry)]
    found = {
        setting for values in NAMING.values() for setting, _ in code_named(EyasConfig(**values))
    }
    assert {table._setting for table in tables} <= found
    assert len(tables) == 4


@pytest.mark.parametrize("name", ["os:abort", "sys:exit", "pdb:set_trace", "time:sleep", "pdb:Pdb"])
def test_what_is_no_term_is_refused_before_it_is_called(name):
    with pytest.raises(ConfigError, match=rf"^reward\.terms: '{name}' ") as caught:
        RewardTerms(RewardConfig(terms={name: 1.0}))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["pdb:Pdb", "subprocess:Popen", "builtins:object"])
def test_what_is_no_target_is_refused_before_it_is_made(name):
    with pytest.raises(ConfigError, match=rf"^custom\.path: '{name}': it has not all of: size"):
        made(name)


OF_MINE = """
import sys

class Target:
    size = (1.0, 1.0, 1.0)
    def parts(self):
        sys.exit(0)
    def pose(self, ride): ...

def tracker(config):
    sys.exit("enough")
"""


def test_user_s_code_that_ends_the_program_is_an_error(tmp_path, monkeypatch):
    (tmp_path / "of_mine.py").write_text(OF_MINE)
    (tmp_path / "ends.py").write_text("raise SystemExit")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ConfigError, match=r"parts\(\) raised SystemExit: 0"):
        made("of_mine:Target")
    with pytest.raises(
        ConfigError, match=r"'of_mine:tracker': .* the program: SystemExit\(enough\)"
    ):
        tracker_of(TrackerConfig(kind="of_mine:tracker"))
    with pytest.raises(ConfigError, match=r"'ends:it': its code tried to end the program"):
        RewardTerms(RewardConfig(terms={"ends:it": 1.0}))


def test_a_module_in_the_current_folder_is_found_last(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    (tmp_path / "calm_term.py").write_text("def calm(offset):\n    return offset\n")
    (tmp_path / "colorsys.py").write_text(HARMFUL)  # has the name of a module of Python
    RewardTerms(RewardConfig(terms={"calm_term:calm": 1.0}))
    assert sys.path[-1] == str(tmp_path)
    with pytest.raises(ConfigError, match=r"the module 'colorsys' has no 'calm'"):
        RewardTerms(RewardConfig(terms={"colorsys:calm": 1.0}))


@pytest.mark.slow
def test_a_module_in_the_current_folder_is_not_looked_for_where_that_is_forbidden(tmp_path):
    (tmp_path / "calm_term.py").write_text("def calm(offset):\n    return offset\n")
    asked = ("--set", 'reward.terms={"calm_term:calm": 1.0}', "--set", "video.total_time=0.1")
    done = subprocess.run(
        [sys.executable, "-m", "eyas", "video", *asked, "--out", tmp_path / "out"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONSAFEPATH": "1"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert "Python does not look because of PYTHONSAFEPATH" in done.stderr
