"""Smoothing of SUMO's poses: filtered positions, and a heading that a car can follow.

SUMO moves a vehicle sideways and turns it in discrete steps. A Gaussian filter removes the steps
from the path of the front axle; the rear axle follows (a tractrix), which gives the heading. What
pulls a trailer is in `eyas.engine.traffic.trailer`. The filter also spreads braking and starting
over half a second, except with `respawn`: there, as in the original, a vehicle is as far along the
filtered path as SUMO has it.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.traffic.config import Demand, VehicleType
from eyas.engine.traffic.recording import TrafficRecording
from eyas.engine.traffic.tractrix import follow_headings
from eyas.engine.traffic.trailer import Links, tow
from eyas.lanes import exact

SIGMA = 0.3
"""Width of the Gaussian [s]: removes SUMO's 0.1 s steps and moves the path by centimetres only."""

REACH = 4.0  # Half the length of the filter, in widths

WHEELBASE = 0.54  # Axle distance as a share of the vehicle's length: 2.7 m for the 5 m car.

LONGEST_WHEELBASE = 6.0  # Upper limit of the axle distance [m]


@dataclass(slots=True)
class Tracks:
    """Smooth motion of A actors at S samples, world frame. Poses are held while absent."""

    rate: float  # Samples per second [Hz]
    position: NDArray[np.float64]  # Middle of the vehicle's length [m], shape (S, A, 2)
    velocity: NDArray[np.float64]  # [m/s], shape (S, A, 2); 0 while absent
    yaw: NDArray[np.float64]  # Heading without jumps at ±180° [rad], shape (S, A)
    yaw_rate: NDArray[np.float64]  # [rad/s], shape (S, A)
    hitch: NDArray[np.float64]  # Heading of a trailer less that of its truck [rad], shape (S, A)
    travelled: NDArray[np.float64]  # Path length since the recording began [m], shape (S, A)
    present: NDArray[np.bool_]  # Whether the actor is in the world, shape (S, A)

    @classmethod
    def create(cls, rate: float, samples: int, actors: int) -> "Tracks":
        """Return tracks of actors that are absent, at the origin."""
        shape = (samples, actors)
        return cls(
            rate=rate,
            position=np.zeros((*shape, 2)),
            velocity=np.zeros((*shape, 2)),
            yaw=np.zeros(shape),
            yaw_rate=np.zeros(shape),
            hitch=np.zeros(shape),
            travelled=np.zeros(shape),
            present=np.zeros(shape, np.bool_),
        )


def smooth(recording: TrafficRecording) -> Tracks:
    """Return the smooth motion of a recording."""
    shape = recording.present.shape
    tracks = Tracks.create(recording.rate, *shape)
    tracks.present[:] = recording.present
    for actor in range(shape[1]):
        for first, last in runs(recording.present[:, actor]):
            _smooth_run(recording, tracks, actor, slice(first, last))
        present = recording.present[:, actor]
        tracks.position[:, actor] = held(tracks.position[:, actor], present)
        tracks.yaw[:, actor] = held(tracks.yaw[:, actor], present)
        step = np.linalg.norm(np.diff(tracks.position[:, actor], axis=0), axis=1)
        step[~(present[1:] & present[:-1])] = 0.0
        tracks.travelled[1:, actor] = np.cumsum(step)
    return tracks


def lead_of(length: float, *, articulated: bool) -> float:
    """Return how far ahead of the middle of a vehicle of a length that point is whose path is
    filtered [m]: the front axle, of trucks with a trailer SUMO's front, which is on the lane.
    """
    return 0.5 * (length if articulated else min(WHEELBASE * length, LONGEST_WHEELBASE))


def runs(
    present: NDArray[np.bool_],  # Whether the actor is in the world, shape (S,)
) -> list[tuple[int, int]]:
    """Return the first sample and one past the last sample of each stay in the world."""
    edges = np.diff(np.concatenate([[False], present, [False]]).astype(np.int8))
    return list(
        zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True)
    )


