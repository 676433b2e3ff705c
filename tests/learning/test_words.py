"""Teaching the listener's network: dressed traffic, lessons, its file, a run."""

from contextlib import nullcontext

import numpy as np
import onnxruntime
import pytest
import torch
from typer.testing import CliRunner

from eyas.benchmark.policies.listener.detector import NAMES, OUTPUTS, STRIDE, VehicleDetector
from eyas.benchmark.policies.shipped import file_of
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.policies.tracker.metadata import OBSERVED
from eyas.cli.app import app
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError, OutputError
from eyas.engine.policies.policy import env_config
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import preset_file
from eyas.engine.targets.colour_names import COLOUR_NAMES
from eyas.learning.words.network import ListenerNetwork
from eyas.learning.words.scenes import PLACES, Scenes, Vehicles, drawn
from eyas.learning.words.training import LISTENER, export, lesson, loss_of, train

PRESET = load_settings(preset_file("eyas-words"))
SIZE = 24, 32


def network():
    torch.manual_seed(3)
    return ListenerNetwork(SIZE, width=16)


def squares(count=64):
    """Pictures with one square of a colour each, on grey."""
    rng = np.random.default_rng(5)
    picture = rng.integers(90, 110, (count, 3, *SIZE)).astype(np.uint8)
    place = rng.uniform(3.0, (SIZE[1] - 3, SIZE[0] - 3), (count, 2)).astype(np.float32)
    colour = rng.integers(0, 2, count)
    for k, (column, row) in enumerate(place.astype(int).tolist()):
        picture[k, :, row - 2 : row + 2, column - 2 : column + 2] = 0
        picture[k, 2 * colour[k], row - 2 : row + 2, column - 2 : column + 2] = 250
    heading = np.tile(np.array((1.0, 0.0), np.float32), (count, 1))
    vehicles = Vehicles(
        np.arange(count), place, heading, colour, colour, np.ones(count, np.float32)
    )
    return Scenes(picture, vehicles)


def test_it_learns_to_find_squares_and_their_colours():
    learner, scenes, rng = network(), squares(), np.random.default_rng(7)
    optimiser = torch.optim.AdamW(learner.parameters(), 8e-3)
    for _ in range(40):
        loss = loss_of(learner, lesson(scenes, rng.permutation(64)[:32], learner.grid, rng))
        optimiser.zero_grad()
        loss.total.backward()
        optimiser.step()
    assert loss.colour > 0.95
    learner.eval()
    with torch.no_grad():
        vehicle, places, *_ = learner(torch.from_numpy(scenes.picture))
    best = vehicle.argmax(1)
    off = places[torch.arange(64), best] - torch.from_numpy(scenes.vehicles.place)
    assert off.square().sum(1).sqrt().median() < 2.5


