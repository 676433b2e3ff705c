"""A tracker that is shown its target once, and follows it through pictures in which it is hidden.

A network finds it near the place that a filter expects; the drone flies to what the filter says,
also while nothing is seen. What it knows besides its pictures is the first box, and what its own
sensors say: its position and heading.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.tracker.course import Course
from eyas.benchmark.policies.tracker.detector import Detector, Session, TargetDetection, TargetPrior
from eyas.benchmark.policies.tracker.ground import Ground
from eyas.benchmark.policies.tracker.metadata import TRACKER, env_as_trained
from eyas.benchmark.policies.tracker.motion import MotionFilter
from eyas.benchmark.policies.tracker.settings import TrackerSettings
from eyas.benchmark.policies.tracker.steering import Steering, turned
from eyas.engine.core.config import validated
from eyas.engine.core.errors import DataFileError
from eyas.engine.policies.policy import Decision, Failure, PolicyInput, Start
from eyas.lanes import exact

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Rows = NDArray[np.int64]

_NO_BOX = Failure(
    "the tracker needs the target's first box: the protocol does not tell it, or the target starts "
    "out of the picture",
    None,
)

_LEAST_RENEWAL = 0.001
"""Share of the latest look in the memory of how the target looks, after many looks."""

_SURE_PIXELS = 8.0
"""Largest standard deviation of the expected place at which that memory is renewed [pixels]."""

_FIRST_SPREAD = 0.5  # Standard deviation of the place of the first box [m]


class Tracker:
    """Follows N targets, each from its first box on.

    Args:
        own: Changes of the defaults of `env` that belong to the file.
        said: `TrackerSettings` of the file.

    Raises:
        EyasError: The settings are wrong, changes ask for what the network does not see, or it is
            told of no past.
    """

    sampled = False
    told = frozenset({"box"})

    def __init__(
        self,
        path: Path,
        session: Session,
        own: Mapping[str, Any],
        said: Mapping[str, Any],
        changes: Mapping[str, Any],
    ) -> None:
        self.settings = validated(TrackerSettings, said, f"{path}: {TRACKER}")
        self.env = env_as_trained(path, own, changes)
        size = self.env.observation.height, self.env.observation.width
        if not Detector.foresees(session):
            raise DataFileError(
                f"{path}: its network has no input 'past': an earlier Eyas trained it; train it "
                "anew with 'eyas train --preset eyas'"
            )
        self.detector, self.ground = Detector(session, size), Ground(self.settings, size)

    def begin(self, start: Start) -> None:
        """Take the first boxes: N episodes begin."""
        count = len(start.seeds)
        self.motion, self.course = MotionFilter(count, self.settings.widest), Course(count)
        self.boxes = start.boxes().astype(np.float64)
        self.expected, self.spread = np.zeros((count, 2)), np.ones(count)
        """What the network was told last, see `TargetPrior`."""
        self.sees = np.zeros(count, np.bool_)
        """Whether each target was seen in the last look."""
        self.left = np.zeros((count, 2))
        """Where each target was when it was seen last, east and north [m]."""
        self._key = np.zeros((count, self.detector.keys), np.float32)
        self._renewed = np.zeros(count)
        """How often each memory of how the target looks was renewed."""
        own = self.settings
        self._steering = Steering(count, self.env, self.ground, own.gain, own.lag)

    def act(self, sight: PolicyInput) -> Decision:
        """Look, and fly to where the targets should be when the action takes effect."""
        boxless = self.boxes[:, 2] <= self.boxes[:, 0]
        rows = np.flatnonzero(sight.deciding & ~boxless)
        actions = np.zeros((len(boxless), 4))
        failed = dict.fromkeys(np.flatnonzero(sight.deciding & boxless).tolist(), _NO_BOX)
        if len(rows):
            seen: Any = sight.observation
            sensed = seen["sensors"][rows].astype(np.float64)
            place, yaw = sensed[:, :2], sensed[:, -1]
            since = self._steering.time_since(rows, sight.clock)
            self.look(rows, seen["image"][rows], place, yaw, since)
            target = self.motion.place[rows], self.motion.velocity[rows]
            actions[rows, :2] = self._steering.steer(rows, (place, yaw), since, target)
        return Decision(actions, failed)

    def look(
        self,
        rows: Rows,  # Which they are, shape (K,)
        pictures: NDArray[np.uint8],  # What they see, shape (K, 3, H, W)
        place: Floats,  # Where they are, east and north [m], shape (K, 2)
        yaw: Floats,  # Their heading [rad], shape (K,)
        since: Floats,  # Time since their last look [s], shape (K,); NaN: there was none
    ) -> None:
        """Take what K drones see."""
        new = np.isnan(since)
        if new.any():
            self._show(rows[new], place[new], yaw[new])
        since = np.where(new, 0.0, since)
        self.motion.predict(rows, since)
        self.course.pass_time(rows, since)
        self._go_on(rows)
        self._wait(rows)
        clue = self._clue(rows, place, yaw)
        self.expected[rows], self.spread[rows] = clue.expected, clue.spread
        found = self.detector.find(pictures, clue)
        self.course.answer(rows, found.ahead)
        where = place + turned(self.ground.offsets(found.place), yaw)
        noise = self.settings.doubt * found.spread / self.ground.pixels_per_metre
        variance = np.square(noise) + self.settings.noise * self.settings.noise
        near = self.motion.distance(rows, where, variance) < self.settings.gate
        wide = self.motion.spread(rows) > 0.5 * self.settings.widest
        least = np.where(wide, self.settings.remembered, self.settings.believed)
        taken = near & (found.belief > least)
        self.sees[rows] = taken
        self.motion.update(rows[taken], where[taken], variance[taken], found.belief[taken])
        self.left[rows[taken]] = self.motion.place[rows[taken]]
        self.course.note(rows, self.motion.place[rows], self.motion.velocity[rows])
        drives = self.motion.acceleration[rows] > self.settings.walking_acceleration
        self.course.set_out(rows[taken & drives])
        self._remember(rows, found, taken & (clue.spread < _SURE_PIXELS))

    def _go_on(self, rows: Rows) -> None:
        """Expect targets that are not seen where their courses lead."""
        rows, own = rows[self.course.known(rows)], self.settings
        place, velocity, spread, since = self.course.here(rows)
        spread = own.unsure * spread + own.drift * since
        spread = np.sqrt(np.square(spread) + own.noise * own.noise)
        speed = np.maximum((spread + own.drift) / np.maximum(since, 0.3), 1.0)
        self.motion.expect(rows, place, velocity, spread, speed)

    def _wait(self, rows: Rows) -> None:
        """Wait for targets that are followed unseen for too long: most covers have ended before,
        and a driver who stopped below one comes out where the drone is.
        """
        away = self.motion.place[rows] - self.left[rows]
        far = np.asarray(exact.hypot(away[:, 0], away[:, 1])) > self.settings.straight
        self.motion.stop(rows[far], self.settings.speed)
        self.course.leave(rows[far])

    def _clue(self, rows: Rows, place: Floats, yaw: Floats) -> TargetPrior:
        """Return what the network is told about targets, see `look`."""
        expected = self.ground.pixels(turned(self.motion.place[rows] - place, -yaw))
        spread = np.sqrt(
            np.square(self.motion.spread(rows)) + self.settings.floor * self.settings.floor
        )
        known = self._renewed[rows] > 0
        spread *= self.ground.pixels_per_metre
        return TargetPrior(expected, spread, self._key[rows], known, self.course.past[rows])

    def _show(self, rows: Rows, place: Floats, yaw: Floats) -> None:
        """Begin with the first boxes: where the targets are, and what can move how."""
        box, own = self.boxes[rows], self.settings
        middle = 0.5 * (box[:, :2] + box[:, 2:])
        sides = (box[:, 2:] - box[:, :2]) / self.ground.pixels_per_metre
        walks = sides[:, 0] * sides[:, 1] < own.small * own.small
        speed = np.where(walks, own.walking_speed, own.speed)
        self.motion.acceleration[rows] = np.where(walks, own.walking_acceleration, own.acceleration)
        self.motion.lasting[rows] = own.lasting
        where = place + turned(self.ground.offsets(middle), yaw)
        self.motion.begin(rows, where, np.zeros_like(where), _FIRST_SPREAD, speed)
        self.left[rows] = where

    def _remember(self, rows: Rows, found: TargetDetection, sure: Mask) -> None:
        """Renew the memory of how targets look, by those that are surely seen."""
        sure = sure & (found.belief > self.settings.remembered)
        rows = rows[sure]
        share = np.maximum(1.0 / (self._renewed[rows] + 1.0), _LEAST_RENEWAL)[:, None]
        self._key[rows] += (share * (found.key[sure] - self._key[rows])).astype(np.float32)
        self._renewed[rows] += 1.0
