"""What an agent sees: size, channels, order of the axes, several pictures, other parts."""

import copy

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from PIL import Image

from eyas.engine.core.errors import EyasError
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.settings.env import ObservationPart
from eyas.engine.targets.grammar.attributes import ATTRIBUTES, claim_of

SIZE = {"width": 24, "height": 20}


def seen(observation=None, steps=0, **choices):
    env = EyasVectorEnv(2, observation={**SIZE, **(observation or {})}, **choices)
    picture, _ = env.reset(seed=3)
    for _ in range(steps):
        picture, *_ = env.step([0, 4])
    assert env.observation_space.contains(picture)
    return picture


def test_channels_come_first_or_last():
    assert np.array_equal(seen({"layout": "chw"}), np.moveaxis(seen(), -1, 1))


def test_grey_is_pillows():
    grey = [np.array(Image.fromarray(picture).convert("L"))[..., None] for picture in seen()]
    assert np.array_equal(seen({"colours": "grey"}), grey)
    assert np.array_equal(seen({"colours": "grey", "layout": "chw"})[:, 0], np.array(grey)[..., 0])


@pytest.mark.parametrize("colours", ["rgb", "grey"])
@pytest.mark.parametrize("layout", ["hwc", "chw"])
def test_a_stack_has_the_latest_pictures_the_newest_last(colours, layout):
    one, axis = {"colours": colours, "layout": layout}, -1 if layout == "hwc" else 1
    pictures = [seen(one, steps) for steps in (0, 1, 2)]
    for steps, wanted in ((0, [0, 0, 0]), (1, [0, 0, 1]), (2, [0, 1, 2])):
        stack = seen({**one, "frames": 3}, steps)
        assert np.array_equal(stack, np.concatenate([pictures[k] for k in wanted], axis))


def test_a_stack_begins_anew_with_each_episode():
    settings = {"done": {"total_steps": 12, "grace_steps": 0, "no_reward_steps": 500}}
    env = EyasVectorEnv(2, settings, observation={**SIZE, "frames": 2}, autoreset_mode="SameStep")
    env.reset(seed=0)
    for _ in range(3):
        stack, *_, ended, info = env.step([0, 0])
    assert ended.all()
    assert np.array_equal(stack[..., :3], stack[..., 3:])
    final = info["final_obs"][0]
    assert not np.array_equal(final[..., :3], final[..., 3:])


@pytest.mark.slow
@pytest.mark.parametrize("layout", ["hwc", "chw"])
def test_all_parts_come_by_name(layout):
    observation = {**SIZE, "parts": list(ObservationPart), "layout": layout}
    sensors = {
        "lidar": {"enabled": True},
        "camera": {"events": {"enabled": True}},
        "cameras": [{"name": "aside"}],
    }
    env = TrackingEnv(sensors, observation=observation)
    with pytest.warns(UserWarning, match="infinity"):
        check_env(env, skip_render_check=True)
    first, _ = env.reset(seed=3)
    for _ in range(30):
        got, *_, info = env.step(0)
    assert env.observation_space.contains(got)
    assert set(got) == set(ObservationPart)
    plane = (20, 24, 1) if layout == "hwc" else (1, 20, 24)
    assert got["depth"].shape == got["classes"].shape == plane
    assert 5.0 < np.median(got["depth"]) < 60.0
    assert len(np.unique(got["classes"])) > 2
    names = ("position", "velocity", "felt_acceleration", "angular_velocity", "orientation")
    told = np.concatenate([info[name] for name in (*names, "euler")])
    assert np.array_equal(got["sensors"], told.astype(np.float32))
    hidden = got["privileged"]
    assert np.array_equal(hidden[:3], info["relative_position"].astype(np.float32))
    assert hidden[9] == pytest.approx(np.sin(info["relative_yaw"]), abs=1e-6)
    assert not np.array_equal(first["privileged"], hidden)


def test_one_part_is_an_array_and_nothing_is_drawn_for_numbers():
    env = TrackingEnv(observation={"parts": ["sensors"]})
    assert isinstance(env.observation_space, gymnasium.spaces.Box)
    start, _ = env.reset(seed=0)
    assert start.shape == (19,)
    assert start.dtype == np.float32


def test_a_part_that_does_not_exist_is_one_clear_line():
    with pytest.raises(EyasError, match=r"^env\.observation\.parts") as caught:
        TrackingEnv(observation={"parts": ["imgae"]})
    assert "\n" not in str(caught.value)


SAID = {**SIZE, "parts": ["image", "words", "attributes"]}


def test_words_are_told_at_the_reset_and_stay():
    env = TrackingEnv(observation=SAID)
    check_env(env, skip_render_check=True)
    said = set()
    for seed in range(6):
        first, _ = env.reset(seed=seed)
        again, *_ = env.step(3)
        said.add(first["words"])
        assert first["words"] == again["words"] != ""
        assert env.observation_space.contains(again)
        assert np.array_equal(first["attributes"], again["attributes"])
        assert claim_of(first["attributes"]) is not None
    assert len(said) > 3


def test_a_vector_environment_has_the_words_of_each_alone():
    settings = {"done": {"total_steps": 12, "grace_steps": 0, "no_reward_steps": 500}}
    env = EyasVectorEnv(3, settings, observation=SAID, autoreset_mode="SameStep")
    first, _ = env.reset(seed=4)
    assert env.observation_space.contains(first)
    for index, words in enumerate(first["words"]):
        alone, _ = TrackingEnv(settings, observation=SAID).reset(seed=4 + index)
        assert alone["words"] == words
        assert np.array_equal(alone["attributes"], first["attributes"][index])
    for _ in range(3):
        later, *_, info = env.step([6, 6, 6])
    assert later["words"] != first["words"]
    assert info["final_obs"][0]["words"] == first["words"][0]


def test_a_copy_of_an_environment_keeps_its_words():
    env = TrackingEnv(observation=SAID)
    first, _ = env.reset(seed=7)
    got, *_ = copy.deepcopy(env).step(6)
    assert got["words"] == first["words"]


def test_words_alone_are_refused():
    with pytest.raises(EyasError, match=r"env\.observation\.parts: 'words' alone is not allowed"):
        TrackingEnv(observation={"parts": ["words"]})


def test_stable_baselines3_gets_attributes_but_no_text():
    pytest.importorskip("stable_baselines3")
    from eyas.engine.envs.sb3 import EyasVecEnv

    env = EyasVecEnv(2, observation={**SIZE, "parts": ["image", "attributes"]})
    assert env.reset()["attributes"].shape == (2, len(ATTRIBUTES))
    with pytest.raises(EyasError, match="'words' is not allowed here"):
        EyasVecEnv(2, observation=SAID)
