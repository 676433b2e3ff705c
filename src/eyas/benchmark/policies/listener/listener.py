"""A tracker that is told its target in words: it looks at all vehicles in view for a while, takes
the one that the words mean, and follows it among the others.

What it knows besides its pictures are the attributes of what it is told, and what its own sensors
say: its position and heading.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.listener.candidates import Candidates
from eyas.benchmark.policies.listener.detector import Detections, Session, VehicleDetector
from eyas.benchmark.policies.listener.judge import judged
from eyas.benchmark.policies.tracker.ground import Ground
from eyas.benchmark.policies.tracker.metadata import TRACKER, env_as_trained
from eyas.benchmark.policies.tracker.settings import TrackerSettings
from eyas.benchmark.policies.tracker.steering import Steering, turned
from eyas.engine.core.config import validated
from eyas.engine.policies.policy import COME_BACK, Decision, Instruction, PolicyInput, Start
from eyas.engine.targets.grammar.attributes import claim_of
from eyas.engine.targets.grammar.claims import Claim

Floats = NDArray[np.float64]

_WATCHED: Final = 0.3  # Time of looking before the choice [s]
_WATCHED_MOVING: Final = 1.1  # Time of looking where motion is named [s]
_ROOF: Final = 0.8  # Height of a vehicle's middle above the road [m]


class Listener:
    """Follows N targets that it is told.

    Raises:
        EyasError: The settings are wrong, or changes ask for what the network does not see.
    """

    sampled = False
    told = frozenset({"attributes"})

    def __init__(
        self,
        path: Path,
        session: Session,
        own: Mapping[str, Any],  # Changes of the defaults of `env` that belong to the file
        said: Mapping[str, Any],  # `TrackerSettings` of the file
        changes: Mapping[str, Any],
    ) -> None:
        self.settings = validated(TrackerSettings, said, f"{path}: {TRACKER}")
        self.env = env_as_trained(path, own, changes)
        self._size = self.env.observation.height, self.env.observation.width
        self._ground = Ground(self.settings, self._size)
        self._detector = VehicleDetector(session, self._ground.pixels_per_metre)

    def begin(self, start: Start) -> None:
        """Remember what each is told: N episodes begin."""
        count = len(start.seeds)
        self._told = told = start.told
        self._claims = [
            None if told is None else claim_of(told.attributes[row]) for row in range(count)
        ]
        self._seen = [Candidates() for _ in range(count)]
        self._steering = Steering(count, self.env, self._ground, self.settings.gain)
        self._time = np.zeros(count)
        self._new = np.ones(count, np.bool_)  # Whether no picture was seen since the words came
        self._home = np.zeros((count, 2))  # Where each began, east and north [m]
        self._pose = np.zeros((count, 3))
        """Where each was at its first look, east and north [m], and its heading [rad]."""

    def act(self, sight: PolicyInput) -> Decision:
        """Look, and fly to where the targets should be."""
        actions = np.zeros((len(self._claims), 4))
        self._listen(sight.told)
        told = np.array([claim is not None for claim in self._claims], np.bool_)
        rows = np.flatnonzero(sight.deciding & told)
        if not len(rows):
            return Decision(actions)
        seen: Any = sight.observation
        sensed = seen["sensors"][rows].astype(np.float64)
        place, yaw = sensed[:, :2], sensed[:, -1]
        since = self._steering.time_since(rows, sight.clock)
        found = self._detector.find(seen["image"][rows])
        for index, row in enumerate(rows.tolist()):
            pose = place[index : index + 1], yaw[index : index + 1]
            self._look(row, found[index], pose, float(np.nan_to_num(since[index])))
        chosen = np.array([self._seen[row].target is not None for row in rows.tolist()])
        if chosen.any():
            targets = self._targets(rows[chosen])
            pose = place[chosen], yaw[chosen]
            ahead = self._steering.steer(rows[chosen], pose, since[chosen], targets)
            actions[rows[chosen], :2] = ahead
        return Decision(actions)

    def _listen(self, told: Instruction | None) -> None:
        """Choose anew where the words are others; keep the target where they name none."""
        if told is None or self._told is None or told is self._told:
            return
        for row, (new, old) in enumerate(zip(told.words, self._told.words, strict=True)):
            claim = claim_of(told.attributes[row])
            if new != old and claim is not None:
                self._claims[row], self._seen[row] = claim, Candidates()
                self._time[row], self._new[row] = 0.0, True
        self._told = told

    def _look(self, row: int, found: Detections, pose: tuple[Floats, Floats], since: float) -> None:
        """Take what one drone sees, and choose its target when it has looked for long enough."""
        place, yaw = pose
        count = len(found.belief)
        every = np.repeat(yaw, count)
        where = place + turned(self._ground.offsets(found.place), every)
        # From columns and rows to ahead and left, and on to east and north.
        single = turned(np.stack((-found.heading[:, 1], -found.heading[:, 0]), axis=1), every)
        double = np.stack((-found.heading[:, 2], found.heading[:, 3]), axis=1)
        double = turned(double, 2.0 * every)
        mine = self._seen[row]
        if self._new[row]:
            self._pose[row], self._new[row] = (*place[0], yaw[0]), False
            self._home[row] = self._pose[row, :2] if not since else self._home[row]
        self._time[row] += since
        mine.look(found, where, np.concatenate((single, double), axis=1), since)
        claim = self._claims[row]
        assert claim is not None
        watched = _WATCHED if claim.doing is None else _WATCHED_MOVING
        if mine.target is None and self._time[row] >= watched:
            self._choose(row, claim)

    def _choose(self, row: int, claim: Claim) -> None:
        """Begin to follow the one that a claim means."""
        seen = self._seen[row].seen()
        if not len(seen.row):
            return
        place, yaw = self._pose[row, :2], np.repeat(-self._pose[row, 2], len(seen.row))
        pixels = self._ground.pixels(turned(seen.begin - place, yaw))
        shares = pixels / np.array(self._size[::-1])
        self._seen[row].target = int(seen.row[int(judged(claim, seen, shares).argmax())])

    def _targets(self, rows: NDArray[np.int64]) -> tuple[Floats, Floats]:
        """Return where targets are and how they move, shape (K, 2) each."""
        places, velocities = [], []
        for row in rows.tolist():
            mine = self._seen[row]
            if self._told is not None and self._told.words[row] == COME_BACK:
                places.append(self._home[row])
                velocities.append(np.zeros(2))
                continue
            assert mine.target is not None
            places.append(mine.motion.place[mine.target])
            velocities.append(mine.motion.velocity[mine.target])
        return np.array(places), np.array(velocities)
