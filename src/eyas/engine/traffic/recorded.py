"""Conversion of a recording to a motion."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.state.motion import SAMPLE, Motion
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.terrain import Terrain, relief_at, slope_at
from eyas.engine.traffic.lamps import lamps_of
from eyas.engine.traffic.recording import TrafficRecording
from eyas.engine.traffic.recording_file import RecordingFile
from eyas.engine.traffic.smoothing import Tracks, smooth
from eyas.lanes import compiled
from eyas.lanes.elementary import atan, sin_cos


def kept_motion(file: RecordingFile, terrain: Terrain, kind: NDArray[np.int32]) -> Motion:
    """Return `recorded_motion`, kept in the cache.

    Raises:
        DataFileError: The file is damaged or not a recording.
    """
    numbers = cached(
        EntryKind.MOTION,
        partial(_numbers, file, terrain),
        (np.frombuffer(file.data, np.uint8), terrain),
        of=NDArray[np.float32],
    )
    return Motion(numbers.view(SAMPLE)[..., 0], kind, file.outline().rate, 0.0)


def kept_lamps(
    file: RecordingFile,
    motion: Motion,
    network: RoadNetwork,  # The roads of its map
) -> NDArray[np.uint8]:
    """Return `Motion.lamps` of the motion of a file, kept in the cache."""
    return cached(
        EntryKind.MOTION,
        partial(lamps_of, motion.table, motion.rate, network),
        (np.frombuffer(file.data, np.uint8), network),
        of=NDArray[np.uint8],
    )


def _numbers(file: RecordingFile, terrain: Terrain) -> NDArray[np.float32]:
    """Return the numbers of the samples of a recording, shape (S, A, numbers of a sample)."""
    table = table_of(smooth(file.load()), terrain)
    return table.view(np.float32).reshape(*table.shape, -1)


def recorded_motion(
    recording: TrafficRecording,
    terrain: Terrain,  # The ground; roads follow its relief
    kind: NDArray[np.int32],  # Kind of each actor, see `Motion`, shape (A,)
) -> Motion:
    """Return the smoothed motion of a recording, on the ground of its map."""
    assert kind.shape == (recording.actors,), f"kind: shape {kind.shape}"
    return Motion(table_of(smooth(recording), terrain), kind, float(recording.rate), 0.0)


def table_of(tracks: Tracks, terrain: Terrain) -> NDArray[np.void]:
    """Return the `Motion.table` of tracks on a terrain."""
    table = np.zeros(tracks.present.shape, SAMPLE)
    table["x"], table["y"] = np.moveaxis(tracks.position, -1, 0)
    table["velocity_x"], table["velocity_y"] = np.moveaxis(tracks.velocity, -1, 0)
    table["yaw"] = tracks.yaw
    table["yaw_rate"] = tracks.yaw_rate
    table["hitch"] = np.round(tracks.hitch, 6)  # straight is straight
    table["travelled"] = tracks.travelled
    table["present"] = tracks.present
    if terrain.relief.size:  # on flat ground all heights and slopes are 0 already
        _lay(table, terrain)
    return table


@compiled
def _lay(table: NDArray[np.void], terrain: Terrain) -> None:
    """Set the heights and slopes of the samples to those of the ground."""
    for row in range(table.shape[0]):
        for actor in range(table.shape[1]):
            sample = table[row, actor]
            east, north = slope_at(terrain, sample.x, sample.y)
            sample.z = relief_at(terrain, sample.x, sample.y)
            sample.velocity_z = east * sample.velocity_x + north * sample.velocity_y
            sine, cosine = sin_cos(sample.yaw)
            sample.slope = atan(east * cosine + north * sine)
