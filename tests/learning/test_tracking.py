"""Teaching the tracker's network: pictures, samples, lessons, its file."""

import json
from contextlib import nullcontext

import numpy as np
import onnxruntime
import pytest
import torch
from typer.testing import CliRunner

from eyas.benchmark.episodes.episode import Place
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.policies.tracker.course import HORIZONS, PAST
from eyas.benchmark.policies.tracker.detector import OUTPUTS
from eyas.benchmark.policies.tracker.metadata import OBSERVED
from eyas.benchmark.policies.tracker.settings import FLOWN, TrackerSettings
from eyas.benchmark.protocols.table import protocol_named
from eyas.cli.app import app
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError, DataFileError, OutputError
from eyas.engine.policies.policy import env_config
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import preset_file
from eyas.learning.tracking import driving, flights, lessons
from eyas.learning.tracking.driving import Forecast, driven, taught_forecast
from eyas.learning.tracking.export import export
from eyas.learning.tracking.flights import Oracle, Pupil
from eyas.learning.tracking.lessons import GROUP, Samples, Shots, load, loss_of, save, taught
from eyas.learning.tracking.network import DetectorNetwork
from eyas.learning.tracking.training import train

SIZE = 24, 32
ENV = env_config(
    {
        "actions": "velocity",
        "action_repeat": 4,
        "observation": {**OBSERVED, "width": SIZE[1], "height": SIZE[0]},
    }
)


def network():
    torch.manual_seed(3)
    return DetectorNetwork(SIZE, width=16, keys=8)


def spots(count=12, times=8, colour=(250, 250, 250)):
    """Pictures with one spot, which is the target, or none."""
    rng = np.random.default_rng(5)
    picture = rng.integers(0, 60, (count, times, 3, *SIZE)).astype(np.uint8)
    place = rng.uniform(2.0, (SIZE[1] - 2, SIZE[0] - 2), (count, times, 2)).astype(np.float32)
    share = (rng.random((count, times)) < 0.7).astype(np.float32)
    for flight, time in np.argwhere(share > 0):
        column, row = place[flight, time].astype(int)
        spot = picture[flight, time, :, row - 1 : row + 2, column - 1 : column + 2]
        spot[:] = np.array(colour)[:, None, None]
    nan = np.full_like(place, np.nan)
    return Shots(picture, place, share, nan, nan[..., 0], np.ones_like(share, bool))


def test_it_learns_to_find_spots():
    learner, rng = network(), np.random.default_rng(7)
    assert len(list(taught(learner, Samples(spots(), rng), 40, 8e-3, rng))) == 10
    rng = np.random.default_rng(9)
    sample = Samples(spots(), rng).draw(32)
    with torch.no_grad():
        before, after = (
            loss_of(each, sample, np.random.default_rng(0)) for each in (network(), learner)
        )
    assert after.cells < 0.7 * before.cells


def test_it_learns_whose_key_it_is(monkeypatch):
    """Spots of two colours, anywhere: with the key of one colour those of the other are not seen,
    which lessons without keys of others do not teach.
    """
    colours = (250, 40, 40), (40, 40, 250)
    shots = [spots(colour=colour) for colour in colours]
    monkeypatch.setattr(lessons.Samples, "_changed", unchanged)
    margin = {}
    for impostors, apart in ((lessons._IMPOSTORS, lessons._APART), (0.0, 0.0)):
        monkeypatch.setattr(lessons, "_IMPOSTORS", impostors)
        monkeypatch.setattr(lessons, "_APART", apart)
        learner, rng = network(), np.random.default_rng(7)
        list(taught(learner, Samples(Shots.joined(shots), rng), 60, 8e-3, rng))
        seen = [Samples(each, np.random.default_rng(9)).draw(8) for each in shots]
        margin[impostors > 0] = np.mean([by_key(learner, *pair) for pair in (seen, seen[::-1])])
    assert margin[True] > 0.25 > 2.0 * abs(margin[False])


def unchanged(_, picture):
    return picture, np.zeros((len(picture), 2), bool)


