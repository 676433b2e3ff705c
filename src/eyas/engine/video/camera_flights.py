"""Flies the trackers of a recording along planned camera paths."""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.rng import stream
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.flights.path import CameraPath
from eyas.engine.sim.flights.plan import FlightPlan, FlightSurroundings, Wishes, plan_flight
from eyas.engine.sim.flights.shares import Asked
from eyas.engine.sim.flights.signals import STEP, sampled_at
from eyas.engine.sim.simulation import Simulation
from eyas.engine.video.logged_flights import LoggedFlight
from eyas.lanes import exact

Floats = NDArray[np.float64]

_STEP_TICKS = round(STEP / PHYSICS_STEP)
_MORE = 4  # Control points before the first step and after the last one, which lead the spline
_COURSE = 5  # The target's course is read once in so many control points: its recording has 10 Hz


_BLOCK = 500
"""Physics steps of which poses are computed at once: one by one takes ten times as long."""

_POSE, _ANGLES, _FIELD = slice(0, 4), slice(4, 6), 6
"""Columns: east, north, up, heading; the camera's pitch and yaw; its field of view."""

_SAMPLED = [0, 1, 2, 3, 4, 6]  # Those that a flight has: its cameras turn with the body


class _Flown(NamedTuple):
    """The flight of a tracker's episode."""

    points: Floats
    begun: int  # Tick of the second control point


