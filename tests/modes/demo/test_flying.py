"""Flying by messages: keys, targets, rewards, worlds, recordings, pilots; the server is real."""

import io
import json
import math
import time
import urllib.request

import numpy as np
import pytest
from PIL import Image

from eyas.core.config import validated
from eyas.settings.config import EyasConfig
from eyas.settings.legacy.adapter import from_legacy

from .conftest import WORLD, Viewer


def turn(yaw, before):
    return (yaw - before + math.pi) % (2 * math.pi) - math.pi


def moved(before, after):
    """Forward, left, up [m] and turn to the left [rad] from one state to another."""
    x, y, z, yaw = before["drone"]
    dx, dy = after["drone"][0] - x, after["drone"][1] - y
    return {
        "forward": math.cos(yaw) * dx + math.sin(yaw) * dy,
        "left": -math.sin(yaw) * dx + math.cos(yaw) * dy,
        "up": after["drone"][2] - z,
        "turn": turn(after["drone"][3], yaw),
        "pitch": after["pitch"] - before["pitch"],
        "camera": after["camera_yaw"] - before["camera_yaw"],
    }


KEYS = {
    "forward": ("forward", 1),
    "back": ("forward", -1),
    "left": ("left", 1),
    "right": ("left", -1),
    "climb": ("up", 1),
    "sink": ("up", -1),
    "turn_left": ("turn", 1),
    "turn_right": ("turn", -1),
    "camera_up": ("pitch", -1),
    "camera_down": ("pitch", 1),
    "camera_left": ("camera", 1),
    "camera_right": ("camera", -1),
}
LEAST = {"forward": 1.0, "left": 1.0, "up": 0.3, "turn": 0.1, "pitch": 3.0, "camera": 3.0}


def test_each_key_moves_what_it_names(viewer):
    for key, (quantity, sign) in KEYS.items():
        viewer.say("do", what="reset")
        before = viewer.settled()
        viewer.hold(key)
        after = viewer.until(
            lambda s, b=before, q=quantity: abs(moved(b, s)[q]) > LEAST[q],
            while_waiting=lambda key=key: viewer.hold(key),
        )
        found = moved(before, after)
        assert sign * found.pop(quantity) > 0, key
        for other, value in found.items():
            assert abs(value) < LEAST[other] * 0.5, (key, other)


def test_several_keys_act_at_once(viewer):
    before = viewer.settled()
    viewer.hold("forward", "climb")
    viewer.until(
        lambda s: moved(before, s)["forward"] > 1 and moved(before, s)["up"] > 0.3,
        while_waiting=lambda: viewer.hold("forward", "climb"),
    )


def test_centre_turns_the_camera_back(viewer):
    viewer.say("do", what="reset")
    before = viewer.settled()
    viewer.hold("camera_up", "camera_left")
    hold = lambda: viewer.hold("camera_up", "camera_left")  # noqa: E731
    viewer.until(lambda s: abs(s["camera_yaw"]) > 5, while_waiting=hold)
    viewer.hold("camera_centre")
    after = viewer.until(lambda s: abs(s["camera_yaw"]) < 0.1, while_waiting=viewer.hold)
    assert after["pitch"] == pytest.approx(before["pitch"], abs=0.2)


def test_a_silent_page_lets_the_drone_stop(viewer):
    viewer.settled()
    viewer.hold("forward")
    viewer.until(lambda s: s["speed"] > 5)
    # No further word of keys, as after a crash of the page.
    viewer.until(lambda s: s["speed"] < 0.1)


def test_time_goes_on_by_the_clock_and_can_stand_still(viewer):
    first = viewer.frame()
    viewer.until(lambda s: s["time"] > first["time"] + 0.5)
    viewer.say("pace", speed=0)
    still = viewer.until(lambda s: s["speed_of_time"] == 0)
    time.sleep(0.3)
    assert viewer.frame()["time"] == viewer.frame()["time"] == pytest.approx(still["time"])
    viewer.say("do", what="step")
    after = viewer.until(lambda s: s["time"] > still["time"])
    assert after["time"] - still["time"] == pytest.approx(0.008)


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
        saved = from_legacy(json.load(answer))
    assert (saved.reward.view_range, saved.reward.distance_range) == (0.55, 9.0)


