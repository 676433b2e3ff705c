"""Smooth tracks of traffic that is still being driven: those of a recording, piece by piece."""

from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from eyas.engine.traffic.config import Demand, VehicleType
from eyas.engine.traffic.recording import ANGLE_UNIT, POSITION_UNIT, quantised, restored
from eyas.engine.traffic.smoothing import (
    REACH,
    SIGMA,
    Tracks,
    as_far,
    filtered,
    follow,
    front_path,
    lead_of,
    rate_of,
    runs,
)
from eyas.engine.traffic.sumo import RATE, Drive, SumoRun
from eyas.engine.traffic.trailer import Links, tow
from eyas.lanes import exact

_FILTER = round(REACH * SIGMA * RATE)
"""Samples before and after one that its filtered position depends on."""

_AHEAD = {Demand.KEEP_ALIVE: _FILTER + 2, Demand.RESPAWN: 3 * _FILTER}
"""Samples that are driven before one is smooth: the filter, and the differences of its speed. A
vehicle that is as far along the filtered path as SUMO has it needs more of that path, too."""

_BEFORE = 4 * _FILTER  # Samples before those to smooth that are filtered again

Floats = NDArray[np.float64]


class LiveTracks:
    """Tracks that grow.

    Attributes:
        driven: Number of samples that SUMO has driven.
        ready: Number of samples that are smooth.
        ahead: Number of samples that are driven before one is smooth.
        present: Whether each actor is in the world, shape (S, A).

    Args:
        run: SUMO's simulation.
        samples: Number of all samples, S.
        demand: When vehicles enter and leave, on which smoothing depends.
    """

    def __init__(self, run: SumoRun, samples: int, demand: Demand) -> None:
        self.driven = self.ready = 0
        self._run = run
        self._raw = Drive.create(samples, run.actors, run.vehicle_length)
        self._tracks = Tracks.create(float(RATE), samples, len(run.actors))
        self.present = self._raw.present
        self._yaw = np.full(len(run.actors), np.nan)
        self._grouped = demand is Demand.RESPAWN
        self.ahead = _AHEAD[demand]

    def append(self) -> None:
        """Append SUMO's poses now as a sample, rounded as in a recording."""
        raw, row = self._raw, self.driven
        self._run.read(raw, row)
        here = raw.present[row]
        raw.position[row] = restored(quantised(raw.position[row], POSITION_UNIT), POSITION_UNIT)
        yaw = np.where(here, raw.yaw[row], self._yaw)
        before = np.where(np.isnan(self._yaw), yaw, self._yaw)
        self._yaw = np.unwrap([before, yaw], axis=0)[1]
        raw.yaw[row] = restored(quantised(np.where(here, self._yaw, 0.0), ANGLE_UNIT), ANGLE_UNIT)
        self.driven += 1

    def smooth(self) -> slice:
        """Smooth the samples for which enough is driven; return them."""
        first, tracks = self.ready, self._tracks
        all_driven = self.driven == len(self.present)
        last = self.driven if all_driven else max(self.driven - self.ahead, first)
        window = slice(max(first - _BEFORE, 0), self.driven)
        tracks.present[first:last] = self.present[first:last]
        for actor in range(self.present.shape[1]):
            for begin, end in runs(self.present[window, actor]):
                stay = slice(window.start + begin, window.start + end)
                self._smooth_stay(stay, actor, slice(max(first, stay.start), min(last, stay.stop)))
        self._finish(first, last)
        self.ready = last
        return slice(first, last)

    def rows(self, rows: slice) -> Tracks:
        """Return some samples; the arrays are shared."""
        arrays = {field.name: getattr(self._tracks, field.name) for field in fields(Tracks)}
        rate = arrays.pop("rate")
        return Tracks(rate=rate, **{name: array[rows] for name, array in arrays.items()})

    def _smooth_stay(self, stay: slice, actor: int, wanted: slice) -> None:
        """Smooth some samples of a stay in the world.

        Args:
            stay: Its samples, as far as they are in the window.
            actor: The actor.
            wanted: The samples to write.
        """
        if wanted.start >= wanted.stop:
            return
        tracks, length = self._tracks, float(self._raw.vehicle_length[actor])
        articulated = self._raw.vehicle_types[actor] is VehicleType.TRAILER
        arm = lead_of(length, articulated=articulated)
        yaw = self._raw.yaw[stay, actor]
        driven = front_path(self._raw.position[stay, actor], yaw, arm)
        front = filtered(driven, RATE)
        # In the middle of a stay, the filter has not seen what came before, so its first samples
        # are wrong; they are known, and so is the pose after them.
        within = stay.start > 0 and bool(self.present[stay.start - 1, actor])
        skipped = _FILTER if within else 0
        front, driven, yaw = front[skipped:], driven[skipped:], yaw[skipped:]
        if self._grouped:
            front = as_far(front, driven, yaw)
        begin = stay.start + skipped
        own = slice(wanted.start - begin, wanted.stop - begin)
        heading = float(tracks.yaw[begin, actor] if within else yaw[0])
        if articulated:
            links = Links.straight(heading)
            if within:
                hitch = float(tracks.hitch[begin, actor])
                links = Links.of(front[0], tracks.position[begin, actor], heading, hitch)
            centre, headings, hitches = tow(front, length, links)
            tracks.hitch[wanted, actor] = hitches[own]
        else:
            centre, headings = follow(front, heading, 2.0 * arm)
        tracks.position[wanted, actor] = centre[own]
        tracks.yaw[wanted, actor] = headings[own]
        if len(yaw) > 1:
            tracks.velocity[wanted, actor] = rate_of(centre, RATE)[own]
            tracks.yaw_rate[wanted, actor] = rate_of(headings, RATE)[own]

    def _finish(self, first: int, last: int) -> None:
        """Hold the poses of those who are absent, and add up the ways."""
        tracks = self._tracks
        for row in range(max(first, 1), last):
            absent = ~self.present[row]
            tracks.position[row, absent] = tracks.position[row - 1, absent]
            tracks.yaw[row, absent] = tracks.yaw[row - 1, absent]
            tracks.hitch[row, absent] = 0.0
            step = exact.hypot(*(tracks.position[row] - tracks.position[row - 1]).T)
            step[absent | ~self.present[row - 1]] = 0.0
            tracks.travelled[row] = tracks.travelled[row - 1] + step
