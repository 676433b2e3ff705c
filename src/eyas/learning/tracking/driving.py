"""What drivers do, as a tracker knows it: from traffic alone, without pictures; and a forecast.

All vehicles of the traffic are followed by the tracker's filter, with looks that err as those of
the network do; now and then one is half hidden, and its place is told late or early, then hidden.
Kept are moments at which it was seen, with the way that it took after.
"""

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from eyas.benchmark.episodes.episode_batch import EpisodeGroup, episode_groups
from eyas.benchmark.policies.tracker.course import HORIZONS, PAST, Course
from eyas.benchmark.policies.tracker.motion import MotionFilter
from eyas.benchmark.policies.tracker.settings import TrackerSettings
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.rng import stream
from eyas.engine.settings.env import EnvConfig
from eyas.engine.state.motion import ActorState
from eyas.learning.tracking.flights import episodes_by_day, protocol_of_batch

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Rows = NDArray[np.int64]

LOOK: Final = 0.032  # Time between two looks [s]
_LOOKS: Final = 1100  # Looks for which vehicles are followed
_LEAST: Final = 300  # Looks of a vehicle that is followed at all
_JUMP: Final = 2.0  # Way of a vehicle from look to look with which it begins elsewhere anew [m]
_ERRORS: Final = 0.1, 0.35  # Range of the standard deviation of places of vehicles [m]
_LASTING: Final = 0.2  # Time constant of these errors [s]
_SEEN, _GOING, _HIDDEN, _COMING = range(4)  # Phases, which follow each other

_TOLD: Final = np.array((0.5, 0.9, 0.5, 0.9))
"""Standard deviation that the network says in each phase, times `TrackerSettings.doubt` [m]."""

_BELIEF: Final = np.array((1.0, 0.8, 0.0, 0.8))  # Belief in each phase
_LATE: Final = 0.35  # Most by which a half hidden vehicle is told late or early [s]
_CHOSEN: Final = 0.15  # Share of the looks that are kept; of the last ones before it is hidden, all


class Drives(NamedTuple):
    """M moments of vehicles."""

    past: NDArray[np.float32]  # What the network is told, shape (M, PAST)
    ahead: NDArray[np.float32]
    """Where each was after each of `HORIZONS`, ahead and to the left of a straight course [m],
    shape (M, H, 2)."""


def driven(env: EnvConfig, number: int, seed: int) -> Drives:
    """Return what drivers do in a batch of traffic, by its number and the seed only."""
    rng = stream(seed, "tracking drives", number)
    groups = episode_groups(episodes_by_day(rng, number), protocol_of_batch(rng, varied=False), env)
    places = np.concatenate([_places(group) for group in groups])
    for group in groups:
        group.simulation.close()
    return _followed(places, rng)


def _places(group: EpisodeGroup) -> Floats:
    """Return where vehicles are, NaN where they are not there, shape (K, looks, 2)."""
    simulation = group.simulation
    state = ActorState.create(simulation.count, simulation.actors)
    begin = simulation.snapshot.episodes.tick.astype(np.float64) * PHYSICS_STEP
    places = np.full((_LOOKS, simulation.count, simulation.actors, 2), np.nan)
    for look in range(_LOOKS):
        simulation.traffic.at(np.add(begin, LOOK * look), state)
        places[look] = np.where(state.present[..., None], state.position[..., :2], np.nan)
    rows = places.reshape(_LOOKS, -1, 2).swapaxes(0, 1)
    there = np.isfinite(rows[..., 0])
    fastest = np.nan_to_num(_ways(rows)).max(axis=1)
    followed: Floats = rows[(there.sum(axis=1) > _LEAST) & (fastest > 0.1)]
    return followed


def _ways(places: Floats) -> Floats:
    """Return the ways from look to look, shape (K, looks - 1)."""
    ways: Floats = np.sqrt(np.square(np.diff(places, axis=1)).sum(axis=-1))
    return ways


