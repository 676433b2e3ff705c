"""Self-play of a tracker and a driver."""

import json

import numpy as np
import pytest

from eyas.engine.core.config import updated
from eyas.engine.core.errors import EyasError
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import preset_file

pytest.importorskip("torch")
pytest.importorskip("onnx")
from eyas.engine.behaviours.evading import CAR_SEEN
from eyas.learning.pursuit.network import DRIVER_ACTIONS, driver_actions
from eyas.learning.run import run

FEW = {
    "train": {
        "environments": 2,
        "n_steps": 10,
        "updates_per_block": 1,
        "hidden": 8,
        "stages": [{"total_timesteps": 40}],
    }
}


def settings(**changes):
    return updated(updated(load_settings(preset_file("pursuit")), FEW), changes)


@pytest.mark.slow
def test_a_duel_that_is_resumed_is_that_which_never_stopped(tmp_path, monkeypatch):
    from eyas.learning.pursuit import training

    whole, cut = tmp_path / "whole", tmp_path / "cut"
    policy = run(settings(), whole, resume=False, quiet=True, ray=False)
    block = training._block

    def stops(config, duel, tracker, driver, progress, say):
        if progress.block == 1:
            raise KeyboardInterrupt
        block(config, duel, tracker, driver, progress, say)

    monkeypatch.setattr(training, "_block", stops)
    with pytest.raises(KeyboardInterrupt):
        run(settings(), cut, resume=False, quiet=True, ray=False)
    monkeypatch.setattr(training, "_block", block)
    again = run(settings(), cut, resume=True, quiet=True, ray=False)
    assert again.read_bytes() == policy.read_bytes()
    assert (cut / "curve.csv").read_text() == (whole / "curve.csv").read_text()
    ort = pytest.importorskip("onnxruntime")
    network = ort.InferenceSession(str(policy))
    (logits,) = network.run(None, {"seen": np.zeros((3, len(CAR_SEEN)), np.float32)})
    assert logits.shape == (3, DRIVER_ACTIONS)


def test_actions_of_the_network_are_speeds_of_the_road_and_turns():
    seen = np.zeros((3, len(CAR_SEEN)))
    seen[:, CAR_SEEN.index("limit")] = 10.0
    actions = driver_actions(np.array([0, 7, 11]), seen)
    assert actions.tolist() == [[0.0, 1.0], [10.0, 0.0], [14.5, -1.0]]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"target": "Pedestrian", "start": {"vehicles": None}}, "target: 'Pedestrian' cannot be"),
        ({"train": {"n_steps": 12}}, "train.n_steps: 12 is not allowed: a multiple of 5"),
        ({"traffic": {"seed": 900_000_001}}, "traffic.seed: 900000001 is not allowed: seeds from"),
        ({"evader": {"driver": "hide"}}, "evader.driver: 'hide' is not allowed with agents="),
    ],
)
def test_what_cannot_be_trained_is_said_before_it_begins(changes, said, tmp_path):
    with pytest.raises(EyasError) as error:
        run(settings(**changes), tmp_path / "run", resume=False, quiet=True, ray=False)
    assert said in str(error.value)
    assert json.dumps(str(error.value)).count("\\n") == 0
    assert not (tmp_path / "run").exists()
