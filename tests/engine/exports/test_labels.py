import json
import math
from dataclasses import replace

import numpy as np
import pytest

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.optics.pinhole import intrinsics
from eyas.engine.exports import label
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.exports.label import LabelWriter, label_of, read_labels
from eyas.engine.exports.label_reading import reader_of
from eyas.engine.exports.writer import Scores, Summary
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import model_index, sections_of
from eyas.engine.task.done import DoneReason


@pytest.fixture
def written(run, episode, frame):
    """Writes frames; returns the file."""

    def write(*frames):
        part = LabelWriter(run).begin(episode)
        for each in frames:
            part.add(each)
        part.finish()
        return episode.folder / "labels.jsonl"

    return write


def test_labels_read_back_equal(written, frame, episode):
    frames = [frame(0), frame(1, reward=math.nan, reason=DoneReason.STEP_LIMIT)]
    assert read_labels(written(*frames)) == [label_of(each, episode) for each in frames]


def test_each_line_is_a_record_that_any_reader_understands(written, frame):
    path = written(*(frame(number) for number in range(3)))
    records = [json.loads(line) for line in path.read_text().splitlines()]
    assert [record["frame"] for record in records] == [0, 1, 2]
    assert records[2]["target_box"] == [10, 11, 20, 17]


def test_a_label_says_what_the_frame_holds(frame, episode):
    seen = frame(7, action=RecordedAction(3, np.zeros(4)), reason=DoneReason.HEIGHT)
    label = label_of(replace(seen, target=replace(seen.target, words="a red SUV")), episode)
    assert label["target_class_id"] == int(seen.target.object_class)
    assert (label["width"], label["height"]) == (64, 48)
    np.testing.assert_allclose(label["intrinsics"], episode.intrinsics, atol=1e-6)
    assert label["distortion"] == [0.0] * 5
    assert label["target_visible_box"] == [10, 11, 18, 17]
    assert label["target_whole_box"] == [10.25, 10.5, 20.0, 17.0]
    assert label["target_distance"] == round(math.dist((1.1, 2.0, 21.9), (13.0, 2.0, 0.37)), 6)
    assert label["target_words"] == "a red SUV"
    assert (label["frame"], label["step"], label["time"]) == (7, 171, 1.28)
    assert label["episode_time"] == 0.342
    assert (label["action"], label["direction"], label["done"], label["reward"]) == (
        3,
        1,
        True,
        0.5,
    )
    assert (label["visible_fraction"], label["occluded"], label["in_view"]) == (0.75, True, True)
    assert label["relative_position"] == [12.0, 0.0, -21.63]
    assert label["target_velocity"] == [13.0, 0.0, 0.0]


def test_a_label_lists_the_other_vehicles(written, frame):
    other = replace(frame(0).target, object_id=65536 + 9, object_class=ObjectClass.BUS)
    (label,) = read_labels(written(frame(0, others=(other,))))
    (said,) = label["others"]
    assert (label["target_id"], said["id"], said["class_id"]) == (65539, 65545, 12)
    assert (said["box"], said["visible_fraction"], said["type"]) == (
        [10, 11, 20, 17],
        0.75,
        "BmwX5Simple",
    )
    assert (said["centre"], said["velocity"], said["yaw"]) == (
        [13.0, 2.0, 0.37],
        [13.0, 0.0, 0.0],
        0.0,
    )


def test_commands_are_told_by_the_second(frame, episode):
    assert label_of(frame(0), episode)["command"] is None
    flown = frame(0, action=RecordedAction(3, np.array([2.0, -1.0, 0.004, 0.5])))
    assert label_of(flown, episode)["command"] == [2.0, -1.0, 2.0, 0.5]


def test_the_camera_matrix_is_that_of_the_frame(frame, episode):
    seen = frame(0)
    zoomed = replace(seen, camera=replace(seen.camera, field_of_view=0.4))
    np.testing.assert_allclose(
        label_of(zoomed, episode)["intrinsics"], intrinsics(64, 48, 0.4), atol=1e-6
    )


def test_what_is_outside_of_the_picture_is_truncated(frame, episode):
    shares = {
        (10.0, 10.0, 20.0, 20.0): 0.0,
        (-10.0, 10.0, 30.0, 20.0): 0.25,
        (54.0, 38.0, 74.0, 58.0): 0.75,
        (70.0, 10.0, 80.0, 20.0): 1.0,
        (0.0, 0.0, 0.0, 0.0): 1.0,
    }
    for box, share in shares.items():
        seen = frame(0, target=replace(frame(0).target, whole_box=np.array(box)))
        assert label_of(seen, episode)["target_truncated"] == share, box