def held(
    values: NDArray[np.float64],  # Values at the samples, shape (S, ...)
    present: NDArray[np.bool_],  # Whether the actor is in the world, shape (S,)
) -> NDArray[np.float64]:
    """Return values with each absent sample replaced by the last present one before it.

    Samples before the first present one take its value.
    """
    if not present.any():
        return np.zeros_like(values)
    last = np.maximum.accumulate(np.where(present, np.arange(len(present)), -1))
    source: NDArray[np.float64] = values[np.where(last < 0, int(np.argmax(present)), last)]
    return source


def _smooth_run(recording: TrafficRecording, tracks: Tracks, actor: int, span: slice) -> None:
    yaw, length = recording.yaw[span, actor], float(recording.vehicle_length[actor])
    articulated = recording.vehicle_types[actor] is VehicleType.TRAILER
    arm = lead_of(length, articulated=articulated)
    driven = front_path(recording.position[span, actor], yaw, arm)
    front = filtered(driven, recording.rate)
    if recording.provenance.config.demand is Demand.RESPAWN:
        front = as_far(front, driven, yaw)
    if articulated:
        links = Links.straight(float(yaw[0]))
        centre, heading, tracks.hitch[span, actor] = tow(front, length, links)
    else:
        centre, heading = follow(front, float(yaw[0]), 2.0 * arm)
    tracks.position[span, actor] = centre
    tracks.yaw[span, actor] = heading
    if len(yaw) > 1:
        tracks.velocity[span, actor] = rate_of(centre, recording.rate)
        tracks.yaw_rate[span, actor] = rate_of(heading, recording.rate)


def front_path(
    position: NDArray[np.float64], yaw: NDArray[np.float64], ahead: float
) -> NDArray[np.float64]:
    """Return points ahead of middles (S, 2) with headings (S,) by a distance [m], shape (S, 2)."""
    return position + ahead * np.stack([exact.cos(yaw), exact.sin(yaw)], axis=-1)


def follow(
    front: NDArray[np.float64],  # Path of the front axle [m], shape (S, 2)
    yaw: float,  # Heading at its first point [rad]
    wheelbase: float,  # Distance between the axles [m]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return middle (S, 2) and heading (S,) of a vehicle that is pulled along a path."""
    heading = follow_headings(front, yaw, wheelbase)
    centre = front - 0.5 * wheelbase * np.stack([exact.cos(heading), exact.sin(heading)], axis=-1)
    return centre, heading


def filtered(points: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Return points (S, 2) of a path after the Gaussian filter, at `rate` samples a second.

    Beyond its ends the path is continued by point reflection, so that uniform motion is unchanged.
    """
    sigma = SIGMA * rate
    reach = math.ceil(REACH * sigma)
    weight = exact.exp(-0.5 * np.square(np.arange(-reach, reach + 1) / sigma))
    weight /= weight.sum()
    mirror = np.minimum(np.arange(1, reach + 1), len(points) - 1)
    before = 2 * points[0] - points[mirror[::-1]]
    after = 2 * points[-1] - points[len(points) - 1 - mirror]
    padded = np.concatenate([before, points, after])
    columns = [exact.convolved(padded[:, axis], weight) for axis in range(2)]
    return np.stack(columns, axis=-1)


def as_far(
    path: NDArray[np.float64], driven: NDArray[np.float64], yaw: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the points of a path (S, 2) beside the points driven (S, 2) with headings (S,).

    The path is followed from each of its points by what the point driven is ahead of it; never
    backwards.
    """
    step = exact.hypot(*np.diff(path, axis=0).T)
    length = np.concatenate([[0.0], np.cumsum(step)])
    gap = driven - path
    ahead = gap[:, 0] * exact.cos(yaw) + gap[:, 1] * exact.sin(yaw)
    place = np.maximum.accumulate(length + ahead)
    return np.stack([np.interp(place, length, path[:, axis]) for axis in range(2)], axis=-1)


def rate_of(values: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Return the change per second, by central differences; one-sided at the ends."""
    slope = np.empty_like(values)
    slope[1:-1] = (values[2:] - values[:-2]) * (0.5 * rate)
    slope[0] = (values[1] - values[0]) * rate
    slope[-1] = (values[-1] - values[-2]) * rate
    return slope
