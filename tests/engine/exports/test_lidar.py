import dataclasses

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.exports.episode_files import LidarWriter
from eyas.engine.exports.writer import Summary
from eyas.engine.sim.config import SimConfig


def test_distances_are_read_back_from_the_table(run, episode, frame):
    writer = LidarWriter(run)
    part = writer.begin(episode)
    ranges = np.array([[0.25, np.inf, 12.0], [np.inf, 3.14, 1.5]])
    for number in range(2):
        part.add(frame(number, lidar=ranges[number]))
    part.finish()
    assert writer.read(episode.folder) == Summary(2)
    lines = (episode.folder / "lidar.csv").read_text().splitlines()
    assert lines[0] == "frame,step,point_0,point_1,point_2"
    rows = [[float(word or "inf") for word in line.split(",")] for line in lines[1:]]
    assert [row[:2] for row in rows] == [[0, 31], [1, 51]]
    assert np.array_equal([row[2:] for row in rows], ranges)


def test_a_table_without_a_lidar_is_refused_in_one_line(run):
    run = dataclasses.replace(run, config=SimConfig())
    with pytest.raises(ConfigError, match=r"^video\.writers: 'lidar' needs lidar\.enabled"):
        LidarWriter(run)
