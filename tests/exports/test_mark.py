import pytest

from eyas.exports.mark import write_dir_info, write_mark


@pytest.fixture
def labels(frame_label):
    return [
        frame_label(0, reward=0.25, action=-1),
        frame_label(1, reward=1.0, action=3, direction=2),
    ]


def test_marks_are_the_originals_text(tmp_path, labels):
    write_mark(tmp_path / "mark.json", labels, target_direction=False)
    assert (tmp_path / "mark.json").read_text() == (
        '{\n    "000000": [\n        0.25,\n        -1.0\n    ],\n'
        '    "000001": [\n        1.0,\n        3.0\n    ]\n}'
    )


def test_marks_of_the_direction_are_whole_numbers(tmp_path, labels):
    write_mark(tmp_path / "mark.json", labels, target_direction=True)
    assert (tmp_path / "mark.json").read_text() == '{\n    "000000": 1,\n    "000001": 2\n}'


def test_dir_info_counts_frames_of_each_episode(tmp_path):
    write_dir_info(
        tmp_path / "dir_info.json", {"DRONE0": {"episode0": 38, "episode1": 7}, "DRONE1": {}}
    )
    assert (tmp_path / "dir_info.json").read_text() == (
        '{\n    "DRONE0": {\n        "episode0": 38,\n        "episode1": 7\n    },\n'
        '    "DRONE1": {}\n}'
    )