class _Sight:
    """Which of K vehicles are seen, and where: as by a network."""

    def __init__(self, count: int, rng: np.random.Generator) -> None:
        self._rng = rng
        self.phase = np.zeros(count, np.int64)
        self._left = rng.exponential(1.5, count)  # Time left of the phase [s]
        self._rate, self._late = np.zeros(count), np.zeros(count)
        self._size = rng.uniform(*_ERRORS, (count, 1))
        self._error = np.zeros((count, 2))

    def look(self, places: Floats, velocity: Floats) -> Floats:
        """Return the places that are told, (K, 2), of true places and velocities (K, 2)."""
        rng, count = self._rng, len(places)
        self._left -= LOOK
        over = self._left < 0.0
        self.phase = np.where(over, (self.phase + 1) % 4, self.phase)
        lasts = np.stack(
            (
                rng.exponential(1.2, count),
                rng.uniform(0.05, 0.4, count),
                np.exp(rng.normal(-0.6, 0.9, count)),
                rng.uniform(0.0, 0.3, count),
            )
        )
        self._left = np.where(over, lasts[self.phase, np.arange(count)], self._left)
        half = (self.phase == _GOING) | (self.phase == _COMING)
        drawn = rng.uniform(0.0, 1.0, count) * (rng.random(count) < 0.5)
        self._rate = np.where(over & half, drawn, self._rate)
        self._late = np.where(self.phase == _GOING, self._late + LOOK * self._rate, 0.0)
        early = np.where(self.phase == _COMING, self._rate * self._left, 0.0)
        stays = np.exp(-LOOK / _LASTING)
        noise = self._size * rng.standard_normal((count, 2))
        self._error = stays * self._error + np.sqrt(1.0 - stays * stays) * noise
        late = np.clip(self._late - early, -_LATE, _LATE)[:, None] * velocity
        return places + self._error * np.where(half, 2.0, 1.0)[:, None] - late


def _followed(places: Floats, rng: np.random.Generator) -> Drives:
    """Return what vehicles do that are followed, places of shape (K, looks, 2)."""
    gone = ~np.isfinite(places[..., 0])
    gone[:, 1:] |= np.nan_to_num(_ways(places)) > _JUMP
    places = np.nan_to_num(places)
    ahead = np.rint(HORIZONS / LOOK).astype(np.int64)
    follower, sight, kept = _Follower(len(places)), _Sight(len(places), rng), []
    for look in range(1, _LOOKS - int(ahead[-1])):
        velocity = (places[:, look] - places[:, look - 1]) / LOOK
        told = sight.look(places[:, look], np.where(gone[:, look, None], 0.0, velocity))
        wanted = rng.random(len(places)) < _CHOSEN
        rows = follower.look(gone[:, look], told, sight.phase, wanted)
        rows = rows[~gone[rows, look : look + ahead[-1] + 1].any(axis=1)]
        after = places[rows][:, look + ahead]
        kept.append((follower.course.past[rows], follower.course.off(rows, after)))
    past, way = (np.concatenate(parts) for parts in zip(*kept, strict=True))
    return Drives(past, way.astype(np.float32))


class _Follower:
    """The tracker's filter of K vehicles, and their courses."""

    def __init__(self, count: int) -> None:
        self._settings = own = TrackerSettings()
        self._motion, self.course = MotionFilter(count, own.widest), Course(count)
        self._motion.acceleration[:], self._motion.lasting[:] = own.acceleration, own.lasting
        self._new = np.ones(count, np.bool_)

    def look(self, gone: Mask, told: Floats, phase: Rows, wanted: Mask) -> Rows:
        """Take a look; return the vehicles whose past is kept.

        Args:
            gone: Which are not there, shape (K,).
            told: Where they seem to be [m], shape (K, 2).
            phase: Of each, shape (K,).
            wanted: Whose past is kept if they are seen, shape (K,).
        """
        own, motion = self._settings, self._motion
        new = np.flatnonzero(self._new & ~gone)
        self.course.forget(new)
        still = np.zeros((len(new), 2))
        motion.begin(new, told[new], still, 0.5, np.full(len(new), own.speed))
        rows = np.flatnonzero(~self._new & ~gone)
        self._new = gone.copy()
        time = np.full(len(rows), LOOK)
        motion.predict(rows, time)
        self.course.pass_time(rows, time)
        variance = np.square(_TOLD[phase]) + own.noise * own.noise
        near = motion.distance(rows, told[rows], variance[rows]) < own.gate
        seen = rows[near & (phase[rows] != _HIDDEN)]
        motion.update(seen, told[seen], variance[seen], _BELIEF[phase[seen]])
        self.course.note(rows, motion.place[rows], motion.velocity[rows])
        seen = seen[wanted[seen] | (phase[seen] == _GOING)]
        self.course.set_out(seen)
        kept: Rows = seen[np.isfinite(self.course.seen[seen])]
        return kept


