"""Recordings, and who flies in the place of the keys; the server is real."""

import json

import pytest

from eyas.engine.core.config import validated
from eyas.engine.settings.config import EyasConfig

from .conftest import Viewer, moved

pytestmark = pytest.mark.slow  # what its tests share takes long to make


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


def test_it_opens_with_a_chase(serve):
    viewer = Viewer(serve().socket)
    state = viewer.until(lambda s: s["target"]["speed"] > 1.0)
    assert (state["flies"], state["view"]) == ("follow", "chase")
    assert state["offset"] < 3
    viewer.hold("forward")
    viewer.until(lambda s: s["flies"] is None)
    viewer.close()


def test_who_flies_by_itself_appears_over_the_next_target(viewer):
    """On the straight way to it stand houses."""
    viewer.say("fly", policy="follow")
    viewer.until(lambda s: s["flies"] == "follow")
    for _ in range(3):
        actor = viewer.frame()["target"]["actor"]
        viewer.say("do", what="next_target")
        state = viewer.until(lambda s, actor=actor: s["target"]["actor"] != actor)
        assert state["offset"] < 30
        viewer.until(lambda s: s["offset"] < 3, seconds=5)


def test_a_duel_that_is_asked_for_while_a_world_is_built_begins_in_it(viewer):
    viewer.say("world", vehicles=20)
    viewer.until(lambda s: viewer.told["busy"])
    viewer.say("duel", policy="follow")
    state = viewer.until(lambda s: s["duel"], seconds=120)
    assert viewer.told["world"]["vehicles"] == 20
    assert "begins in the new world" in viewer.told["say"]
    assert state["duel"]["stage"] == "you"
    assert state["duel"]["ready"] > 0
