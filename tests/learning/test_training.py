"""Training runs: the same when resumed, killed or repeated; what is wrong is one line."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")

import torch

from eyas.benchmark.flight.policy_runner import fly_batch
from eyas.benchmark.plan.plan import EvaluationPlan, batches
from eyas.engine.core.config import updated, validated
from eyas.engine.core.errors import EyasError
from eyas.engine.core.identity.build import this_build
from eyas.engine.settings.config import EyasConfig
from eyas.learning.algorithm import Algorithm
from eyas.learning.checkpoint import _NOT_LEARNED, RunFolder
from eyas.learning.commands import _default_folder
from eyas.learning.shards import TorchThreads
from eyas.learning.trainer import train

SMALL = validated(
    EyasConfig,
    {
        "env": {"action_repeat": 4, "observation": {"width": 24, "height": 24, "layout": "chw"}},
        "train": {
            "environments": 4,
            "n_steps": 8,
            "updates_per_block": 2,
            "hidden": 16,
            "evaluation": {"every": 2, "episodes": 1},
            "stages": [
                {"total_timesteps": 128},
                {"total_timesteps": 64, "settings": {"world": {"weather": "night"}}},
            ],
        },
    },
)
"""Three blocks of 64 decisions, the last one at night."""

UNTESTED = updated(SMALL, {"train": {"evaluation": {"every": 0}}})
"""For what flights of evaluation are no part of."""


def files(folder: Path) -> dict[str, bytes]:
    names = ("curve.csv", "policy.onnx", "checkpoint.pt")
    return {name: (folder / name).read_bytes() for name in names}


def quiet(line: str) -> None:
    pass


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "run"
    policy = train(SMALL, folder, say=quiet)
    assert policy == folder / "policy.onnx"
    return files(folder)


def test_a_run_has_a_row_for_each_block(whole):
    rows = whole["curve.csv"].decode().splitlines()
    assert rows[0].startswith("stage,decisions,episodes,return,length,")
    assert [row.split(",")[:2] for row in rows[1:]] == [["0", "64"], ["0", "128"], ["1", "192"]]
    assert rows[0].endswith(",cr,tsr")
    tested = ["nan" not in row.split(",")[-2:] for row in rows[1:]]
    assert tested == [False, True, True], "every second block, and after the last"


def test_a_run_that_is_interrupted_and_resumed_gives_the_same_bytes(whole, tmp_path):
    lines = []

    def stop(line):
        lines.extend([line] if "return" in line else [])  # of blocks
        if len(lines) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(SMALL, tmp_path / "run", say=stop)
    assert (tmp_path / "run" / "curve.csv").read_bytes() != whole["curve.csv"]
    train(SMALL, tmp_path / "run", resume=True, say=quiet)
    assert files(tmp_path / "run") == whole
    train(SMALL, tmp_path / "run", resume=True, say=quiet)  # there is nothing left to do
    assert files(tmp_path / "run") == whole


def test_it_stops_after_the_update_that_reaches_the_decisions_and_says_so(tmp_path):
    config = updated(
        UNTESTED, {"train": {"stages": [{"total_timesteps": 70}], "updates_per_block": 2}}
    )
    lines = []
    train(config, tmp_path / "run", say=lines.append)
    assert lines[0] == "stage 0: 70 decisions are rounded up to 3 updates of 32: 96"
    curve = (tmp_path / "run" / "curve.csv").read_text().splitlines()
    assert [row.split(",")[1] for row in curve[1:]] == ["64", "96"]
    assert [line.split()[:4] for line in lines[3:]] == [
        ["64", "of", "96", "decisions"],
        ["96", "of", "96", "decisions"],
    ]


def test_how_far_it_is_is_told_after_the_first_update(tmp_path):
    lines = []
    train(UNTESTED, tmp_path / "run", say=lines.append)
    assert lines[0] == "192 decisions by ppo, in updates of 32"
    assert lines[1].split()[:4] == ["32", "of", "192", "decisions"]
    assert lines[1].endswith("min left")
    assert "return" in lines[2]


def test_the_default_folder_is_numbered(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = []
    for _ in range(3):
        folder = _default_folder(resume=False)
        folder.mkdir(parents=True)
        names.append(str(folder))
    assert names == ["runs/train", "runs/train-2", "runs/train-3"]
    assert str(_default_folder(resume=True)) == "runs/train-3"


@pytest.mark.slow
def test_a_run_that_is_killed_gives_the_same_bytes(whole, tmp_path):
    folder = tmp_path / "run"
    script = (
        "import sys; from pathlib import Path\n"
        "from eyas.engine.settings.file import load_settings\n"
        "from eyas.learning.trainer import train\n"
        "train(load_settings(Path(sys.argv[1])), Path(sys.argv[2]))"
    )
    settings = tmp_path / "settings.json"
    settings.write_text(SMALL.model_dump_json())
    child = subprocess.Popen([sys.executable, "-c", script, str(settings), str(folder)])
    while not (folder / "checkpoint.pt").exists():
        assert child.poll() is None
        time.sleep(0.01)
    os.kill(child.pid, signal.SIGKILL)
    child.wait()
    train(SMALL, folder, resume=True, say=quiet)
    assert files(folder) == whole


def test_a_stage_ends_early_at_its_score(tmp_path):
    stages = [{"total_timesteps": 10_000_000, "until_tsr": 0.01}, {"total_timesteps": 64}]
    config = updated(SMALL, {"train": {"stages": stages, "evaluation": {"every": 1}}})
    train(config, tmp_path / "run", say=quiet)
    rows = (tmp_path / "run" / "curve.csv").read_text().splitlines()[1:]
    assert [row.split(",")[0] for row in rows] == ["0", "1"]


def test_a_score_without_evaluations_is_refused():
    stages = [{"total_timesteps": 10, "until_tsr": 0.5}]
    with pytest.raises(EyasError, match=r"^train: .*'until_tsr' needs evaluations"):
        updated(SMALL, {"train": {"stages": stages, "evaluation": {"every": 0}}})


@pytest.mark.slow
def test_marks_are_those_of_eyas_evaluate(tmp_path):
    """The network in its ONNX file gets the same records from `eyas evaluate`."""
    policy = train(SMALL, tmp_path / "run", say=quiet)
    row = (tmp_path / "run" / "curve.csv").read_text().splitlines()[-1].split(",")
    plan = EvaluationPlan(policy=str(policy), episodes=1, seeds=(2_000_000,))
    records = [
        each for batch in batches(plan) for ended in fly_batch(plan, batch) for each in ended
    ]
    assert float(row[-2]) == pytest.approx(np.mean([each.cr for each in records]), abs=1e-5)
    assert float(row[-1]) == pytest.approx(np.mean([each.tsr for each in records]), abs=1e-5)


@pytest.mark.slow
def test_shards_and_parts_give_the_same_on_any_number_of_threads(tmp_path, monkeypatch):
    config = updated(UNTESTED, {"train": {"shards": 2, "parts": 3}})
    train(config, tmp_path / "side by side", say=quiet)
    monkeypatch.setattr(TorchThreads, "each", lambda self, do, jobs: [do(job) for job in jobs])
    train(config, tmp_path / "in turn", say=quiet)
    assert files(tmp_path / "side by side") == files(tmp_path / "in turn")


def test_shards_are_of_equal_size():
    with pytest.raises(EyasError, match="4 cannot be split into 3 shards of equal size"):
        updated(SMALL, {"train": {"shards": 3}})


def test_other_settings_and_other_folders_are_refused(tmp_path, whole):
    train(
        updated(UNTESTED, {"train": {"stages": [{"total_timesteps": 1}]}}),
        tmp_path / "run",
        say=quiet,
    )
    for config, folder, resume, message in [
        (UNTESTED, "run", False, "has a run already; continue it with --resume"),
        (UNTESTED, "run", True, "has other settings"),
        (UNTESTED, "none", True, "there is no run to resume"),
    ]:
        with pytest.raises(EyasError, match=message) as caught:
            train(config, tmp_path / folder, resume=resume, say=quiet)
        assert "\n" not in str(caught.value)


def test_the_rate_of_learning_falls_linearly_to_its_last_share(tmp_path, monkeypatch):
    rates = []
    descend = Algorithm.descend

    def told(self, *arguments):
        rates.append(self.learner.optimiser.param_groups[0]["lr"])
        return descend(self, *arguments)

    monkeypatch.setattr(Algorithm, "descend", told)
    changes = {"stages": [{"total_timesteps": 128}], "method": "ppo", "final_rate": 0.4}
    train(updated(UNTESTED, {"train": changes}), tmp_path / "run", say=quiet)
    shares = np.array(list(dict.fromkeys(rates))) / rates[0]
    assert shares == pytest.approx([1.0, 0.75, 0.5, 0.4])


def test_a_damaged_checkpoint_is_one_line(tmp_path):
    config = updated(UNTESTED, {"train": {"stages": [{"total_timesteps": 1}]}})
    train(config, tmp_path / "run", say=quiet)
    (tmp_path / "run" / "checkpoint.pt").write_bytes(b"no checkpoint")
    with pytest.raises(EyasError, match=r"checkpoint\.pt: not a checkpoint") as caught:
        train(config, tmp_path / "run", resume=True, say=quiet)
    assert "\n" not in str(caught.value)
    assert RunFolder(tmp_path / "run").policy.exists()


def test_a_run_of_another_build_is_not_resumed_but_may_be_taught_further(tmp_path):
    config = updated(UNTESTED, {"train": {"stages": [{"total_timesteps": 1}]}})
    train(config, tmp_path / "run", say=quiet)
    path = tmp_path / "run" / "checkpoint.pt"
    saved = torch.load(path, weights_only=True)
    saved["build"]["rooms"] |= {"engine/task": "0", "robotics": "0"}
    torch.save(saved, path)
    with pytest.raises(
        EyasError, match=r"differs from this one in engine/task; resume with that"
    ) as caught:
        train(config, tmp_path / "run", resume=True, say=quiet)
    assert "\n" not in str(caught.value)
    further = updated(config, {"train": {"begin_from": str(tmp_path / "run")}})
    train(further, tmp_path / "second", say=quiet)
    saved["build"]["rooms"] |= {"engine/task": this_build().rooms["engine/task"]}
    torch.save(saved, path)
    train(config, tmp_path / "run", resume=True, say=quiet)  # `robotics` has no part in it


def test_what_another_run_has_learned_is_taught_further(tmp_path):
    first = tmp_path / "first"
    short = updated(UNTESTED, {"train": {"stages": [{"total_timesteps": 64}]}})
    train(short, first, say=quiet)
    rate = {"learning_rate": 1e-30}  # so small that nothing but an exact 0 changes
    second = updated(short, {"seed": 5, "train": rate | {"begin_from": str(first)}})
    train(second, tmp_path / "second", say=quiet)
    before, after = (
        torch.load(folder / "checkpoint.pt", weights_only=True)["network"]
        for folder in (first, tmp_path / "second")
    )
    for name, weights in before.items():
        assert torch.allclose(weights, after[name], rtol=0, atol=1e-25), name


def test_only_a_run_of_the_same_network_can_be_taught_further(tmp_path):
    train(
        updated(UNTESTED, {"train": {"stages": [{"total_timesteps": 1}]}}),
        tmp_path / "run",
        say=quiet,
    )
    for folder, other, message in [
        ("none", {}, r"none/checkpoint\.pt: no such file"),
        ("run", {"memory": True}, r"checkpoint\.pt: not a checkpoint of this network"),
    ]:
        learning = other | {"begin_from": str(tmp_path / folder)}
        with pytest.raises(EyasError, match=message):
            train(updated(UNTESTED, {"train": learning}), tmp_path / "new", say=quiet)
        assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("env", "message"),
    [
        ({"actions": "shares"}, r"^env\.actions: 'shares' cannot be trained yet"),
        ({"observation": {"layout": "hwc"}}, r"^env\.observation: only pictures alone"),
        ({"observation": {"width": 16, "height": 16}}, r"^env\.observation: too small"),
    ],
)
def test_what_cannot_be_trained_is_one_line(env, message, tmp_path):
    with pytest.raises(EyasError, match=message):
        train(updated(SMALL, {"env": env}), tmp_path / "run", say=quiet)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("evaluation", "message"),
    [
        ({"protocol": "papr"}, r"^train\.evaluation\.protocol: .*papr.*'paper'"),
        ({"weathers": ["day", "snwo"]}, r"'snwo'.*'snow'"),
    ],
)
def test_an_evaluation_that_cannot_be_flown_is_refused_at_once(evaluation, message, tmp_path):
    config = updated(SMALL, {"train": {"evaluation": evaluation}})
    with pytest.raises(EyasError, match=message):
        train(config, tmp_path / "run", say=quiet)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("settings", "place"),
    [
        ({"world": {"seed": 900_000_001}}, r"world\.seed"),
        ({"traffic": {"seed": 900_000_001}}, r"traffic\.seed"),
        (
            {"env": {"mixture": [{"settings": {"world": {"seed": 2**31 - 1}}}]}},
            r"env\.mixture\.0\.settings\.world\.seed",
        ),
    ],
)
def test_what_is_kept_for_tests_is_not_trained_with(settings, place, tmp_path):
    with pytest.raises(EyasError, match=rf"^{place}: \d+ is not allowed: .*kept for tests"):
        train(updated(SMALL, settings), tmp_path / "run", say=quiet)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"train": {"shards": 2}}, r"^train\.stages\.1\.settings\.train: not allowed"),
        ({"start": {"hight": 3}}, r"hight.*height"),
        ({"world": {"seed": 900_000_001}}, r"^train\.stages\.1\.settings\.world\.seed: 9.*tests"),
    ],
)
def test_a_wrong_later_stage_is_refused_at_once(settings, message, tmp_path):
    stages = [{"total_timesteps": 64}, {"total_timesteps": 64, "settings": settings}]
    with pytest.raises(EyasError, match=message):
        train(updated(SMALL, {"train": {"stages": stages}}), tmp_path / "run", say=quiet)
    assert not (tmp_path / "run").exists()


def test_a_network_with_memory_learns_too(tmp_path):
    config = updated(UNTESTED, {"train": {"memory": True, "stages": [{"total_timesteps": 64}]}})
    train(config, tmp_path / "run", say=quiet)
    saved = torch.load(tmp_path / "run" / "checkpoint.pt", weights_only=True)
    assert saved["network"]["memory.weight_hh"].shape == (48, 16)


def test_what_has_no_part_in_learning_are_rooms_of_the_build():
    assert this_build().rooms.keys() >= {*_NOT_LEARNED}