def by_key(learner, one, other):
    """Return by how much likelier targets are thought seen with keys of theirs than of others."""
    with torch.no_grad():
        keys = []
        for each in (one, other):
            answers = learner.see(each.picture)[1]
            cell = (each.place / 4).long().clamp(min=0)
            cell = cell[:, 1].clamp(max=5) * (SIZE[1] // 4) + cell[:, 0].clamp(max=7)
            keys.append(learner.keys_of(answers)[torch.arange(len(cell)), cell][each.seen].mean(0))
        features, answers = learner.see(one.picture)
        many, wide = torch.ones(len(one.place), 1), torch.full((len(one.place), 1), 20.0)
        own, others = (
            learner.scores(features, answers, (one.place, wide, key * many, many)) for key in keys
        )
        unseen = [torch.softmax(each, 1)[:, -1][one.seen].mean() for each in (own, others)]
    return float(unseen[1] - unseen[0])


def test_a_sample_keeps_place_and_picture_together():
    sample = Samples(spots(), np.random.default_rng(2)).draw(64)
    assert len(sample.picture) == 64 * GROUP
    assert sample.seen.any()
    for picture, place in zip(sample.picture[sample.seen], sample.place[sample.seen], strict=True):
        row, column = divmod(int(picture.mean(0).argmax()), SIZE[1])
        assert abs(column + 0.5 - float(place[0])) < 2.6
        assert abs(row + 0.5 - float(place[1])) < 2.6


def test_the_file_answers_as_the_network(tmp_path):
    learner = network()
    forecast = Forecast()
    forecast.mean.copy_(torch.arange(PAST))
    export(learner, forecast, ENV, TrackerSettings(gate=2.5), tmp_path / "policy.onnx")
    sample = Samples(spots(), np.random.default_rng(2)).draw(2)
    picture = sample.picture.to(torch.uint8)
    known = (torch.arange(len(picture)) % 2).float()[:, None]
    key, spread = torch.randn(len(picture), learner.keys), sample.spread[:, None]
    with torch.no_grad():
        features, answers = learner.see(picture)
        scores = learner.scores(features, answers, (sample.expected, spread, key, known))
        past = 9.0 * torch.randn(len(picture), PAST)
        wanted = scores, learner.places(answers), learner.keys_of(answers), forecast(past)
    feed = {"image": picture, "expected": sample.expected, "spread": spread}
    feed |= {"key": key, "known": known, "past": past}
    session = onnxruntime.InferenceSession(tmp_path / "policy.onnx")
    found = session.run(OUTPUTS, {name: part.numpy() for name, part in feed.items()})
    for one, other in zip(found, wanted, strict=True):
        np.testing.assert_allclose(one, other.numpy(), atol=2e-2)
    assert open_policy(str(tmp_path / "policy.onnx"), {}).settings.gate == 2.5


@pytest.fixture(scope="module")
def policy(tmp_path_factory):
    path = tmp_path_factory.mktemp("tracker") / "policy.onnx"
    export(network(), Forecast(), ENV, TrackerSettings(), path)
    return path


@pytest.mark.parametrize("who", ["oracle", "pupil"])
def test_pictures_of_flights(policy, who, tmp_path):
    rng = np.random.default_rng(1)
    pilot = Oracle(ENV, rng) if who == "oracle" else Pupil(open_policy(str(policy), {}), rng)
    protocol = protocol_named("paper").changed({"done": {"total_steps": 400}})
    episodes = protocol.choose(
        [Place("citystreet", "day", "SUMO_VEHICLE")], protocol, 1, 60_000_000
    )
    for _ in BatchFlight(episodes, protocol, pilot, delay_from("0")).fly():
        pass
    save(Shots.of(pilot.shots), tmp_path / "shots.npz")
    shots = load(tmp_path / "shots.npz")
    assert shots.picture.shape == (4, 7, 3, *SIZE)
    assert shots.flown.all()
    np.testing.assert_allclose(shots.place[:, 0], np.tile((16.0, 12.0), (4, 1)), atol=4.0)
    assert np.isnan(shots.spread).all() == (who == "oracle")
    if who == "pupil":  # the first box tells the place
        np.testing.assert_allclose(shots.expected[:, 0], shots.place[:, 0], atol=1.5)


ROUNDS = [{"flights": 1, "steps": 10}, {"flights": 0, "steps": 10}]


def config(**changes):
    """Settings of a small training."""
    small = {
        "env": {"observation": {"width": SIZE[1], "height": SIZE[0]}},
        "train": {"tracker": {"rounds": ROUNDS}},
    }
    return updated(updated(load_settings(preset_file("eyas")), small), changes)


class StoppedError(Exception):
    """A training is interrupted."""


def trained(folder, lines=None, resume=False, **changes):
    """Train on pictures and a forecast that are there already; stop after some lines."""
    folder.mkdir(exist_ok=True)
    torch.manual_seed(4)
    torch.save(Forecast().state_dict(), folder / "forecast.pt")
    save(spots(), folder / "shots-000.npz")
    said = []

    def say(line):
        said.append(line)
        if len(said) == lines:
            raise StoppedError

    with nullcontext() if lines is None else pytest.raises(StoppedError):
        train(config(**changes), folder, resume=resume, say=say)
    return {name: (folder / name).read_bytes() for name in ("policy.onnx", "curve.csv")}


def test_an_interrupted_training_goes_on_to_the_same_bytes(tmp_path):
    whole = trained(tmp_path / "whole")
    assert len(whole["curve.csv"].splitlines()) == 21
    first = trained(tmp_path / "cut", lines=16)  # in the second round
    assert first["policy.onnx"] != whole["policy.onnx"]
    assert trained(tmp_path / "cut", resume=True) == whole
    with pytest.raises(OutputError, match="has a run already"):
        trained(tmp_path / "cut")
    with pytest.raises(OutputError, match="other settings"):
        trained(tmp_path / "cut", resume=True, seed=1)


def test_another_build_does_not_go_on(tmp_path):
    trained(tmp_path, lines=16)
    build = json.loads((tmp_path / "build.json").read_text())
    build["rooms"]["engine/task"] = "another"
    (tmp_path / "build.json").write_text(json.dumps(build))
    with pytest.raises(OutputError, match="differs from this one in engine/task; resume with that"):
        trained(tmp_path, resume=True)


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"world": {"map": "village"}}, "world: not allowed here"),
        ({"tracker": {"supervised": False}}, "supervised: .* --preset eyas' also writes policy-fl"),
        ({"env": {"actions": "discrete"}}, "env: not allowed here"),
        ({"env": {"observation": {"height": 32}}}, "32x32 is not allowed: .* such as 80x60"),
        ({"train": {"begin_from": "runs/eyas"}}, "begin_from: not allowed"),
    ],
)
def test_what_would_change_nothing_is_refused(changes, why, tmp_path):
    with pytest.raises(ConfigError, match=why):
        train(config(**changes), tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_steps_are_pictures_in_lessons():
    tracker = load_settings(preset_file("eyas")).train.tracker
    assert tracker.pictures == 1_075_200
    small = updated(tracker, tracker.scaled(12_800))
    assert (small.drives, small.drive_steps) == (1, 119)
    assert [(each.flights, each.steps) for each in small.rounds] == [
        (1, 14),
        (1, 14),
        (1, 18),
        (0, 54),
    ]
    with pytest.raises(ConfigError, match=r"rounds.0.flights: 0 is not allowed"):
        updated(tracker, {"rounds": [{"flights": 0, "steps": 5}]})


@pytest.mark.slow
def test_eyas_train_teaches_a_tracker_from_nothing(tmp_path, monkeypatch):
    """The command with short flights, those of later rounds by what earlier ones have taught."""
    monkeypatch.setattr(flights, "_STEPS", 400)
    monkeypatch.setattr(flights, "_FLIGHTS", 2)
    monkeypatch.setattr(flights, "_TURN", ("citystreet",))
    monkeypatch.setattr(flights, "WEATHERS", ("day",) * 4)
    monkeypatch.setattr(driving, "_LOOKS", 200)
    monkeypatch.setattr(driving, "_LEAST", 150)
    out = tmp_path / "run"
    command = ["train", "--preset", "eyas", "--steps", "256", "--out", str(out)]
    size = ["--set", "env.observation.width=32", "--set", "env.observation.height=24"]
    result = CliRunner().invoke(app, [*command, *size])
    assert result.exit_code == 0, result.output
    said = result.stdout.splitlines()
    assert said[0] == "3 batches of 32 flights, 512 pictures in lessons"
    assert "traffic 1 of 1: " in result.stdout
    assert "round 2: flights 3 of 3: " in result.stdout
    policy = out / "policy.onnx"
    assert said[-3] == f"{policy} (its curve in {out / 'curve.csv'})"
    assert said[-2] == f"to measure it: eyas evaluate --policy {policy}"
    assert open_policy(str(policy), {}).env.observation.width == SIZE[1]
    assert open_policy(str(out / "policy-flown.onnx"), {}).settings == FLOWN


class Opens:
    """Unpickled, it makes a file."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return open, (self.path, "w")


def test_a_network_of_others_runs_no_code(tmp_path):
    trained(tmp_path)
    torch.save(Opens(str(tmp_path / "run")), tmp_path / "round-0.pt")
    with pytest.raises(DataFileError, match=r"round-0\.pt: not a checkpoint"):
        trained(tmp_path, resume=True)
    assert not (tmp_path / "run").exists()


def test_batches_of_other_lengths_are_joined():
    joined = Shots.joined([spots(2, 8), spots(3, 5)])
    assert joined.picture.shape[:2] == (5, 8)
    assert joined.flown.sum() == 16 + 15


@pytest.fixture(scope="module")
def drives():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(driving, "_LOOKS", 260)
        patch.setattr(driving, "_LEAST", 200)
        return driven(ENV, 0, 0), driven(ENV, 0, 0)


def test_what_drivers_do_repeats_and_is_of_this_world(drives):
    one, other = drives
    assert len(one.past) > 500
    assert (one.past == other.past).all()
    assert (one.ahead == other.ahead).all()
    speed = one.past[:, 0]
    assert 0.5 < speed.min()
    assert 5.0 < np.median(speed) < 16.0
    way = one.past[:, -2:]  # of two seconds
    assert np.median(way[:, 0]) > 5.0 * np.median(np.abs(way[:, 1]))
    near, far = (np.median(np.abs(one.ahead[:, k])) for k in (0, -1))
    assert near < 1.0 < far


def test_it_learns_where_drivers_go(drives):
    torch.manual_seed(1)
    learner = Forecast()
    assert len(list(taught_forecast(learner, drives[0], 200, np.random.default_rng(1)))) == 10
    with torch.no_grad():
        said = learner(torch.from_numpy(drives[0].past)).numpy()
    off = np.hypot(*np.moveaxis(said[..., :2] - drives[0].ahead, -1, 0))
    straight = np.hypot(*np.moveaxis(drives[0].ahead, -1, 0))
    assert (np.median(off, axis=0) < 0.8 * np.median(straight, axis=0)).all()
    assert (np.diff(said[..., 2].mean(axis=0)) > 0.0).all()  # the later the less sure
    assert said.shape[1] == len(HORIZONS)
