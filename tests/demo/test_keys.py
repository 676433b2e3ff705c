"""Flying by keys, which come as messages; the server is real."""

import time

import pytest

from .conftest import moved

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
