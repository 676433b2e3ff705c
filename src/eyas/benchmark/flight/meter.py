"""Measures flights: from the true state and the target's pixels, whatever a policy was trained for.

The reward is that of the protocol, read at every control step; the target's pixels are counted at
every fourth one. A target is followed while it is in the picture, near and large enough
(`Protocol.farthest`, `LEAST_SIZE`): otherwise a drone that stays where it is and only turns its
camera would follow everything.
"""

from typing import NamedTuple, TypedDict

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.episodes.episode_batch import EpisodeBatch, EpisodeGroup
from eyas.benchmark.protocols.protocol import LEAST_SIZE, Protocol
from eyas.benchmark.records.record import EpisodeRecord, PublishedFigures, Trace
from eyas.engine.core.rng import stream
from eyas.engine.policies.policy import Failure
from eyas.engine.sim.starts import AROUND_BODY
from eyas.engine.task.done import DoneReason

LEAST_LOSS = 0.5  # Shortest time out of the picture that counts as a loss [s]


class Watch(TypedDict):
    """Fields of `eyas.benchmark.records.record.EpisodeRecord`."""

    found_after: float | None
    lost_after: float | None
    watched: float
    losses: int
    found_again: int
    search_time: float | None


def watched(in_view: NDArray[np.bool_], period: float, *, broken_off: bool) -> Watch:
    """Return when a target was found and lost.

    The time until the first loss begins when the target is first in the picture.

    Args:
        in_view: Whether the target is in the picture at each control step, shape (M,).
        period: Length of a control step [s].
        broken_off: Whether the episode has ended by a fault of the policy, which loses the target.
    """
    seen = np.flatnonzero(in_view)
    if not len(seen):
        return Watch(
            found_after=None,
            lost_after=None,
            watched=0.0,
            losses=0,
            found_again=0,
            search_time=None,
        )
    first, end = int(seen[0]), len(in_view)
    gaps = _gaps(in_view, first)
    least = round(LEAST_LOSS / period)
    lost = [(start, stop) for start, stop in gaps if stop - start >= least]
    found = [(start, stop) for start, stop in lost if stop < end]
    starts = [start for start, _ in lost]
    if broken_off and not (lost and lost[-1][1] == end):
        starts.append(end)
    until = starts[0] if starts else end
    return Watch(
        found_after=first * period,
        lost_after=(until * period if starts else None),
        watched=(until - first) * period,
        losses=len(starts),
        found_again=len(found),
        search_time=(
            float(np.mean([stop - start for start, stop in found])) * period if found else None
        ),
    )


def _gaps(in_view: NDArray[np.bool_], first: int) -> list[tuple[int, int]]:
    """Return start and end of each time out of the picture after `first`."""
    out = np.concatenate(([False], ~in_view[first:], [False]))
    edges = np.flatnonzero(out[1:] != out[:-1]) + first
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


Floats = NDArray[np.float64]

LOOK = 4  # Control steps between two counts of the target's pixels
TRACE = 20  # Control steps between two points of a trace

_PUBLISHED_ACTIONS = 305, 363
"""Fewest and most actions that the original's client makes in 1,500 physics steps."""

_PUBLISHED_LENGTH = 375  # Number by which it divides

_CRASHES = frozenset(
    (DoneReason.HEIGHT, DoneReason.DISTANCE, DoneReason.VELOCITY, DoneReason.YAW_RATE)
) | {DoneReason.TILT, DoneReason.NOT_A_NUMBER}


class _Measured(NamedTuple):
    """What is measured of N flights at a control step, each with a leading axis of N."""

    reward: Floats
    reason: NDArray[np.int64]
    position: Floats  # Place of the drone [m], shape (N, 3)
    acceleration: Floats  # Acceleration of the drone [m/s^2], shape (N, 3)
    target: Floats  # Centre of the target, east, north, up [m], shape (N, 3)
    away: Floats  # Distance of the target's centre from the camera [m], shape (N,)
    wide: Floats  # Width of the picture at that distance [m], shape (N,)
    side: Floats  # Longest side of the target [m], shape (N,)
    middle: Floats  # Ground point in the middle of the picture, east, north [m], (N, 2)


def _measured(group: EpisodeGroup) -> _Measured:
    trackers, cameras, targets, episodes, _ = group.simulation.snapshot
    away = np.linalg.norm(targets.centre - cameras.position, axis=1)
    return _Measured(
        reward=episodes.reward,
        reason=episodes.reason,
        position=trackers.position,
        acceleration=trackers.acceleration,
        target=targets.centre,
        away=away,
        wide=away * cameras.field_of_view,
        side=targets.size.max(axis=1),
        middle=episodes.view_centre[:, :2],
    )


def inside_things(group: EpisodeGroup) -> NDArray[np.bool_]:
    """Return whether each drone is in a crown, a wall or a roof, shape (K,): none stops it."""
    place = group.simulation.snapshot.trackers.position
    return group.simulation.clearance.lifted(place, AROUND_BODY) > place[:, 2]


class _Sums(NamedTuple):
    """What is added up over the control steps of N flights."""

    error: Floats  # Distance of the target from the middle of the picture [m], shape (N,)
    path: Floats  # [m], shape (N,)
    jerk: Floats  # Squared jerk [m^2/s^6], shape (N,)
    height: Floats  # Height above the target [m], shape (N,)
    inside: Floats  # Points of the trace inside of things, shape (N,)
    shares: Floats  # Looks with a visible pixel, and visible shares, shape (N, 2)


