"""Recordings of camera paths and policies: frames, labels, shares, errors in a line."""

import math
import sys

import numpy as np
import pytest

from eyas.cli.app import run
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.optics.pinhole import project
from eyas.engine.exports.label import read_labels
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.video import run as video

SMALL = {"camera": {"width": 64, "height": 48}}
OWN = """
import numpy as np

class Circle:
    env_settings = {"actions": "velocity", "action_repeat": 2}

    def reset(self, box):
        self.box = box

    def act(self, picture):
        assert picture.shape == (84, 84, 3) and picture.dtype == np.uint8
        return [3.0, 0.0, 0.5, 0.7]

class Broken:
    def act(self, picture):
        raise ValueError("no idea")
"""


def labels_of(folder, changes, seed=0):
    """Record labels; return those of each episode of each tracker."""
    settings = {"channels": 1, "writers": ["labels"], "episode_frames": 60, **changes}
    video.run(updated(EyasConfig(seed=seed), {**SMALL, "video": settings}), folder, quiet=True)
    return [read_labels(path) for path in sorted(folder.glob("DRONE*/episode*/labels.jsonl"))]


def test_the_target_moves_in_the_picture_but_stays_there(tmp_path):
    for labels in labels_of(tmp_path, {"channels": 3, "episode_frames": 150}):
        assert all(label["in_view"] for label in labels)
        left, top, right, bottom = np.array([label["target_box"] for label in labels]).T
        assert np.ptp(left + right) + np.ptp(top + bottom) > 6
        commands = np.array([label["command"] for label in labels])
        speed = np.linalg.norm([label["tracker_velocity"] for label in labels], axis=1)
        np.testing.assert_allclose(np.linalg.norm(commands[:, :3], axis=1), speed, atol=0.05)


def test_flights_go_on_smoothly_where_their_poses_are_computed_anew(tmp_path):
    """Poses of 500 steps are computed at once."""
    (labels,) = labels_of(tmp_path, {"fps": 250, "episode_frames": 400})
    place = np.array([label["tracker_position"] for label in labels])
    assert np.abs(np.diff(place, n=2, axis=0)).max() < 2e-4  # a step more or less: 6e-3
    assert np.ptp(place, axis=0).max() > 1.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "asked",
    [
        {"in_view": 0.7, "cut": 0.2},
        {"flight": "orbit", "in_view": 0.5},
        {"flight": "search"},
        {"flight": "fly-by", "hidden": 0.3},
    ],
)
def test_shares_are_reached(tmp_path, asked):
    size = {"width": 160, "height": 120}
    settings = {"channels": 4, "fps": 12.5, "episode_frames": 125, "writers": ["labels"], **asked}
    start = {"pitch": {"uniform": [0.3, 1.0]}}
    moving = {"signals": "amber"}  # who waits at a red light is not hidden for long
    asks = {"camera": size, "start": start, "traffic": moving, "video": settings}
    config = updated(EyasConfig(seed=2), asks)
    video.run(config, tmp_path, quiet=True)
    paths = tmp_path.glob("DRONE*/episode0/labels.jsonl")
    labels = [label for path in paths for label in read_labels(path)]
    assert len(labels) == 500
    seen = [label for label in labels if label["in_view"]]
    reached = {
        "in_view": len(seen) / 500,
        "cut": sum(label["target_truncated"] > 0.0 for label in seen) / 500,
        "hidden": sum(label["visible_fraction"] <= 0.5 for label in seen) / 500,
    }
    wanted = {"in_view": 0.7 if asked.get("flight") == "search" else 1.0, **asked}
    for name in reached.keys() & wanted.keys():
        assert reached[name] == pytest.approx(wanted[name], abs=0.09), name


def test_search_begins_without_the_target_and_finds_it(tmp_path):
    for labels in labels_of(tmp_path, {"flight": "search", "channels": 2, "episode_frames": 250}):
        seen = [label["in_view"] for label in labels]
        assert not seen[0]
        assert sum(seen) > 100


def test_the_small_are_small(tmp_path, capsys):
    areas = []
    for small in (0.0, 1.0):
        told = labels_of(tmp_path / str(small), {"small": small, "flight": "orbit"})
        boxes = np.array([label["target_box"] for labels in told for label in labels])
        areas.append(np.median((boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1])))
    assert areas[0] > 2 * areas[1]
    config = updated(EyasConfig(), {**SMALL, "video": {"channels": 1, "small": 0.5}})
    video.run(updated(config, {"video": {"episode_frames": 25}}), tmp_path / "note")
    assert "note: video.small: 50% of the frames were asked" in capsys.readouterr().out


def test_pictures_and_labels_have_the_zoom_of_their_moment(tmp_path):
    (labels,) = labels_of(tmp_path, {"flight": "zoom", "episode_frames": 200})
    fields = [label["field_of_view"] for label in labels]
    assert max(fields) > 1.5 * min(fields)
    for label in labels:
        focal = 32.0 / math.tan(0.5 * label["field_of_view"])
        assert label["intrinsics"][0][0] == pytest.approx(focal, rel=1e-4)
        rotation, place = label["camera_rotation"], label["camera_position"]
        column, row, _ = project(
            label["target_centre"], place, rotation, 64, 48, label["field_of_view"]
        )
        left, top, right, bottom = label["target_box"]
        assert left - 1 <= column <= right + 1
        assert top - 1 <= row <= bottom + 1