def test_a_lesson_keeps_place_heading_and_picture_together():
    scenes, rng = squares(), np.random.default_rng(2)
    rows = rng.permutation(64)[:48]
    shown = lesson(scenes, rows, network().grid, rng)
    assert sorted(shown.vehicle.tolist()) == list(range(48))
    for k, place, colour in zip(shown.vehicle, shown.place, shown.colour, strict=True):
        assert colour == scenes.vehicles.colour[rows[k]]
        bright = shown.picture[k, 2 * colour] - shown.picture[k, 2 - 2 * colour]
        row, column = divmod(int(bright.argmax()), SIZE[1])
        assert max(abs(column + 0.5 - place[0]), abs(row + 0.5 - place[1])) < 4.0
    across = shown.heading[:, 0]
    assert set(across.tolist()) == {-1.0, 1.0}  # some are mirrored
    peak = shown.peaks.argmax(1)
    middle = torch.stack((peak % 8, peak // 8), 1) * STRIDE + 0.5 * STRIDE
    order = shown.vehicle.argsort()
    assert (middle - shown.place[order]).abs().max() <= STRIDE


def test_the_file_answers_as_the_network(tmp_path):
    learner = network()
    lessons = lesson(squares(), np.arange(32), learner.grid, np.random.default_rng(1))
    loss_of(learner, lessons)  # norms have learned something
    learner.eval()
    env = env_config(
        {
            "actions": "velocity",
            "action_repeat": 8,
            "observation": {**OBSERVED, "width": SIZE[1], "height": SIZE[0]},
        }
    )
    export(learner, env, LISTENER, tmp_path / "policy.onnx")
    picture = torch.from_numpy(squares(4).picture)
    with torch.no_grad():
        wanted = learner(picture)
    session = onnxruntime.InferenceSession(tmp_path / "policy.onnx")
    for one, other in zip(session.run(OUTPUTS, {"image": picture.numpy()}), wanted, strict=True):
        np.testing.assert_allclose(one, other.numpy(), atol=2e-2)
    policy = open_policy(str(tmp_path / "policy.onnx"), {})
    assert policy.settings == LISTENER
    assert policy.told == {"attributes"}


@pytest.fixture(scope="module")
def scenes():
    """Two pictures of each place, of a block that no training has drawn."""
    return drawn(PRESET.env, 2**20, 0, 16)


@pytest.mark.slow
def test_labels_are_where_the_colour_is(scenes):
    """By day, paint of a strong colour is seen in the middle of clear vehicles."""
    vehicles = scenes.vehicles
    day = [k for k, place in enumerate(PLACES) if place.weather == "day"]
    checked = right = 0
    for k in np.flatnonzero(vehicles.share > 0.95):
        colour = np.array(list(COLOUR_NAMES.values())[vehicles.colour[k]])
        if vehicles.picture[k] // 2 not in day or vehicles.colour[k] < 0 or np.ptp(colour) < 0.4:
            continue
        column, row = vehicles.place[k].astype(int).tolist()
        near = scenes.picture[
            vehicles.picture[k], :, max(row - 5, 0) : row + 6, max(column - 5, 0) : column + 6
        ]
        strong, weak = colour.argmax(), colour.argmin()
        checked += 1
        right += (near[strong].astype(int) - near[weak]).max() > 40
    assert checked >= 8
    assert right >= 0.9 * checked


@pytest.mark.slow
def test_the_shipped_network_finds_and_names_vehicles(scenes):
    session = onnxruntime.InferenceSession(file_of("eyas-words"))
    found = VehicleDetector(session, 4.4).find(scenes.picture)
    vehicles, named, hits, many = scenes.vehicles, [], 0, 0
    for k in np.flatnonzero(vehicles.share > 0.6):
        one = found[vehicles.picture[k]]
        away = np.square(one.place - vehicles.place[k]).sum(axis=1)
        many += 1
        if not len(away) or away.min() > 36.0:
            continue
        hits += 1
        best = away.argmin()
        named.append(
            (
                one.colour[best].argmax() == vehicles.colour[k],
                one.body[best].argmax() == vehicles.body[k],
            )
        )
    assert many > 60
    assert hits > 0.85 * many
    colour, body = np.mean(named, axis=0)
    assert colour > 0.6
    assert body > 0.7
    assert set(vehicles.colour.tolist()) <= set(range(-1, len(NAMES)))


class StoppedError(Exception):
    """A training is interrupted."""


def trained(folder, lines=None, resume=False, **changes):
    """Train two blocks of 32 pictures; stop after some lines."""
    small = {"train": {"words": {"blocks": 2, "scenes": 32, "passes": 1}}}
    said = []

    def say(line):
        said.append(line)
        if len(said) == lines:
            raise StoppedError

    config = updated(updated(PRESET, small), changes)
    with nullcontext() if lines is None else pytest.raises(StoppedError):
        train(config, folder, resume=resume, say=say)
    return {
        path.name: path.read_bytes() for path in folder.iterdir() if path.name != "checkpoint.pt"
    }


@pytest.mark.slow
def test_an_interrupted_training_goes_on_to_the_same_bytes(tmp_path):
    whole = trained(tmp_path / "whole")
    assert len(whole["curve.csv"].splitlines()) == 3
    assert "policy.onnx" not in trained(tmp_path / "cut", lines=2)
    assert trained(tmp_path / "cut", resume=True) == whole
    with pytest.raises(OutputError, match="has a run already"):
        trained(tmp_path / "cut")
    with pytest.raises(OutputError, match="other settings"):
        trained(tmp_path / "cut", resume=True, seed=1)


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"world": {"map": "village"}}, "world: not allowed here"),
        ({"env": {"actions": "discrete"}}, "env: not allowed here"),
        ({"train": {"begin_from": "runs/eyas"}}, "begin_from: not allowed"),
    ],
)
def test_what_would_change_nothing_is_refused(changes, why, tmp_path):
    with pytest.raises(ConfigError, match=why):
        trained(tmp_path / "run", **changes)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("option", "why"),
    [
        (["--ray"], "--ray: not allowed with train.method 'words'"),
        (["--device", "cuda"], "train.device: 'cuda' is not allowed with train.method 'words'"),
    ],
)
def test_it_is_taught_in_one_process_on_this_processor(option, why, tmp_path):
    command = ["train", "--preset", "eyas-words", "--out", str(tmp_path / "run"), *option]
    result = CliRunner().invoke(app, command)
    assert result.exit_code != 0
    assert why in str(result.exception)


def test_steps_are_pictures_in_lessons():
    words = PRESET.train.words
    assert PRESET.train.scaled(words.pictures // 2) == {"words": {"blocks": words.blocks // 2}}
    assert PRESET.train.scaled(1) == {"words": {"blocks": 1}}
