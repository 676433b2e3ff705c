"""Targets, views and other worlds; the server is real."""

import io

import numpy as np
import pytest
from PIL import Image

from .conftest import WORLD

pytestmark = pytest.mark.slow  # what its tests share takes long to make


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


def test_a_click_chooses_the_person_or_robot_under_it(viewer):
    viewer.say("world", people=30)
    viewer.until(lambda s: viewer.told["world"]["people"] == 30, seconds=120)
    viewer.say("look", view="drone", overlay=True, width=640, height=360)
    for kind in ("Pedestrian", "AiboErs7", "Create"):
        state = viewer.frame()
        while not state["target"]["model"].startswith(kind):
            followed = state["target"]["actor"]
            viewer.say("do", what="next_target")
            viewer.say("do", what="step")
            state = viewer.until(lambda s, f=followed: s["target"]["actor"] != f)
        followed = state["target"]["actor"]
        viewer.say("do", what="reset")
        viewer.say("pace", speed=0)  # nobody walks on until the click
        still = lambda s: s["speed_of_time"] == 0 and s["steps"] < 200 and s["marks"]  # noqa: E731
        x, y = viewer.until(still)["marks"]["target"]
        viewer.say("do", what="next_target")
        viewer.say("do", what="step")
        viewer.until(lambda s, f=followed: s["target"]["actor"] != f)
        viewer.say("click", x=x, y=y)
        viewer.say("do", what="step")
        viewer.until(lambda s, f=followed: s["target"]["actor"] == f)
        viewer.say("pace", speed=1)


def test_dark_light_is_darker_and_the_reward_settings_stay(viewer):
    def brightness():
        return np.mean(Image.open(io.BytesIO(viewer.picture)).convert("L"))

    viewer.say("reward", view_scale=2.0)
    viewer.until(lambda s: viewer.told["reward"]["view_scale"] == 2.0)
    day = brightness()
    viewer.say("world", light="dark")
    viewer.until(lambda s: viewer.told["world"]["light"] == "dark", seconds=120)
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