_WIDTH = 64  # Numbers of a hidden layer
FARTHEST = 6.0  # Limit of the scaled numbers of a past: rare ones are no reason for wild answers
_BATCH = 1024  # Pasts in a step
_RATE = 3e-3  # Largest rate of learning of Adam; it falls to nothing

_FREEDOM = 3.0
"""Degrees of freedom of Student's distribution of what drivers do otherwise: some surprise."""


class Forecast(nn.Module):
    """Two hidden layers."""

    def __init__(self) -> None:
        super().__init__()
        self.first = nn.Linear(PAST, _WIDTH)
        self.second = nn.Linear(_WIDTH, _WIDTH)
        self.last = nn.Linear(_WIDTH, 3 * len(HORIZONS))
        self.mean: Tensor
        self.spread: Tensor  # Standard deviation of each number of `past`, (PAST,)
        self.register_buffer("mean", torch.zeros(PAST))
        self.register_buffer("spread", torch.ones(PAST))
        unit = torch.tensor(HORIZONS, dtype=torch.float32)
        self.unit: Tensor = torch.stack((3.0 * unit, 3.0 * unit, torch.ones_like(unit)), -1)
        """Factors of the outputs, shape (H, 3)."""
        self.least: Tensor = torch.stack((0.0 * unit, 0.0 * unit, unit.log()), -1)
        """What is added to them then, shape (H, 3)."""

    def forward(self, past: Tensor) -> Tensor:
        """Return metres ahead and to the left of a straight course, and the logarithm of their
        standard deviation, (B, H, 3).

        Args:
            past: Shape (B, PAST).
        """
        value = ((past - self.mean) / self.spread).clamp(-FARTHEST, FARTHEST)
        value = torch.relu(self.second(torch.relu(self.first(value))))
        answer: Tensor = self.last(value).view(-1, *self.unit.shape)
        return answer * self.unit + self.least


def taught_forecast(
    network: Forecast, drives: Drives, steps: int, rng: np.random.Generator
) -> Iterator[tuple[int, float]]:
    """Teach a network; yield the step and the mean loss since the last ten times."""
    past, after = torch.from_numpy(drives.past), torch.from_numpy(drives.ahead)
    network.mean.copy_(past.mean(0))
    network.spread.copy_(past.std(0) + 1e-6)
    optimiser = torch.optim.Adam(network.parameters(), _RATE)
    recent = []
    for step in range(steps):
        optimiser.param_groups[0]["lr"] = _RATE * (1.0 - step / steps)
        chosen = torch.from_numpy(rng.integers(len(past), size=_BATCH))
        loss = _loss(network(past[chosen]), after[chosen])
        optimiser.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        optimiser.step()
        recent.append(loss.item())
        if (step + 1) % max(steps // 10, 1) == 0:
            yield step + 1, float(np.mean(recent))
            recent.clear()


def _loss(said: Tensor, ahead: Tensor) -> Tensor:
    """Return the mean negative logarithm of the likelihood of ways (B, H, 2), but for a constant:
    Student's distribution in two dimensions.
    """
    unsure = said[..., 2].clamp(-3.0, 3.0)
    away = (said[..., :2] - ahead).square().sum(-1) * torch.exp(-2.0 * unsure)
    heavy = 0.5 * (_FREEDOM + 2.0) * torch.log1p(away / _FREEDOM)
    return (2.0 * unsure + heavy).mean()
