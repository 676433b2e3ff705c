"""Training with environments on a device, which here is this processor: the same bytes as without.

On a graphics processor, environments give these bytes as well; what PyTorch makes of them there is
not tried here.
"""

import pytest

torch = pytest.importorskip("torch")

from eyas.engine.core.config import updated, validated
from eyas.engine.core.errors import ConfigError
from eyas.engine.settings.config import EyasConfig
from eyas.learning.run import run
from eyas.learning.trainer import train

SMALL = validated(
    EyasConfig,
    {
        "done": {"total_steps": 60, "grace_steps": 0, "no_reward_steps": 28},
        "env": {"action_repeat": 4, "observation": {"width": 24, "height": 24, "layout": "chw"}},
        "train": {
            "method": "dagger+ppo",
            "dagger": {"total_timesteps": 64, "guided_timesteps": 40},
            "environments": 4,
            "n_steps": 8,
            "updates_per_block": 2,
            "hidden": 16,
            "evaluation": {"every": 3, "episodes": 1},
            "stages": [{"total_timesteps": 192}],
        },
    },
)
"""A block by a teacher and two by rewards; 16 episodes of four decisions each in each."""


def trained(folder, **changes):
    train(updated(SMALL, {"train": changes}), folder, say=lambda _: None)
    return {name: (folder / name).read_bytes() for name in ("curve.csv", "policy.onnx")}


@pytest.mark.slow
@pytest.mark.parametrize("memory", [False, True])
def test_a_run_on_a_device_gives_the_same_bytes(memory, tmp_path):
    usual = trained(tmp_path / "usual", memory=memory)
    assert trained(tmp_path / "device", memory=memory, device="host") == usual
    episodes = [row.split(",")[2] for row in usual["curve.csv"].decode().splitlines()]
    assert episodes == ["episodes", "16", "16", "16"], "they have ended, and begun again"


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"device": "abacus"}, "train.device: "),
        ({"device": "host", "shards": 2}, "shards: 2 are not there on a device; allowed: 1"),
    ],
)
def test_wrong_settings_are_one_line(changes, said):
    with pytest.raises(ConfigError) as told:
        updated(SMALL, {"train": changes})
    assert said in str(told.value)
    assert "\n" not in str(told.value)


@pytest.mark.skipif(torch.cuda.is_available(), reason="PyTorch can use a card here")
def test_a_card_that_pytorch_cannot_use_is_told_at_once(tmp_path):
    with pytest.raises(
        ConfigError, match=r"^train\.device: 'cuda' cannot be used by PyTorch"
    ) as told:
        trained(tmp_path / "run", device="cuda")
    assert "\n" not in str(told.value)


def test_a_cluster_has_no_devices(tmp_path):
    there = updated(SMALL, {"train": {"device": "host"}})
    with pytest.raises(ConfigError, match=r"^train\.device: 'host' is not there with --ray$"):
        run(there, tmp_path / "run", resume=False, quiet=True, ray=True)