def test_episodes_have_as_many_frames_as_asked(tmp_path):
    changes = {"channels": 2, "episode_frames": 37, "episodes": 3, "fps": 30.0}
    told = labels_of(tmp_path, {**changes, "flight": "orbit"})
    assert [len(labels) for labels in told] == [37] * 6
    for labels in told:
        assert all(label["in_view"] for label in labels)
        assert np.diff([label["time"] for label in labels]).max() < 0.036


def test_the_same_flights_give_the_same_labels_beside_more_trackers(tmp_path):
    one, *_ = labels_of(tmp_path / "1", {"flight": "follow"})
    first, *_ = labels_of(tmp_path / "2", {"flight": "follow", "channels": 3})
    for a, b in zip(one, first, strict=True):
        assert a["tracker_position"] == b["tracker_position"]
        assert a["camera_rotation"] == b["camera_rotation"]
    other, *_ = labels_of(tmp_path / "3", {"flight": "follow"}, seed=1)
    assert other[0]["tracker_position"] != one[0]["tracker_position"]


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["follow", "servo", "fast"])
def test_a_policy_flies_as_in_an_evaluation(tmp_path, policy):
    if policy == "fast":
        pytest.importorskip("onnxruntime")
    settings = {"policy": policy, "channels": 2, "writers": ["labels"], "episode_frames": 200}
    config = load_settings(None, ["start.pitch=1.37", "start.height=22", "start.velocity=rest"])
    settings |= {"fps": 500.0, "warm_up_steps": 0, "start_time": 0.0}
    moving = {"traffic": {"signals": "amber"}}  # beside who stands, a policy may do nothing
    video.run(updated(config, {**SMALL, **moving, "video": settings}), tmp_path, quiet=True)
    for path in tmp_path.glob("DRONE*/episode*/labels.jsonl"):
        labels = read_labels(path)
        assert all(label["reward"] > 0.3 for label in labels)
        actions = [label["action"] for label in labels]
        held = 4 if policy == "follow" else 16
        changes = [k for k in range(1, 200) if actions[k] != actions[k - 1]]
        assert changes
        assert {step % held for step in changes} == {0}
        for label in labels:
            ahead = {0: 40.0, 1: -40.0}.get(label["action"], 0.0)
            assert label["command"][0] == ahead


def test_a_policy_of_ones_own_sees_pictures_and_may_fail(tmp_path, monkeypatch):
    (tmp_path / "own_pilot.py").write_text(OWN)
    monkeypatch.syspath_prepend(tmp_path)
    (labels,) = labels_of(tmp_path / "a", {"policy": "own_pilot:Circle", "episode_frames": 25})
    assert all(label["command"] == pytest.approx([3.0, 0.0, 0.5, 0.7]) for label in labels)
    assert labels[-1]["action"] == -1
    with pytest.raises(ConfigError, match=r"^video.policy: 'own_pilot:Broken' has .* no idea$"):
        labels_of(tmp_path / "b", {"policy": "own_pilot:Broken"})


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--policy", "servo", "--set", "video.flight=orbit"], "exclude each other"),
        (["--policy", "servant"], "did you mean 'servo'"),
        (["--set", "video.flight=orbits"], "did you mean 'orbit'"),
        (["--set", "video.flight=json:loads"], "video.flight"),
        (["--set", "video.flight=orbit", "--set", "traffic.source=live"], "'live', whose future"),
        (["--set", "video.flight=orbit", "--set", "tracker.kind=car"], "which is not a drone"),
        (["--set", "video.in_view=1.5"], "video.in_view: 1.5 is not allowed"),
        (["--set", "video.episode_frames=90000"], "video.episode_frames: 90000 are too many"),
        (["--set", "video.episode_frames=20000", "--set", "video.episodes=9"], "(video.episodes)"),
    ],
)
def test_what_cannot_be_flown_is_told_in_a_line(words, told, tmp_path, monkeypatch, capsys):
    command = ["eyas", "video", "--out", str(tmp_path / "out"), *words]
    monkeypatch.setattr(sys, "argv", command)
    assert run() != 0
    said = capsys.readouterr().err.strip()
    assert told in said
    assert "\n" not in said
    assert not (tmp_path / "out").exists()


def test_a_policy_takes_the_place_of_the_flight_of_a_file(tmp_path, monkeypatch):
    words = ["--preset", "dat-eval", "--policy", "follow", "--quiet"]
    brief = {"video.channels": 1, "video.episode_frames": 5, "video.writers": '["labels"]'}
    sets = [word for key, value in brief.items() for word in ("--set", f"{key}={value}")]
    monkeypatch.setattr(sys, "argv", ["eyas", "video", "--out", str(tmp_path), *words, *sets])
    assert run() == 0
    assert len(read_labels(tmp_path / "DRONE0" / "episode0" / "labels.jsonl")) == 5
