"""Short real runs of other libraries in our environments."""

from pathlib import Path

import gymnasium
import numpy as np
import pytest

from eyas.dat.observation import LegacyObservation, scrambled
from eyas.engine.core.errors import EyasError
from eyas.engine.envs.lerobot import make_lerobot_env
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.envs.vector_env import EyasVectorEnv

SMALL = {"width": 36, "height": 36}
SHORT = {"done": {"total_steps": 40, "grace_steps": 0, "no_reward_steps": 500}}
"""Episodes of ten actions."""


def test_stable_baselines_learns_in_the_vector_environment():
    sb3 = pytest.importorskip("stable_baselines3")
    from eyas.engine.envs.sb3 import EyasVecEnv

    env = EyasVecEnv(4, SHORT, observation={**SMALL, "layout": "chw"})
    model = sb3.PPO("CnnPolicy", env, n_steps=16, batch_size=32, n_epochs=1, seed=0, device="cpu")
    assert model.get_env() is env  # channels come first already: nothing transposes them
    model.learn(128)
    assert len(model.ep_info_buffer) == 12
    assert {entry["l"] for entry in model.ep_info_buffer} == {10}


def test_stable_baselines_gets_what_the_vector_environment_gives():
    pytest.importorskip("stable_baselines3")
    from eyas.engine.envs.sb3 import EyasVecEnv

    env = EyasVecEnv(3, SHORT, observation=SMALL, render_mode="rgb_array")
    plain = EyasVectorEnv(3, SHORT, observation=SMALL, autoreset_mode="SameStep")
    env.seed(5)
    assert np.array_equal(env.reset(), plain.reset(seed=5)[0])
    total = np.zeros(3)
    for _ in range(10):
        seen, rewards, done, infos = env.step(np.array([0, 1, 6]))
        expected, plain_rewards, terminated, truncated, info = plain.step([0, 1, 6])
        total += rewards
        assert np.array_equal(seen, expected)
        assert np.allclose(rewards, plain_rewards)
        assert np.array_equal(done, terminated | truncated)
    assert done.all()
    for index in range(3):
        assert np.array_equal(infos[index]["terminal_observation"], info["final_obs"][index])
        assert infos[index]["TimeLimit.truncated"]
        assert infos[index]["episode"]["r"] == pytest.approx(total[index], abs=1e-5)
    assert env.render().shape == (480, 640, 3)
    assert env.env_method("render", indices=[1])[0].shape == (240, 320, 3)
    env.set_attr("mark", 7, indices=2)
    assert env.get_attr("mark", indices=[2]) == [7]
    assert env.has_attr("config")
    assert not env.has_attr("nothing")


@pytest.mark.parametrize("mode", ["SameStep", "Disabled"])
def test_torchrl_collects_in_the_vector_environment(mode):
    gym = pytest.importorskip("torchrl.envs.libs.gym")
    env = gym.GymWrapper(EyasVectorEnv(3, SHORT, observation=SMALL, autoreset_mode=mode))
    rollout = env.rollout(25, break_when_any_done=False)
    assert rollout.batch_size == (3, 25)
    done = rollout["next", "done"][..., 0]
    assert done.sum() == 6  # two episodes of ten actions in each
    assert done[:, 9].all()


def test_torchrl_refuses_the_mode_that_it_cannot_use():
    gym = pytest.importorskip("torchrl.envs.libs.gym")
    with pytest.raises(RuntimeError, match="autoreset"):
        gym.GymWrapper(EyasVectorEnv(2, SHORT, observation=SMALL)).rollout(3)


@pytest.mark.filterwarnings("ignore")  # TorchRL warns of its own parts
def test_torchrl_learns_in_them(monkeypatch):
    """The example; those of skrl, Tianshou and RLlib want other versions, or more of them."""
    pytest.importorskip("torchrl.collectors")
    monkeypatch.syspath_prepend(Path(__file__).parents[3] / "examples")
    import learn_torchrl
    import torch

    torch.manual_seed(0)
    before = [each.clone() for each in learn_torchrl.Looks(7).parameters()]
    after = learn_torchrl.main(decisions=128, num_envs=2, rollout=64).parameters()
    assert all((own != one).any() for own, one in zip(before, after, strict=True))


@pytest.mark.parametrize(("rewarded", "success"), [(4, False), (5, True)])
def test_half_of_an_episode_in_view_is_a_success_to_lerobot(rewarded, success, monkeypatch):
    env = make_lerobot_env(1, cfg=SHORT)
    env.reset(seed=0)
    step, left = EyasVectorEnv.step, [1.0] * rewarded + [0.0] * 20
    monkeypatch.setattr(
        EyasVectorEnv,
        "step",
        lambda self, actions: (lambda told: (told[0], np.array([left.pop(0)]), *told[2:]))(
            step(self, actions)
        ),
    )
    for _ in range(10):
        *_, truncated, info = env.step(np.zeros((1, 4), np.float32))
    assert (truncated.tolist(), info["is_success"].tolist()) == ([True], [success])


def test_lerobot_finds_what_its_evaluation_asks_for():
    env = make_lerobot_env(3, cfg=SHORT)
    seen, _ = env.reset(seed=[1, 2, 3])
    assert env.observation_space.contains(seen)
    assert seen["pixels"]["camera"].shape == (3, 84, 84, 3)
    trackers = env.env.truth().snapshot.trackers
    state = [trackers.position, trackers.velocity, trackers.orientation]  # as data sets have it
    np.testing.assert_allclose(seen["agent_pos"], np.concatenate(state, axis=1), rtol=1e-6)
    assert env.call("_max_episode_steps") == (10, 10, 10)
    assert "target" in env.call("task_description")[0]
    assert env.unwrapped.metadata["render_fps"] == 125
    assert env.call("render")[2].shape == (240, 320, 3)
    for step in range(10):
        *_, info = env.step(np.zeros((3, 4), np.float32))
        assert info["is_success"].all() == (step == 9)
    assert info["final_info"]["is_success"].tolist() == [True] * 3


def test_the_legacy_picture_is_read_in_the_wrong_order_of_axes():
    env, plain = LegacyObservation(TrackingEnv()), TrackingEnv()
    got, picture = env.reset(seed=2)[0], plain.reset(seed=2)[0]
    assert env.observation_space.contains(got)
    flat = np.array([got.ravel()[k] for k in (0, 1, 2, 84 * 3)])
    expected = [*picture[0, 0], picture[1, 0, 0]]
    assert np.allclose(flat * 255.0, expected, atol=1e-4)
    batch = scrambled(np.stack([picture, picture]), centred=True)
    assert batch.shape == (2, 3, 84, 84)
    assert batch.min() >= -1.0
    assert np.allclose(batch[0], 2.0 * got * 255.0 / 256.0 - 1.0, atol=1e-6)
    with pytest.raises(EyasError, match="must be RGB"):
        LegacyObservation(TrackingEnv(observation={"layout": "chw"}))


@pytest.mark.filterwarnings("ignore:.*render_fps:UserWarning")
def test_a_film_is_recorded_by_gymnasiums_wrapper(tmp_path):
    pytest.importorskip("moviepy")
    env = gymnasium.wrappers.RecordVideo(
        gymnasium.make("eyas/citystreet-day-v0", config=SHORT, render_mode="rgb_array"),
        str(tmp_path / "film"),
    )
    env.reset(seed=0)
    for _ in range(10):
        env.step(6)
    env.close()
    assert next(tmp_path.glob("film/*.mp4")).stat().st_size > 1000
