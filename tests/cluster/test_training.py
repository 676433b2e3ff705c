"""Training on Ray: the bytes of one process, even if a worker is killed."""

import os
import signal

import pytest
import torch

from eyas.engine.core.config import updated, validated
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.settings.config import EyasConfig
from eyas.learning.shards import RayShards, on_ray
from eyas.learning.trainer import train

torch.set_num_threads(1)

SMALL = validated(
    EyasConfig,
    {
        "env": {"observation": {"width": 24, "height": 24, "layout": "chw"}},
        "train": {
            "method": "dagger+ppo",
            "dagger": {"total_timesteps": 96, "guided_timesteps": 64, "minibatches": 2},
            "environments": 4,
            "shards": 2,
            "n_steps": 8,
            "updates_per_block": 3,
            "hidden": 16,
            "evaluation": {"every": 0},
            "stages": [{"total_timesteps": 96}, {"total_timesteps": 96}],
        },
    },
)
"""A block by a teacher, and one by rewards."""


def quiet(line):
    pass


def files(folder):
    return {name: (folder / name).read_bytes() for name in ("curve.csv", "policy.onnx")}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    train(SMALL, folder, say=quiet)
    return files(folder)


def test_a_run_on_ray_gives_the_bytes_of_one_process(ray, whole, tmp_path):
    with on_ray() as make_shards:
        train(SMALL, tmp_path, say=quiet, make_shards=make_shards)
    assert files(tmp_path) == whole


def test_a_worker_that_is_killed_is_replaced_and_no_byte_differs(ray, whole, tmp_path, caplog):
    class Deadly(RayShards):
        rolled = 0

        def roll(self, guided=None):
            Deadly.rolled += 1
            if Deadly.rolled in (2, 5):  # in the middle of a block
                pid = ray.get(self._workers[1].__ray_call__.remote(lambda _: os.getpid()))
                os.kill(pid, signal.SIGKILL)
            return super().roll(guided)

    train(SMALL, tmp_path, say=quiet, make_shards=lambda *made: Deadly(ray, *made))
    assert files(tmp_path) == whole
    assert caplog.text.count("shard 1 was lost") == 2


def test_more_shards_than_cores_are_refused(ray, tmp_path):
    wrong = updated(SMALL, {"train": {"environments": 4, "shards": 4}})
    with on_ray() as make_shards, pytest.raises(ConfigError, match=r"train\.shards: 4 need"):
        train(wrong, tmp_path, say=quiet, make_shards=make_shards)


def test_an_error_of_a_worker_is_one_line(ray, tmp_path):
    wrong = updated(SMALL, {"traffic": {"recording": str(tmp_path / "none.npz")}})
    with on_ray() as make_shards, pytest.raises(EyasError, match=r"none\.npz"):
        train(wrong, tmp_path / "run", say=quiet, make_shards=make_shards)