def test_only_pictures_of_a_sensor_have_time_and_speed(written, frame):
    path = written(frame(0), frame(1, exposure=(1 / 480, 800.0)))
    plain, exposed = read_labels(path)
    assert "iso" not in plain
    assert "exposure_time" not in plain
    assert exposed["exposure_time"] == pytest.approx(1 / 480)
    assert exposed["iso"] == 800.0


def test_only_articulated_vehicles_have_sections(written, frame):
    model = model_index("TruckTrailerSimple")
    bent = replace(frame(0).target.motion, hitch=0.5)
    truck = replace(frame(0).target, sections=sections_of(model), motion=bent)
    path = written(frame(0), frame(1, target=truck, others=(truck, frame(0).target)))
    car, pulled = map(json.loads, path.read_text().splitlines())
    assert "target_sections" not in car
    assert ["sections" in other for other in pulled["others"]] == [True, False]
    first, second = read_labels(path)
    assert "target_sections" not in first
    assert second["target_sections"] == second["others"][0]["sections"]
    assert [section["name"] for section in second["target_sections"]] == ["truck", "trailer"]
    yaws = [section["yaw"] for section in second["target_sections"]]
    assert yaws[1] - yaws[0] == pytest.approx(0.5, abs=1e-6)


def test_a_target_outside_the_picture_is_not_occluded(frame, episode):
    target = replace(frame(0).target, box=np.zeros(4, np.int32), seen_pixels=0, covered_pixels=0)
    label = label_of(frame(0, target=target), episode)
    assert (label["visible_fraction"], label["occluded"], label["in_view"]) == (0.0, False, False)


def test_labels_tell_what_an_episode_came_to(run, written, frame):
    unseen = replace(frame(1).target, seen_pixels=0)
    path = written(frame(0, reward=0.25), frame(1, target=unseen), frame(2, reward=math.inf))
    assert LabelWriter(run).read(path.parent) == Summary(3, Scores(2, 0.75, 2))


def test_labels_that_are_not_there_tell_nothing(run, tmp_path):
    assert LabelWriter(run).read(tmp_path) is None


@pytest.mark.parametrize(
    ("damage", "line"),
    [
        (lambda text: text[:-30], "line 2 is cut off or not JSON"),
        (lambda text: text.replace('"reward"', '"rewind"'), "line 1 is not the label of a frame"),
        (lambda text: text.replace('rs": []', 'rs": [1]'), "line 1 is not the label of a frame"),
    ],
)
def test_damaged_labels_say_where(run, written, frame, damage, line):
    path = written(frame(0), frame(1))
    path.write_text(damage(path.read_text()))
    with pytest.raises(DataFileError, match=line):
        read_labels(path)
    assert LabelWriter(run).read(path.parent) is None


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text.replace('"visible_fraction": 0.75', '"visible_fraction": "all"'),
        lambda text: text.replace('"reward": 0.5', '"reward": [1]'),
        lambda text: text.replace('"reward": 0.5', '"reward": 1' + "0" * 400),
        lambda text: text + "[" * 100_000,
    ],
)
def test_labels_of_someone_else_that_hold_anything_tell_nothing(run, written, frame, damage):
    path = written(frame(0))
    changed = damage(path.read_text())
    assert changed != path.read_text()
    path.write_text(changed)
    assert LabelWriter(run).read(path.parent) is None


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("target_box", [1, 2, 3], "target_box: List should have at least 4 items"),
        ("target_box", [0, 0, 10**30, 1], "target_box.2: Input should be less than"),
        ("target_id", -4, "target_id: Input should be greater than"),
        ("target_class_id", 77, "target_class_id: Input should be 9, 11"),
        ("target_velocity", [math.nan, 0, 0], "target_velocity.0: Input should be a finite"),
        ("target_words", "a car\nand more", "target_words: String should match"),
        ("visible_fraction", 99, "visible_fraction: Input should be less than or equal to 1"),
        ("others", [{"id": 65536}], "others.0.box: Field required"),
        ("frame", 5, "line 1 is of frame 5"),
        ("frame", True, "frame: Input should be a valid integer"),
    ],
)
def test_labels_of_someone_else_are_refused_by_their_schema(written, frame, key, value, told):
    path = written(frame(0))
    path.write_text(json.dumps({**json.loads(path.read_text()), key: value}) + "\n")
    with pytest.raises(DataFileError, match=told) as raised:
        read_labels(path)
    assert "\n" not in str(raised.value)


def test_a_later_field_is_not_asked_of_recordings_that_were_made_before():
    field = label._FRAME["frame"]._replace(later=True)
    schema = label._schema_of({"frame": label._FRAME["frame"], "speed": field})
    assert schema["required"] == ["frame"]
    reader_of(schema).validate_json('{"frame": 0}')
    reader_of(schema).validate_json('{"frame": 0, "speed": 0}')
