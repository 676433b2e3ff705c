import json
from dataclasses import replace

import numpy as np
import pytest

from eyas.engine.exports.episode_files import MarkWriter
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.exports.writer import EndedEpisode, Summary
from eyas.engine.task.direction import TargetDirection


@pytest.fixture
def frames(frame):
    turn = {"action": RecordedAction(3, np.zeros(4)), "direction": TargetDirection.LEFT}
    return [frame(0, reward=0.25), frame(1, reward=1.0, **turn)]


def write(run, episode, frames) -> str:
    part = MarkWriter(run).begin(episode)
    for frame in frames:
        part.add(frame)
    part.finish()
    return (episode.folder / "mark.json").read_text()


def test_marks_are_the_originals_text(run, episode, frames):
    assert write(run, episode, frames) == (
        '{\n    "000000": [\n        0.25,\n        -1.0\n    ],\n'
        '    "000001": [\n        1.0,\n        3.0\n    ]\n}'
    )
    assert MarkWriter(run).read(episode.folder) == Summary(2)


def test_marks_of_the_direction_are_whole_numbers(run, episode, frames):
    text = write(replace(run, target_direction=True), episode, frames)
    assert text == '{\n    "000000": 1,\n    "000001": 2\n}'


def test_rewards_are_whole_doubles_and_what_is_no_number_is_null(run, episode, frame):
    text = write(run, episode, [frame(0, reward=0.1 + 0.2), frame(1, reward=float("nan"))])
    rewards = [reward for reward, _ in json.loads(text).values()]
    assert rewards == [0.1 + 0.2, None]


@pytest.mark.parametrize("text", [None, '{\n    "000000": [\n', "3", "[1]", "[" * 100_000])
def test_marks_that_are_missing_or_cut_off_are_not_whole(run, episode, text):
    if text is not None:
        (episode.folder / "mark.json").write_text(text)
    assert MarkWriter(run).read(episode.folder) is None


def test_dir_info_counts_frames_of_each_episode(run, episode):
    ended = [
        EndedEpisode(episode, Summary(38)),
        EndedEpisode(replace(episode, number=1), Summary(7)),
    ]
    MarkWriter(run).finish(ended)
    assert (run.folder / "dir_info.json").read_text() == (
        '{\n    "DRONE0": {\n        "episode0": 38,\n        "episode1": 7\n    },\n'
        '    "DRONE1": {}\n}'
    )
