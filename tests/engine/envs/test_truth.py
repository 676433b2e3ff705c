"""What teachers are told beside the observations: the state, and how much of targets is visible."""

import copy

import numpy as np

from eyas.engine.core.config import updated, validated
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.policies.sight import subjects, visible_shares
from eyas.engine.settings.config import EyasConfig

SMALL = validated(
    EyasConfig, {"env": {"action_repeat": 16, "observation": {"width": 32, "height": 24}}}
)
MIXED = updated(
    SMALL,
    {
        "env": {
            "mixture": [
                {"weight": 1, "settings": {"world": {"weather": "day"}}},
                {"weight": 1, "settings": {"world": {"weather": "night"}}},
            ]
        }
    },
)


def flown(config, *, measures):
    """Return environments after some steps, and what they have shown."""
    env = EyasVectorEnv(4, config, autoreset_mode="SameStep", measures=measures)
    first, _ = env.reset(seed=7)
    return env, np.stack([first, *(env.step(np.full(4, step % 4))[0] for step in range(12))])


def test_measuring_changes_no_picture_and_is_that_of_the_picture():
    env, shown = flown(SMALL, measures=True)
    plain, same = flown(SMALL, measures=False)
    np.testing.assert_array_equal(shown, same)
    assert (plain.truth().visible == 0.0).all()
    simulation = env._batch._groups[0].batch._simulation
    pixels, _ = subjects(simulation, np.arange(4, dtype=np.int32), (24, 32))
    np.testing.assert_array_equal(env.truth().visible, visible_shares(pixels))
    assert env.truth().visible.any()


def test_the_truth_of_a_mixture_is_in_the_order_of_its_environments():
    env, _ = flown(MIXED, measures=True)
    truth = env.truth()
    for batch, rows in env._batch._groups:
        own = batch.truth()
        np.testing.assert_array_equal(truth.visible[rows], own.visible)
        np.testing.assert_array_equal(
            truth.snapshot.targets.centre[rows], own.snapshot.targets.centre
        )
        np.testing.assert_array_equal(
            truth.snapshot.episodes.tick[rows], own.snapshot.episodes.tick
        )


def test_a_copy_measures_too():
    env, _ = flown(SMALL, measures=True)
    other = copy.deepcopy(env)
    for each in (env, other):
        each.step(np.zeros(4, int))
    np.testing.assert_array_equal(env.truth().visible, other.truth().visible)
    assert other.truth().visible.any()
