"""Teaching by a teacher: what it tells, whether that is learned, and the same bytes however run."""

import copy
import math
import sys

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from eyas.cli.main import main
from eyas.engine.core.config import updated, validated
from eyas.engine.core.errors import EyasError
from eyas.engine.envs.batch import Truth
from eyas.engine.policies.steering import towards
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings
from eyas.learning.algorithm import Learner, phases_of
from eyas.learning.config import TrainConfig
from eyas.learning.dagger import Dagger
from eyas.learning.network import NetworkShape, TrackingNetwork, fastest_numbers, network_of
from eyas.learning.rollout import Roller, Teacher
from eyas.learning.shards import TorchThreads
from eyas.learning.trainer import train

SMALL = validated(
    EyasConfig,
    {
        "env": {"action_repeat": 4, "observation": {"width": 24, "height": 24, "layout": "chw"}},
        "train": {
            "method": "dagger+ppo",
            "environments": 4,
            "n_steps": 8,
            "updates_per_block": 2,
            "hidden": 16,
            "evaluation": {"every": 0},
            "dagger": {
                "total_timesteps": 96,
                "guided_timesteps": 64,
                "buffer": 64,
                "minibatches": 2,
            },
            "stages": [
                {"total_timesteps": 128},
                {"total_timesteps": 64, "settings": {"world": {"weather": "night"}}},
            ],
        },
    },
)
"""Blocks of 64 and 32 decisions by a teacher, of 32 and 64 by rewards, the last one at night."""

SHAPE = NetworkShape(3, 24, 24, 16, memory=False)


def files(folder):
    return {name: (folder / name).read_bytes() for name in ("curve.csv", "policy.onnx")}


def quiet(line):
    pass


def roller(changes=None, shape=SHAPE):
    config = updated(SMALL, {"train": changes or {}})
    network = TrackingNetwork(shape)
    network.initialise(torch.Generator().manual_seed(0))
    made = Roller(config, network)
    made.begin(np.random.default_rng(0))
    return made, network, config.train


def dagger(made, network, config, updates=1):
    """Return the algorithm at the beginning of a block."""
    optimiser, generator = torch.optim.Adam(network.parameters(), 3e-3), torch.Generator()
    learner = Learner(network, optimiser, config, generator.manual_seed(0), TorchThreads(1))
    learned = Dagger(learner, config.dagger)
    learned.begin(updates)
    return learned


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "run"
    train(SMALL, folder, say=quiet)
    return files(folder)


def test_the_method_changes_at_its_decision_within_a_stage(whole):
    head, *rows = (row.split(",") for row in whole["curve.csv"].decode().splitlines())
    rows = [dict(zip(head, row, strict=True)) for row in rows]
    told = [(row["stage"], row["decisions"], row["imitation_loss"] != "nan") for row in rows]
    assert told == [("0", "64", True), ("0", "96", True), ("0", "128", False), ("1", "192", False)]
    assert [row["policy_loss"] == "nan" for row in rows] == [True, True, False, False]


@pytest.mark.parametrize("at", [1, 2, 3])
def test_a_run_that_is_interrupted_and_resumed_gives_the_same_bytes(whole, at, tmp_path):
    lines = []

    def stop(line):
        lines.extend([line] if "return" in line else [])  # of blocks
        if len(lines) == at:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(SMALL, tmp_path / "run", say=stop)
    train(SMALL, tmp_path / "run", resume=True, say=quiet)
    assert files(tmp_path / "run") == whole


def test_shards_and_parts_give_the_same_on_any_number_of_threads(tmp_path, monkeypatch):
    config = updated(SMALL, {"train": {"shards": 2, "parts": 3}})
    train(config, tmp_path / "side by side", say=quiet)
    monkeypatch.setattr(TorchThreads, "each", lambda self, do, jobs: [do(job) for job in jobs])
    train(config, tmp_path / "in turn", say=quiet)
    assert files(tmp_path / "side by side") == files(tmp_path / "in turn")


def test_what_a_teacher_tells_is_learned():
    """The loss falls on flights that the network has not learned from."""
    made, network, config = roller({"n_steps": 32, "dagger": {"minibatches": 4}})
    learned = dagger(made, network, config)
    held = copy.deepcopy(made.roll(1.0))
    made.begin(np.random.default_rng(1))

    def loss():
        with torch.no_grad():
            logits, _, _ = network(held.pictures.flatten(0, 1), held.states.flatten(0, 1))
        return float(torch.nn.functional.cross_entropy(logits, held.labels.flatten()))

    before = loss()
    for _ in range(3):
        data = made.roll(1.0)
        for _ in range(8):
            learned.update(data)
    assert loss() < 0.75 * before


