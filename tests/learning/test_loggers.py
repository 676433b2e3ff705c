"""Curves of a training in other tools: each block a point, ended whatever happens."""

import csv
import sys
from types import ModuleType

import pytest

pytest.importorskip("torch")

from eyas.engine.core.config import updated, validated
from eyas.engine.core.errors import EyasError
from eyas.engine.settings.config import EyasConfig
from eyas.learning.loggers import LOGGERS, _flat
from eyas.learning.trainer import train

LOGGED = []


class Own:
    """Notes what it gets."""

    def __init__(self, folder, settings):
        if settings["train"]["environments"] == 8:
            raise ConnectionError("no server")
        LOGGED.append((folder, settings["train"]["environments"]))

    def add(self, decisions, values):
        LOGGED.append((decisions, values))

    def end(self):
        LOGGED.append("end")


def small(*loggers):
    return validated(
        EyasConfig,
        {
            "env": {
                "action_repeat": 4,
                "observation": {"width": 24, "height": 24, "layout": "chw"},
            },
            "train": {
                "environments": 4,
                "n_steps": 8,
                "updates_per_block": 2,
                "hidden": 16,
                "evaluation": {"every": 0},
                "stages": [{"total_timesteps": 128}],
                "loggers": loggers,
            },
        },
    )


@pytest.fixture
def own(monkeypatch):
    module = ModuleType("my_logger")
    module.Own = Own
    monkeypatch.setitem(sys.modules, "my_logger", module)
    LOGGED.clear()
    return "my_logger:Own"


def test_each_block_is_a_point_with_the_numbers_of_the_curve(tmp_path, own):
    train(small(own), tmp_path, say=lambda _: None)
    first, *points, last = LOGGED
    assert (first, last) == ((tmp_path, 4), "end")
    with (tmp_path / "curve.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [decisions for decisions, _ in points] == [int(row["decisions"]) for row in rows]
    for (_, values), row in zip(points, rows, strict=True):
        assert values["episodes"] == float(row["episodes"])
        assert {*values} == {"decisions_per_second"} | {
            name for name, cell in row.items() if cell != "nan" and name != "decisions"
        }
        assert "tsr" not in values  # nothing was evaluated
        assert values["decisions_per_second"] > 0.0


def test_a_run_that_is_stopped_ends_its_loggers(tmp_path, own):
    def say(line):
        if "return" in line:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(small(own), tmp_path, say=say)
    assert LOGGED[-1] == "end"


def test_what_is_not_there_is_one_line_before_anything_is_made(tmp_path, monkeypatch):
    with pytest.raises(EyasError, match=r"^train\.loggers: 'wandbb' .*did you mean 'wandb'"):
        train(small("wandbb"), tmp_path / "a")
    assert not (tmp_path / "a").exists()
    monkeypatch.setitem(sys.modules, "mlflow", None)
    with pytest.raises(EyasError, match="'mlflow' is not installed: pip install mlflow"):
        LOGGERS.get("mlflow")(tmp_path, {})


def test_a_logger_that_cannot_begin_is_one_line(tmp_path, own):
    config = updated(small(own), {"train": {"environments": 8}})
    with pytest.raises(EyasError) as caught:
        train(config, tmp_path, say=lambda _: None)
    line = f"train.loggers: '{own}' cannot begin: ConnectionError: no server"
    assert str(caught.value) == line


def test_settings_are_flat_for_tools_that_want_them_so():
    assert _flat("", {"a": {"b": 1, "c": {}}, "d": [2]}) == [("a.b", 1), ("a.c", {}), ("d", [2])]