class CameraFlights:
    """Trackers on camera paths, each planned at the start of its episode."""

    def __init__(
        self, sim: Simulation, config: EyasConfig, path: CameraPath | LoggedFlight
    ) -> None:
        video, camera = config.video, config.camera
        shares = Asked(video.in_view, video.hidden, video.cut, video.small)
        self._sim, self._seed = sim, config.seed
        self._path = path
        self._moved = 0  # Steps so far
        self._lead: float | None = None  # Time before the first frame [s], when it is known
        self._start = config.start
        self._shares = shares
        self._picture = camera.width, camera.height
        self._start_time, self._warm_up_steps = video.start_time, video.warm_up_steps
        self._flown: list[_Flown | None] = [None] * sim.count
        self._now = self._before = np.zeros((sim.count, 7))
        self._next = np.zeros((0, sim.count, 7))

    def begin(self, trackers: NDArray[np.int64], longest: int) -> None:
        """Plan the flights of these trackers, and put them where they begin."""
        for tracker in trackers.tolist():
            begun = int(self._sim.snapshot.episodes.tick[tracker])
            points = self._points(tracker, longest)
            self._flown[tracker] = _Flown(points, begun)
            self._now[tracker, _SAMPLED] = sampled_at(points, np.zeros(1))[0]
        self._sim.start_at(trackers, self._now[trackers, _POSE], self._now[trackers, 4])
        self._compute(trackers.tolist())

    def move(self) -> None:
        """Advance the simulation by one 2 ms step."""
        if not len(self._next):
            self._next = np.zeros((_BLOCK, *self._now.shape))
            self._compute(range(self._sim.count))
        self._before, self._now, self._next = self._now, self._next[0], self._next[1:]
        self._moved += 1
        self._sim.command_gimbal(self._now[:, _ANGLES])
        self._sim.set_fields_of_view(self._now[:, _FIELD])
        self._sim.place(self._now[:, _POSE])

    def _compute(self, trackers: Iterable[int]) -> None:
        """Compute where some trackers are after the next steps."""
        ticks, ahead = self._sim.snapshot.episodes.tick, 1 + np.arange(len(self._next))
        for tracker in trackers:
            flown = self._flown[tracker]
            assert flown is not None
            times = np.multiply(int(ticks[tracker]) - flown.begun + ahead, PHYSICS_STEP)
            self._next[:, tracker, _SAMPLED] = sampled_at(flown.points, times)

    def action(self, tracker: int) -> RecordedAction:
        """Return the command that moves a drone as the path did in the last step."""
        east, north, up, turn = (self._now - self._before)[tracker, :4].tolist()
        yaw = self._before[tracker, 3]
        cosine, sine = float(exact.cos(yaw)), float(exact.sin(yaw))
        ahead, left = cosine * east + sine * north, cosine * north - sine * east
        command = [ahead / PHYSICS_STEP, left / PHYSICS_STEP, up, turn / PHYSICS_STEP]
        return RecordedAction(-1, np.array(command))

    def _points(self, tracker: int, longest: int) -> Floats:
        """Return the control points of a tracker's flight."""
        count = -(-longest // _STEP_TICKS) + _MORE
        if not isinstance(self._path, LoggedFlight):
            wishes = Wishes(self._path, self._start.height, self._start.pitch, self._shares)
            return self._planned(tracker, wishes, count).points
        number = int(self._sim.snapshot.episodes.number[tracker])
        lens = float(self._sim.snapshot.cameras.field_of_view[tracker])
        if self._lead is None:
            self._lead = (self._unseen(tracker) - 1) * STEP
        # The log begins with the first frame, and goes on through all episodes.
        since = self._moved * PHYSICS_STEP - self._lead
        return self._path.points(tracker, number, since, count, lens)

    def _planned(self, tracker: int, wishes: Wishes, count: int) -> FlightPlan:
        episodes, targets = self._sim.snapshot.episodes, self._sim.snapshot.targets
        target, heading, ground = self._course(tracker, count)
        around = FlightSurroundings(
            target,
            heading,
            ground,
            targets.size[tracker].copy(),
            float(self._sim.snapshot.cameras.field_of_view[tracker]),
            self._picture,
            self._sim.clearance,
            self._others(tracker, count),
            self._unseen(tracker),
        )
        rng = stream(self._seed, "flight", tracker, int(episodes.number[tracker]))
        return plan_flight(around, wishes, rng)

    def _unseen(self, tracker: int) -> int:
        """Return the number of control points before the first frame of an episode."""
        tick = int(self._sim.snapshot.episodes.tick[tracker])
        steps = max(self._start_time / PHYSICS_STEP - tick, self._warm_up_steps)
        return 1 + math.ceil(steps / _STEP_TICKS)

    def _course(self, tracker: int, count: int) -> tuple[Floats, Floats, Floats]:
        """Return where the target will be, from a step ago: its middle (M, 3), heading, ground."""
        targets = self._sim.snapshot.targets
        actor, ahead = int(targets.actor[tracker]), float(targets.ahead[tracker])
        middle = 0.5 * float(targets.size[tracker, 2])
        known: list[tuple[float, ...]] = []
        for step in range(0, count + _COURSE, _COURSE):
            actors, _ = self._sim.actors_around(tracker, (1 - step) * _STEP_TICKS)
            if not actors.present[0, actor] and known:  # one that has left keeps its last place
                known.append(known[-1])
                continue
            known.append((*actors.position[0, actor].tolist(), float(actors.yaw[0, actor])))
        table = np.array(known)
        at = np.arange(count) / _COURSE
        x, y, z, yaw = (np.interp(at, np.arange(len(table)), column) for column in table.T)
        x, y = x + ahead * exact.cos(yaw), y + ahead * exact.sin(yaw)
        return np.stack([x, y, z + middle], axis=1), yaw, z

    def _others(self, tracker: int, count: int) -> tuple[Floats, ...]:
        """Return where the other drones of the world will be, as far as that is planned."""
        now = int(self._sim.snapshot.episodes.tick[tracker])
        found = []
        for other in self._sim.mates(tracker).tolist():
            flown = self._flown[other]
            if other != tracker and flown is not None:
                step = np.arange(count) + (now - flown.begun) // _STEP_TICKS
                found.append(flown.points[np.clip(step, 0, len(flown.points) - 1), :3])
        return tuple(found)
