"""Conversion of a recording to a motion."""

from collections.abc import Callable
from functools import cache, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.terrain import Terrain, relief_at, slope_at
from eyas.engine.traffic.lamps import lamps_of
from eyas.engine.traffic.recording_file import RecordingFile
from eyas.engine.traffic.smoothing import Tracks, smooth
from eyas.lanes import compiled
from eyas.lanes.elementary import atan, sin_cos


class Vehicles(NamedTuple):
    """Vehicles whose motion is known in advance, made when it is asked for first."""

    motion: Callable[[], SampledMotion]  # Takes two tenths of a second
    kind: NDArray[np.int32]  # See `Motion`
    lamps: NDArray[np.uint8]  # See `Motion`
    samples: int
    rate: float  # [Hz]
    origin: tuple[object, ...]  # What the motion depends on


def recorded_vehicles(
    file: RecordingFile,
    terrain: Terrain,  # The ground; roads follow its relief
    kind: NDArray[np.int32],  # Kind of each that is in the world, the first of the file
    network: RoadNetwork | None,  # The roads of its map; None: lamps are dark
) -> Vehicles:
    """Return the vehicles of a file; their lamps are kept in the cache.

    Raises:
        DataFileError: The file is damaged or not a recording.
    """
    motion, outline = cache(partial(_first, file, terrain, kind)), file.outline()
    origin = _first, np.frombuffer(file.data, np.uint8), terrain, kind
    lamps = np.zeros((0, 0), np.uint8)
    if network is not None:
        make = partial(_lamps, motion, network)
        lamps = cached(EntryKind.MOTION, make, (*origin, network), of=NDArray[np.uint8])
    return Vehicles(motion, kind, lamps, outline.samples, outline.rate, origin)


def _first(file: RecordingFile, terrain: Terrain, kind: NDArray[np.int32]) -> SampledMotion:
    """Return the motion of the first vehicles of a file."""
    table = table_of(smooth(file.load()), terrain)[:, : len(kind)]
    return SampledMotion(table, kind, file.outline().rate)


def _lamps(motion: Callable[[], SampledMotion], network: RoadNetwork) -> NDArray[np.uint8]:
    made = motion()
    return lamps_of(made.table, made.rate, network)


def table_of(tracks: Tracks, terrain: Terrain) -> NDArray[np.void]:
    """Return the samples of tracks on a terrain."""
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
