"""Tracks in files of others, put on a map: the bodies of `custom.trajectory`."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.doors import brought, brought_object, installed
from eyas.engine.core.errors import DataFileError
from eyas.engine.custom.trajectory import Track, Trajectory, read_table, trajectory_of
from eyas.engine.world.projection import Projection
from eyas.lanes import exact

Floats = NDArray[np.float64]

GROUP = "eyas.track_files"
"""What houses and packages bring to read other endings: a function of a path that returns tracks,
or raises a `DataFileError` of one line."""

_NEAREST, _FARTHEST = 0.05, 85.0
"""Distance below which two points without times are one [m]; latitude to which tracks are put on
maps [degrees]."""


class Placement(NamedTuple):
    """Where and how fast tracks are on a map."""

    map_name: str
    projection: Projection | None  # Where the map lies on earth; None: nowhere
    at: tuple[float, float, float] | None = None
    """East and north of the first point [m], and the angle by which tracks are turned about it
    [rad]; None: where the file says."""
    speed: float = 1.0  # Of tracks without times [m/s]
    aloft: bool = False  # Whether heights are kept, counted from the first; else the ground's are


def endings() -> tuple[str, ...]:
    """Return the endings of the files that can be read."""
    return (".csv", *brought(GROUP), *installed(GROUP))


def is_track(path: Path) -> bool:
    """Return whether a file is taken for tracks, by its ending."""
    return path.suffix.lower() in endings()


def tracks_in(path: Path) -> list[Track]:
    """Return the tracks of a file.

    Raises:
        DataFileError: It is no file of tracks, or damaged: one line.
    """
    ending = path.suffix.lower()
    if ending in ("", ".csv"):
        return read_table(path)
    read = brought_object(GROUP, ending)
    if read is None:
        raise DataFileError(
            f"{path}: {ending} is not read as a track; allowed: {', '.join(endings())}"
        )
    tracks = read(path)
    times = [track.time for track in tracks if track.time is not None]
    moved = any(np.ptp(track.place[:, :2], axis=0).any() for track in tracks)
    if times and moved and np.ptp(np.concatenate(times)) == 0.0:  # a program has filled them in
        tracks = [track._replace(time=None, yaw=None) for track in tracks]
    tracks = [_rising(track) for track in tracks]
    for track in tracks:
        if not (np.abs(track.place[:, :2]) <= (180.0 if track.on_earth else 1e9)).all():
            raise DataFileError(f"{path}: a place is not finite, or nowhere on earth")
    # A receiver that lost its signal leaves tracks of one point beside others.
    return [track for track in tracks if len(track.place) > 1] or tracks


def _rising(track: Track) -> Track:
    """Return a track in the order of its times, without those that repeat, as receivers do."""
    if track.time is None:
        return track
    order = np.argsort(track.time, kind="stable")
    time = track.time[order]
    kept = order[np.concatenate([[True], np.diff(time) > 0.0])]
    yaw = None if track.yaw is None else track.yaw[kept]
    return track._replace(time=track.time[kept], place=track.place[kept], yaw=yaw)


def on_map(files: Sequence[Path], placement: Placement) -> list[tuple[float, Trajectory]]:
    """Return the tracks of some files on a map, each with the time at which it begins [s].

    Raises:
        DataFileError: A file is no track, or is not placed on this map: one line.
    """
    found = [(path, track) for path in files for track in tracks_in(path)]
    if not found:
        raise DataFileError(f"{files[0]}: holds no track")
    first = found[0][1].place[0]
    placed = []
    for path, track in found:
        places, yaw = _metres(path, track, first, placement)
        time = track.time
        if time is None:
            places, time = _timed(path, places, placement.speed)
            yaw = None
        start = float(time[0]) if len(time) else 0.0
        placed.append((start, trajectory_of(path, time, places, yaw)))
    starts = [start for start, _ in placed]
    # Tracks of one outing share a clock; those of others begin together.
    together = max(starts) - min(starts) <= max(each.time[-1] for _, each in placed)
    return [(start - min(starts) if together else 0.0, each) for start, each in placed]


def _metres(
    path: Path, track: Track, first: Floats, placement: Placement
) -> tuple[Floats, Floats | None]:
    """Return places in metres of the map, shape (N, 3), and headings."""
    places, yaw = track.place.copy(), track.yaw
    if track.on_earth:
        if (np.abs(places[:, 1]) > _FARTHEST).any():
            raise DataFileError(f"{path}: a latitude beyond {_FARTHEST:g} degrees")
        projection = placement.projection
        if placement.at is not None:
            projection = Projection(float(first[0]), float(first[1]))
        if projection is None:
            raise DataFileError(
                f"{path}: has longitudes and latitudes, but the map '{placement.map_name}' lies "
                "nowhere on earth: import the place (eyas maps import), or put the first point "
                "on this map, as with custom.at=[0,0,0]"
            )
        middle = places[:, :2].mean(axis=0)
        away = np.abs(middle - (projection.longitude, projection.latitude)).max()
        if away > 1.0:
            raise DataFileError(
                f"{path}: is at {_degrees(middle)}, the map '{placement.map_name}' at "
                f"{_degrees((projection.longitude, projection.latitude))}"
            )
        # Altitudes are above the sea, or what a phone takes for it: a target stays on the ground.
        height = places[:, 2] - places[0, 2] if placement.aloft else np.full(len(places), np.nan)
        places = np.column_stack([projection.metres(places[:, :2]), height])
    elif placement.aloft:
        places[:, 2] -= places[0, 2]
    if placement.at is None:
        return places, yaw
    x, y, turn = placement.at
    origin = np.zeros(2) if track.on_earth else first[:2]
    offset = places[:, :2] - origin
    cosine, sine = float(exact.cos(turn)), float(exact.sin(turn))
    places[:, 0] = x + cosine * offset[:, 0] - sine * offset[:, 1]
    places[:, 1] = y + sine * offset[:, 0] + cosine * offset[:, 1]
    return places, None if yaw is None else yaw + turn


def _degrees(place: Sequence[float] | Floats) -> str:
    longitude, latitude = (float(each) for each in place)
    return f"latitude {latitude:.4f}, longitude {longitude:.4f}"


def _timed(path: Path, places: Floats, speed: float) -> tuple[Floats, Floats]:
    """Return places without those that repeat the one before, and times at one speed."""
    steps = np.diff(places[:, :2], axis=0)
    length = exact.hypot(steps[:, 0], steps[:, 1])
    kept = np.concatenate([[True], length > _NEAREST])
    places = places[kept]
    steps = np.diff(places[:, :2], axis=0)
    if not len(steps):
        raise DataFileError(f"{path}: all points are one place")
    length = exact.hypot(steps[:, 0], steps[:, 1])
    return places, np.concatenate([[0.0], np.cumsum(length)]) / speed