def test_reasons_that_would_end_an_episode_are_shown_and_end_nothing(viewer):
    viewer.say("do", what="reset")
    viewer.until(lambda s: s["steps"] < 1500 and "step_limit" not in s["reasons"])
    steps = viewer.until(lambda s: "step_limit" in s["reasons"])["steps"]
    assert viewer.until(lambda s: s["steps"] > steps)["reasons"]


def test_a_click_chooses_the_car_under_it(viewer):
    viewer.say("look", view="drone", overlay=True, width=640, height=360)
    viewer.say("do", what="parked_target")
    viewer.say("do", what="next_target")
    other = viewer.until(lambda s: not s["target"]["parked"])["target"]["actor"]
    # The parked car is still in the picture, for the drone has not moved.
    viewer.say("click", x=0.01, y=0.01)
    assert viewer.settled()["target"]["actor"] == other
    viewer.say("do", what="parked_target")
    state = viewer.until(lambda s: s["target"]["parked"] and s["marks"] and s["marks"]["target"])
    x, y = state["marks"]["target"]
    viewer.say("do", what="next_target")
    viewer.until(lambda s: not s["target"]["parked"])
    viewer.say("click", x=x, y=y)
    viewer.until(lambda s: s["target"]["parked"])


def test_pictures_show_what_the_view_is(viewer):
    sizes = set()
    pictures = []
    for view in ("drone", "chase", "top"):
        viewer.say("look", view=view, overlay=True, width=320, height=180)
        state = viewer.until(lambda s, v=view: s["view"] == v and s["marks"])
        pictures.append(Image.open(io.BytesIO(viewer.picture)).convert("RGB").resize((32, 18)))
        assert Image.open(io.BytesIO(viewer.picture)).size == tuple(state["size"])
        assert state["marks"]["seen"]
        sizes.add(tuple(state["size"]))
    assert len({picture.tobytes() for picture in pictures}) == 3


def test_another_weather_and_thinner_traffic(viewer):
    cars = len(viewer.until(lambda s: "traffic" in s)["traffic"])
    viewer.say("world", weather="night", vehicles=5)
    state = viewer.until(lambda s: len(s.get("traffic", range(99))) == 6, seconds=120)
    assert cars > 6
    assert viewer.told["world"] == WORLD | {"weather": "night", "vehicles": 5, "parked": True}
    assert state["target"]["parked"]


def test_frames_go_on_while_another_world_is_built_and_show_it_then(viewer):
    first = viewer.frame()["frame"]
    viewer.say("world", target="Pedestrian", tracker="flown")
    busy = viewer.until(lambda s: viewer.told["busy"])
    assert busy["target"]["parked"]
    assert viewer.told["busy"] == "simpleway-grass, day"
    state = viewer.until(lambda s: not viewer.told["busy"] and not s["target"]["parked"], 120)
    assert state["frame"] > first + 3
    chosen = viewer.told["world"]
    assert (chosen["target"], chosen["tracker"], chosen["parked"]) == ("Pedestrian", "flown", False)
    assert state["target"]["model"].startswith("Pedestrian")


def test_a_click_chooses_a_person_under_it(viewer):
    viewer.say("world", target="Pedestrian")
    viewer.until(lambda s: s["target"]["model"].startswith("Pedestrian"), seconds=120)
    viewer.say("look", view="drone", overlay=True, width=640, height=360)
    state = viewer.until(lambda s: s["view"] == "drone" and s["marks"] and s["marks"]["target"])
    followed = state["target"]["actor"]
    viewer.say("pace", speed=0)  # nobody walks on until the click
    state = viewer.until(lambda s: s["speed_of_time"] == 0 and s["marks"] and s["marks"]["target"])
    x, y = state["marks"]["target"]
    viewer.say("do", what="next_target")
    viewer.say("do", what="step")
    viewer.until(lambda s: s["target"]["actor"] != followed)
    viewer.say("click", x=x, y=y)
    viewer.say("do", what="step")
    viewer.until(lambda s: s["target"]["actor"] == followed)


