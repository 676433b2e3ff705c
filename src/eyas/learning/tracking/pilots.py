"""Who flies while pictures are taken: a disturbed oracle at first, then the tracker itself."""

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.tracker.tracker import Tracker
from eyas.engine.policies.policy import Decision, PolicyInput, Start
from eyas.engine.settings.env import EnvConfig
from eyas.lanes import exact
from eyas.learning.tracking.shots import Shots, projected

Floats = NDArray[np.float64]

PERIOD = 0.128  # Time between two pictures [s]
_FORGETS = 1.5  # Time constant of the oracle's disturbance [s]

_LOST, _PATIENCE = 3.0, (1.5, 10.0)
"""A pupil is lost whose filter is off by more than this [m] for longer than this [s]: soon, to see
more of its target, or late, to wait for it among others."""

_PATIENT = 0.3  # Share of those who are found late
_AT_RANDOM = 0.01  # Share of the looks at which a pupil is corrected, lost or not


class Oracle:
    """Flies to the target's true place beside a wandering disturbance."""

    sampled = False
    told = frozenset({"truth"})

    def __init__(self, env: EnvConfig, rng: np.random.Generator) -> None:
        self.env = env.model_copy(update={"action_repeat": round(PERIOD / 0.008)})
        self._rng = rng
        self.shots: list[Shots] = []

    def begin(self, start: Start) -> None:
        """Draw how strongly each drone is disturbed."""
        count = len(start.seeds)
        self._strength = np.exp(self._rng.uniform(np.log(0.3), np.log(4.0), (count, 1)))
        self._aside = np.zeros((count, 2))

    def act(self, sight: PolicyInput) -> Decision:
        """Keep the picture, and fly."""
        state = sight.snapshot()
        count = len(self._aside)
        unknown = np.full((count, 2), np.nan, np.float32)
        self.shots.append(_shot(self.env, sight, (unknown, unknown[:, 0])))
        step = PERIOD / _FORGETS
        self._aside += self._strength * np.sqrt(2.0 * step) * self._rng.standard_normal((count, 2))
        self._aside -= step * self._aside
        error = state.targets.centre[:, :2] - state.episodes.view_centre[:, :2]
        yaw = state.trackers.euler[:, 2]
        command = _body(state.targets.velocity[:, :2], yaw)
        command += (_body(error, yaw) + self._aside) * (0.6 / PERIOD)
        return Decision(np.concatenate((command, np.zeros((count, 2))), axis=1))


class Pupil:
    """Lets the tracker fly; sets its filter right when it has been lost for a while."""

    sampled = False
    told = frozenset({"box", "truth"})

    def __init__(self, tracker: Tracker, rng: np.random.Generator) -> None:
        self._tracker, self._rng, self.env = tracker, rng, tracker.env
        self.shots: list[Shots] = []

    def begin(self, start: Start) -> None:
        """Begin with the first boxes."""
        self._tracker.begin(start)
        count = len(start.seeds)
        self._lost = np.zeros(count)
        self._patience = np.where(self._rng.random(count) < _PATIENT, *_PATIENCE[::-1])
        self._next = 0.0

    def act(self, sight: PolicyInput) -> Decision:
        """Fly, and keep a picture now and then."""
        assert sight.clock is not None
        decision = self._tracker.act(sight)
        if sight.clock >= self._next - 1e-9:
            self._next = sight.clock + PERIOD
            clue = self._tracker.expected, self._tracker.spread
            self.shots.append(_shot(self.env, sight, clue))
            self._correct(sight)
        return decision

    def _correct(self, sight: PolicyInput) -> None:
        """Set the filters of lost ones right."""
        targets, motion = sight.snapshot().targets, self._tracker.motion
        away = motion.place - targets.centre[:, :2]
        off = np.asarray(exact.hypot(away[:, 0], away[:, 1]))
        self._lost = np.where(off > _LOST, self._lost + PERIOD, 0.0)
        back = (self._lost > self._patience) | (self._rng.random(len(off)) < _AT_RANDOM)
        rows = np.flatnonzero(back & sight.deciding)
        self._lost[rows] = 0.0
        wrong = self._rng.uniform(0.2, 2.0)
        noise = wrong * self._rng.standard_normal((2, len(rows), 2))
        place, velocity = targets.centre[rows, :2], targets.velocity[rows, :2]
        speed = np.minimum(motion.acceleration[rows], wrong)
        motion.begin(rows, place + noise[0], velocity + noise[1], wrong, speed)
        self._tracker.left[rows] = motion.place[rows]
        self._tracker.course.forget(rows)


def _shot(
    env: EnvConfig, sight: PolicyInput, clue: tuple[NDArray[np.floating], NDArray[np.floating]]
) -> Shots:
    image = env.observation
    return Shots(
        sight.observation["image"].copy(),
        projected(sight.snapshot(), (image.height, image.width)),
        sight.visible().astype(np.float32),
        clue[0].astype(np.float32),
        clue[1].astype(np.float32),
        sight.deciding.copy(),
    )


def _body(vectors: Floats, yaw: Floats) -> Floats:
    """Return vectors of the level, ahead and to the left, shape (N, 2)."""
    sine, cosine = exact.sin(yaw), exact.cos(yaw)
    ahead = cosine * vectors[:, 0] + sine * vectors[:, 1]
    return np.stack((ahead, cosine * vectors[:, 1] - sine * vectors[:, 0]), axis=-1)