class Meter:
    """Measures N flights."""

    def __init__(self, batch: EpisodeBatch, protocol: Protocol) -> None:
        count, steps = batch.count, protocol.steps
        self._batch, self._protocol = batch, protocol
        self._reward = np.zeros((count, steps))
        self._followed = np.zeros((count, steps), np.bool_)
        self._trace = np.zeros((count, steps // TRACE, 4))
        self._sums = _Sums(*(np.zeros((count, *own)) for own in ((), (), (), (), (), (2,))))
        self.length = np.zeros(count, np.int64)  # Control steps flown, shape (N,)
        self.reason = np.zeros(count, np.int64)  # `DoneReason` of each, shape (N,)
        self._last = batch.gathered(_measured)

    def measure(self, active: NDArray[np.bool_]) -> None:
        """Measure after a control step of the active flights, shape (N,)."""
        rows = np.flatnonzero(active)
        now, last = self._batch.gathered(_measured), self._last
        step, sums = self.length[rows], self._sums
        self._reward[rows, step] = now.reward[rows]
        near = (now.away <= self._protocol.farthest) & (now.side >= LEAST_SIZE * now.wide)
        self._followed[rows, step] = (now.reward > 0.0)[rows] & near[rows]
        self.length[rows] += 1
        self.reason[rows] = now.reason[rows]
        place, target = now.position[rows], now.target[rows, :2]
        sums.error[rows] += np.linalg.norm(target - now.middle[rows], axis=1)
        sums.path[rows] += np.linalg.norm(place - last.position[rows], axis=1)
        change = (now.acceleration[rows] - last.acceleration[rows]) / self._protocol.period
        sums.jerk[rows] += np.square(change).sum(axis=1)
        sums.height[rows] += place[:, 2] - now.target[rows, 2]
        self._last = now
        # All active flights have begun together, so that they have flown equally many steps.
        if len(rows) and (step[0] + 1) % TRACE == 0:
            self._trace[rows, step[0] // TRACE] = np.concatenate((place[:, :2], target), axis=1)
            sums.inside[rows] += self._batch.gathered(inside_things)[rows]
        if len(rows) and (step[0] + 1) % LOOK == 0:
            pixels = self._batch.pixels()[rows]
            visible = np.where(near[rows], pixels[:, 0], 0)
            sums.shares[rows, 0] += visible > 0
            sums.shares[rows, 1] += visible / np.maximum(pixels[:, 1], 1)

    def record(
        self,
        row: int,
        episode: EpisodeSpec,
        clear: float,
        failure: Failure | None,
        figures: dict[str, float | None],
    ) -> EpisodeRecord:
        """Return the record of a flight that has ended."""
        protocol, length = self._protocol, int(self.length[row])
        reward, flown = self._reward[row, :length], max(length, 1)
        followed = self._followed[row, :length]
        reason = DoneReason(int(self.reason[row]))
        broken_off = failure is not None or reason in _CRASHES
        shares = self._sums.shares[row] / (protocol.steps // LOOK)
        return EpisodeRecord(
            name=episode.name,
            **episode.place._asdict(),
            direction=episode.direction,
            seed=episode.seed,
            traffic=episode.traffic,
            variant=episode.variant,
            error=None if failure is None else failure.line,
            traceback=None if failure is None else failure.traceback,
            reason=reason.name.lower() if failure is None else "policy_failed",
            duration=length * protocol.period,
            cr=float(reward.sum()),
            tsr=int(followed.sum()) / protocol.steps,
            seen=float(shares[0]),
            visible=float(shares[1]),
            clear=clear,
            **watched(followed, protocol.period, broken_off=broken_off),
            crashed=reason in _CRASHES,
            centre_error=float(self._sums.error[row]) / flown,
            path=float(self._sums.path[row]),
            height=float(self._sums.height[row]) / flown,
            jerk=float(np.sqrt(self._sums.jerk[row] / flown)),
            published=published(reward, protocol.steps, episode.seed),
            figures={**figures, "inside": float(self._sums.inside[row]) / max(length // TRACE, 1)},
            trace=self._trace_of(row, length // TRACE),
        )

    def _trace_of(self, row: int, points: int) -> Trace:
        reward = self._reward[row, : points * TRACE].reshape(points, TRACE).mean(axis=1)
        places = self._trace[row, :points].round(2).tolist()
        return Trace(
            reward=tuple(reward.round(4).tolist()),
            drone=tuple((place[0], place[1]) for place in places),
            target=tuple((place[2], place[3]) for place in places),
        )


def published(reward: Floats, steps: int, seed: int) -> PublishedFigures:
    """Return the figures that the original's code prints, see docs/published-results.md.

    Its client makes 305 to 363 actions in an episode, here sampled from the seed and spread evenly,
    loses the last reward, and divides by 375.

    Args:
        reward: Rewards of the flown control steps, shape (M,).
    """
    low, high = _PUBLISHED_ACTIONS
    sampled = int(stream(seed, "published").integers(low, high + 1))
    full = sampled * steps / _PUBLISHED_LENGTH
    last = np.round(np.arange(1, int(full) + 1) * (steps / full)).astype(np.int64) - 1
    kept = reward[last[last < len(reward)]][:-1]
    return PublishedFigures(
        actions=len(kept) + 1, cr=float(kept.sum()), tsr=int((kept > 0.0).sum()) / steps
    )