def test_the_share_of_guided_environments_is_flown_by_the_teacher():
    made, *_ = roller()
    for guided, flown in [(1.0, 4), (0.5, 2), (0.0, 0)]:
        data = made.roll(guided)
        same = (data.actions == data.labels).all(0)
        assert same[:flown].all()
        assert not same[flown:].all() or flown == 4
        assert (data.weights > 0.0).all()


def test_a_teacher_goes_on_where_it_has_seen_the_target_and_counts_less_each_moment():
    made, *_ = roller()
    teacher, env = Teacher(made_config(), 4), made.env
    teacher.begin()
    snapshot, seen = env.truth()
    assert (seen > 0.15).all()
    actions, weights = teacher.lesson(Truth(snapshot, seen))
    assert torch.equal(weights, torch.ones(4))
    place, velocity = snapshot.targets.centre.copy(), snapshot.targets.velocity.copy()
    for count in (1, 2, 3):
        env.step(np.full(4, 6))
        actions, weights = teacher.lesson(Truth(env.truth().snapshot, np.zeros(4)))
        age = 0.032 * count
        assert weights.tolist() == pytest.approx([math.exp(-age / 0.5)] * 4)
        gone = (place + velocity * age)[:, :2] - env.truth().snapshot.episodes.view_centre[:, :2]
        yaw = env.truth().snapshot.trackers.euler[:, 2]
        ahead = np.cos(yaw) * gone[:, 0] + np.sin(yaw) * gone[:, 1]
        left = -np.sin(yaw) * gone[:, 0] + np.cos(yaw) * gone[:, 1]
        assert actions.tolist() == towards(np.stack((ahead, left), -1), SMALL.env).tolist()
    teacher.forget(np.array([True, False, False, False]))
    _, weights = teacher.lesson(Truth(env.truth().snapshot, np.zeros(4)))
    assert weights[0] == 1.0, "a new episode begins: the target is in the middle"
    assert (weights[1:] < 1.0).all()


def made_config(**imitation):
    return updated(SMALL, {"train": {"dagger": imitation}})


def test_an_exact_teacher_knows_a_hidden_target():
    """It asks for the same whether or not the target is seen."""
    made, *_ = roller()
    blind, seeing = (Teacher(made_config(teacher="exact"), 4) for _ in range(2))
    for teacher in (blind, seeing):
        teacher.begin()
    for _ in range(12):
        snapshot = made.env.truth().snapshot
        one, weights = blind.lesson(Truth(snapshot, np.zeros(4)))
        other, _ = seeing.lesson(Truth(snapshot, np.ones(4)))
        assert torch.equal(one, other)
        made.env.step(np.full(4, 6))
    assert (weights < 1.0).all()


def test_the_oldest_rollout_gives_way_and_no_empty_place_is_learned_from():
    made, *rest = roller()
    learned = dagger(made, *rest, updates=2)
    buffer = learned.buffer
    for number in range(3):
        data = made.roll(0.0)
        buffer.add(data, torch.full((8, 4), float(number)))
        for chosen in learned.minibatches():
            assert (chosen % 8 < buffer.filled).all()
    assert buffer.lessons.targets[0].tolist() == [2.0] * 4 + [1.0] * 4
    assert torch.equal(buffer.lessons.pictures[:, :4], data.pictures)


def test_each_new_decision_is_learned_from_once_in_an_update():
    made, *rest = roller({"dagger": {"replay": 0.0}})
    learned = dagger(made, *rest, updates=2)
    for _ in range(2):
        learned.buffer.add(made.roll(0.0), torch.zeros(8, 4))
    got = torch.cat(list(learned.minibatches()))
    assert sorted(got.tolist()) == [row * 8 + column for row in range(8) for column in range(4, 8)]


def test_a_network_with_memory_learns_whole_sequences(tmp_path):
    config = updated(SMALL, {"train": {"method": "dagger", "memory": True}})
    train(config, tmp_path / "run", say=quiet)
    head, *rows = ((tmp_path / "run" / "curve.csv").read_text()).splitlines()
    assert all("nan" not in row.split(",")[head.split(",").index("agreement")] for row in rows)


def test_the_memory_of_a_minibatch_is_that_of_the_flight():
    """Outputs of the unchanged network are those that it had in flight."""
    made, *rest = roller({"memory": True}, NetworkShape(3, 24, 24, 16, memory=True))
    learned = dagger(made, *rest)
    data = made.roll(0.0)
    learned.buffer.add(data, data.values[:-1])
    _, figures = learned.loss(learned.everything(data), 1.0, torch.ones(()))
    assert figures[2].item() == pytest.approx(0.0, abs=1e-9), "values are those of the flight"


