"""Rewards, their settings and what would end an episode; the server is real."""

import json
import math
import urllib.request

import pytest

from eyas.dat.settings.adapter import from_original

pytestmark = pytest.mark.slow  # what its tests share takes long to make


def test_rewards_follow_their_settings_at_once(viewer):
    viewer.say("do", what="parked_target")
    viewer.say("reward", type="view", mode="continuous", view_scale=4.0)
    viewer.settled()
    high = viewer.until(lambda s: s["reward"] > 0.9 and s["target"]["parked"])
    viewer.say("reward", view_scale=0.1)
    low = viewer.until(lambda s: s["reward"] < 0.2)
    assert low["p"] == pytest.approx(high["p"], abs=0.05)
    assert low["reward"] == pytest.approx(math.tanh(0.1 * low["p"] ** 3), abs=0.001)
    viewer.say("reward", type="distance", mode="discrete")
    viewer.until(lambda s: s["reward"] == s["kinds"]["distance_discrete"] == 1)
    viewer.say("reward", distance_range=0.01)
    viewer.until(lambda s: s["reward"] == 0)


def test_the_settings_can_be_saved_for_the_original(viewer, served):
    viewer.say("reward", type="view", mode="continuous", view_range=0.55, distance_range=9.0)
    while viewer.told.get("reward", {}).get("view_range") != 0.55:
        viewer.frame()
    with urllib.request.urlopen(served.address + "env_config.json") as answer:
        saved = from_original(json.load(answer))
    assert (saved.reward.view_range, saved.reward.distance_range) == (0.55, 9.0)


def test_reasons_that_would_end_an_episode_are_shown_and_end_nothing(viewer):
    viewer.say("do", what="reset")
    viewer.until(lambda s: s["steps"] < 1500 and "step_limit" not in s["reasons"])
    steps = viewer.until(lambda s: "step_limit" in s["reasons"])["steps"]
    assert viewer.until(lambda s: s["steps"] > steps)["reasons"]