def test_dusk_is_darker_and_the_reward_settings_stay(viewer):
    def brightness():
        return np.mean(Image.open(io.BytesIO(viewer.picture)).convert("L"))

    viewer.say("reward", view_scale=2.0)
    viewer.until(lambda s: viewer.told["reward"]["view_scale"] == 2.0)
    day = brightness()
    viewer.say("world", light="dusk")
    viewer.until(lambda s: viewer.told["world"]["light"] == "dusk", seconds=120)
    viewer.frame()
    assert brightness() < 0.7 * day
    assert viewer.told["reward"]["view_scale"] == 2.0


def test_a_world_that_does_not_exist_changes_nothing(viewer):
    before = viewer.until(lambda s: "traffic" in s)
    viewer.say("world", map="simpleway-gras")
    viewer.until(lambda s: viewer.errors)
    assert "simpleway-grass" in viewer.errors[0]
    after = viewer.until(lambda s: "traffic" in s)
    assert len(after["traffic"]) == len(before["traffic"])


def test_a_recording_is_a_whole_folder_of_eyas_video(viewer, served):
    before = set((served.folder / "runs/demo").glob("*"))
    viewer.say("record", on=True)
    viewer.until(lambda s: (s["recorded"] or 0) >= 4)
    viewer.say("record", on=False)
    viewer.until(lambda s: s["recorded"] is None)
    (folder,) = set((served.folder / "runs/demo").iterdir()) - before
    validated(EyasConfig, json.loads((folder / "config.json").read_text()))
    episode = folder / "DRONE0/episode0"
    pictures = sorted(episode.glob("*.jpeg"))
    assert len(pictures) >= 4
    assert set(json.loads((episode / "mark.json").read_text())) == {p.stem for p in pictures}
    assert not list(folder.rglob("*.part"))


def test_a_policy_follows_and_a_key_takes_over(viewer):
    viewer.say("do", what="next_target")
    viewer.say("do", what="reset")
    viewer.settled()
    viewer.say("fly", policy="follow")
    begun = viewer.until(lambda s: s["flies"] == "follow")["time"]
    state = viewer.until(lambda s: s["time"] > begun + 3)
    assert state["offset"] < 3
    viewer.hold("forward")
    viewer.until(lambda s: s["flies"] is None)


def test_only_policies_that_were_offered_fly(viewer):
    viewer.say("fly", policy="os:getcwd")
    viewer.until(lambda s: viewer.errors)
    assert "os:getcwd" in viewer.errors[0]


def test_a_policy_that_fails_hands_the_controls_back(serve):
    served = serve("--policy", "statistics:median")  # of a picture, it cannot be told
    viewer = Viewer(served.socket)
    viewer.say("fly", policy="statistics:median")
    viewer.until(lambda s: viewer.errors and s["flies"] is None)
    assert viewer.errors[0].startswith("policy 'statistics:median': failed: ")
    viewer.close()


def test_boxes_of_a_tracker_outside_steer(viewer):
    viewer.say("do", what="reset")
    before = viewer.settled()
    viewer.say("fly", policy="boxes")
    far_right = lambda: viewer.say("box", box=[0.9, 0.45, 1.0, 0.55])  # noqa: E731
    after = viewer.until(lambda s: moved(before, s)["left"] < -1, while_waiting=far_right)
    assert abs(moved(before, after)["forward"]) < 0.3
    viewer.until(lambda s: s["speed"] < 0.1)  # without boxes it stops


def test_a_duel_begins_at_the_same_place_for_both(viewer):
    viewer.say("duel", policy="follow")
    state = viewer.until(lambda s: s["duel"] and s["duel"]["ready"] > 0)
    assert state["duel"]["stage"] == "you"
    start = state["drone"], state["target"]["actor"], state["time"]
    viewer.errors.clear()
    viewer.say("pace", speed=0)  # would be unfair
    viewer.until(lambda s: viewer.errors)
    viewer.say("duel", policy=None)
    viewer.until(lambda s: s["duel"] is None)
    viewer.say("duel", policy="follow")
    state = viewer.until(lambda s: s["duel"] and s["duel"]["ready"] > 0)
    assert (state["drone"], state["target"]["actor"], state["time"]) == start
    viewer.say("duel", policy=None)
    viewer.until(lambda s: s["duel"] is None)