def test_channels_last_answers_the_same_but_for_rounding(tmp_path):
    plain, other = TrackingNetwork(SHAPE), TrackingNetwork(SHAPE, channels_last=True)
    for network in (plain, other):
        network.initialise(torch.Generator().manual_seed(3))
    pictures = torch.randint(0, 256, (5, 3, 24, 24), dtype=torch.uint8)
    state = torch.zeros(5, SHAPE.state)
    for one, two in zip(plain(pictures, state), other(pictures, state), strict=True):
        assert torch.allclose(one, two, atol=1e-4)
    config = updated(SMALL, {"train": {"channels_last": True, "stages": [{"total_timesteps": 64}]}})
    train(config, tmp_path / "run", say=quiet)
    saved = torch.load(tmp_path / "run" / "checkpoint.pt", weights_only=True)["network"]
    assert saved["second.weight"].is_contiguous(memory_format=torch.channels_last)


def test_bfloat16_answers_nearly_the_same_while_it_learns_and_exactly_afterwards():
    plain, short = (network_of(SHAPE, TrainConfig(number_type=n)) for n in ("float32", "bfloat16"))
    for network in (plain, short):
        network.initialise(torch.Generator().manual_seed(3))
    pictures = torch.randint(0, 256, (5, 3, 24, 24), dtype=torch.uint8)
    state = torch.zeros(5, SHAPE.state)
    seen, other = plain.features(pictures, state), short.features(pictures, state)
    assert other.dtype == torch.float32
    assert not torch.equal(seen, other)
    assert torch.allclose(seen, other, rtol=0.05, atol=0.05)
    assert torch.equal(seen, short.eval().features(pictures, state))


@pytest.mark.parametrize(
    ("flags", "numbers"),
    [({"avx2"}, "float32"), ({"avx512_bf16"}, "bfloat16"), ({"amx_bf16"}, "bfloat16")],
)
def test_the_fastest_numbers_are_those_that_the_processor_multiplies(monkeypatch, flags, numbers):
    monkeypatch.setattr("eyas.learning.network.features", lambda: flags)
    assert fastest_numbers(torch.device("cpu")) == numbers


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"dagger": {"teacher": "x"}}, r"^train\.dagger\.teacher: 'x' .*sighted"),
        ({"dagger": {"fade": 0}}, r"^train\.dagger\.fade: 0 is not allowed"),
        ({"dagger": {"minibatch": 4}}, r"minibatch.*minibatches"),
    ],
)
def test_bad_values_are_one_line(changes, message):
    with pytest.raises(EyasError, match=message) as caught:
        updated(SMALL, {"train": changes})
    assert "\n" not in str(caught.value)


def ends(**changes):
    return [(each.name, each.end) for each in phases_of(updated(SMALL.train, changes))]


def test_how_long_a_teacher_teaches():
    longer = {"total_timesteps": 70}
    assert ends(dagger=longer) == [("dagger", 96), ("ppo", 192)], "whole updates of 32"
    assert ends(method="ppo") == [("ppo", 192)]
    assert ends(method="dagger") == [("dagger", 192)]
    assert ends(dagger={"total_timesteps": 1000}) == [("dagger", 192), ("ppo", 192)]


@pytest.mark.parametrize(
    ("method", "message"),
    [
        ("dager", r"^train\.method: .*'dager'.*'dagger'"),
        ("ppo+dagger", r"^train\.method: 'ppo\+dagger' is not allowed: 'ppo' has no end"),
        ("dagger+tracker", r"^train\.method: 'tracker' is not an Algorithm"),
        ("math:pi", r"^train\.method: 'math:pi' is a float"),
    ],
)
def test_an_algorithm_that_is_none_is_told_in_one_line(method, message, tmp_path):
    with pytest.raises(EyasError, match=message) as caught:
        train(updated(SMALL, {"train": {"method": method}}), tmp_path / "run", say=quiet)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "run").exists()


def test_stages_keep_their_shares_of_other_decisions():
    stages = updated(SMALL.train, {"stages": SMALL.train.scaled_stages(96)}).stages
    assert [stage.total_timesteps for stage in stages] == [64, 32]
    assert stages[1].settings == {"world": {"weather": "night"}}
    assert [each["total_timesteps"] for each in SMALL.train.scaled_stages(1)] == [1, 1]


def test_method_and_steps_are_chosen_on_the_command_line(monkeypatch, tmp_path):
    (tmp_path / "mine.json").write_text(SMALL.model_dump_json())
    given = ["--config", f"{tmp_path}/mine.json", "--out", f"{tmp_path}/run", "--quiet"]
    monkeypatch.setattr(sys, "argv", ["eyas", "train", *given, "--method", "ppo", "--steps", "96"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code in (0, None)
    kept = load_settings(tmp_path / "run" / "config.json").train
    assert kept.method == "ppo"
    assert [stage.total_timesteps for stage in kept.stages] == [64, 32]
