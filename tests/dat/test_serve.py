import json
import logging

import pytest

from eyas.dat.serve import run as modes_serve
from eyas.dat.serve.run import run, tell_disagreements
from eyas.dat.wire.exchange import SETTINGS_FILE
from eyas.engine.core.errors import UnknownNameError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings


@pytest.fixture
def served(monkeypatch):
    """The servers that are started, in the place of serving."""
    started = []
    monkeypatch.setattr(modes_serve, "serve", lambda server, until_idle: started.append(server))
    return started


def test_clients_find_the_settings_in_a_folder_that_had_none(tmp_path, served):
    config = load_settings(None, ["Config_Agen_Num_Port=35531", "Control_Frequence=250"])
    run(config, tmp_path)
    assert len(served) == 1
    written = json.loads((tmp_path / SETTINGS_FILE).read_text())
    assert (written["Tracker_Def"], written["Control_Frequence"]) == ("DRONE", 250)
    assert load_settings(tmp_path / SETTINGS_FILE).wire.port == 35531


def test_settings_that_are_there_stay_as_they_are(tmp_path, served, caplog):
    path = tmp_path / SETTINGS_FILE
    path.parent.mkdir(parents=True)
    path.write_text('{"Tracker_Def": "DRONE", "Control_Frequence": 100, "Unknown": 1}')
    run(EyasConfig(), tmp_path)
    assert path.read_text() == '{"Tracker_Def": "DRONE", "Control_Frequence": 100, "Unknown": 1}'
    (line,) = caplog.messages
    assert line.startswith(f"{path}: Control_Frequence is 100, but is served as 125.0: ")


def test_a_map_that_does_not_exist_is_told_before_anyone_waits(tmp_path, served):
    config = load_settings(None, ["World_Path=worlds/lakeside-day.wbt"])
    with pytest.raises(UnknownNameError, match=r"^world\.map"):
        run(config, tmp_path)
    assert not served


@pytest.mark.parametrize(
    ("key", "value", "line"),
    [
        ("port_process", 33727, "port_process is 33727, but is served as 38711: "),
        ("Control_Frequence", 100, "Control_Frequence is 100, but is served as 125.0: "),
        ("RewardParams", False, "RewardParams is false, but is served as true: "),
        ("CloudPoint", True, "CloudPoint is true, but is served as false: "),
    ],
)
def test_each_setting_of_the_clients_that_differs_is_one_line(tmp_path, caplog, key, value, line):
    path = tmp_path / "Alg_Base" / "DAT_Benchmark" / "config.json"
    path.parent.mkdir(parents=True)
    alike = {"port_process": 38711, "Control_Frequence": 125, "RewardParams": True, "scene": "x"}
    path.write_text(json.dumps({"Benchmark": alike}))
    tell_disagreements(EyasConfig(), tmp_path, tmp_path / SETTINGS_FILE)
    assert not caplog.messages
    path.write_text(json.dumps({"Benchmark": {**alike, key: value}}))
    tell_disagreements(EyasConfig(), tmp_path, tmp_path / SETTINGS_FILE)
    (told,) = caplog.messages
    assert told.startswith(f"{path}: {line}")


@pytest.mark.parametrize("content", ["{", "[]", '{"Benchmark": 3}', "\x00"])
def test_a_file_of_the_clients_that_cannot_be_read_stops_nobody(tmp_path, caplog, content):
    path = tmp_path / "Alg_Base" / "DAT_Benchmark" / "config.json"
    path.parent.mkdir(parents=True)
    path.write_text(content)
    with caplog.at_level(logging.WARNING, "eyas"):
        tell_disagreements(EyasConfig(), tmp_path, tmp_path / SETTINGS_FILE)
    assert len(caplog.messages) <= 1
