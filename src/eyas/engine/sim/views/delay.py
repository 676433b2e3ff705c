"""What agents see: the present, or, by a latency or by what their cameras are like, the past."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.vibration import Vibration
from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.counter_rng import SEEDS, uniform
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.core.variation import Variation
from eyas.engine.sensors.config import ReadingConfig
from eyas.engine.sim.latency import Latency, is_always_0
from eyas.engine.state.snapshot import Snapshot
from eyas.lanes import interpreted

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_ON_TIME = ReadingConfig()

_uniform = interpreted(uniform)


class PastState:
    """What N trackers saw some time ago: the state at the last exposure of a sensor before that.

    Attributes:
        snapshot: Their state at that time; written in place.
        told: What their sensors with errors told then; None: none has errors.
    """

    def __init__(
        self,
        latency: Latency,  # Of all that agents see
        now: Snapshot,  # The present state
        # What sensors with errors tell now, shape (N, ...); None: none has errors
        told: Floats | None = None,
        sensor: ReadingConfig = _ON_TIME,  # Rate, delay and drop-out of its exposures
    ) -> None:
        count = len(now.light.sky)
        self.snapshot = Snapshot.create(count)
        self._latency, self._delay = latency, sensor.delay_steps
        self._period = max(round(PHYSICS_RATE / sensor.rate), 1)
        self._drop_out, self._seed = sensor.drop_out, np.zeros(count, np.int64)
        self._now, self._seen = _arrays(now), _arrays(self.snapshot)
        self.told = None if told is None else told.copy()
        if told is not None and self.told is not None:
            self._now.append(told)
            self._seen.append(self.told)
        self._kept = latency.most + sensor.delay_steps + 1
        # States are kept in slots, one more than steps; steps without an exposure share a slot.
        self._past = [np.stack([array] * (self._kept + 1)) for array in self._now]
        self._row, self._slot = 0, np.zeros(self._kept, np.int64)
        self._uses, self._free = [self._kept, *([0] * self._kept)], [*range(1, self._kept + 1)]
        self._every = np.arange(count)
        self._clock = now.episodes.step_count

    def sample(self, tracker: int, key: EpisodeKey) -> None:
        """Begin the random numbers of a tracker's episode."""
        if self._drop_out > 0.0:
            self._seed[tracker] = key.stream("exposures").integers(SEEDS)

    def record(self) -> None:
        """Remember the present state, after a physics step, or else the last exposure's."""
        last, self._row = self._row, (self._row + 1) % self._kept
        exposed, before = self._exposed(), int(self._slot[last])
        if not exposed.any():
            self._use(before)
            return
        slot = self._free.pop()
        for past, now in zip(self._past, self._now, strict=True):
            if exposed.all():
                past[slot] = now
            else:
                past[slot] = past[before]
                past[slot, exposed] = now[exposed]
        self._use(slot)

    def _use(self, slot: int) -> None:
        """Let the present step have a slot; one that no step has any more becomes free."""
        old = int(self._slot[self._row])
        self._slot[self._row] = slot
        self._uses[slot] += 1
        self._uses[old] -= 1
        if self._uses[old] == 0:
            self._free.append(old)

    def _exposed(self) -> NDArray[np.bool_]:
        """Return whether each tracker's sensor is exposed in this physics step, shape (N,)."""
        exposed: NDArray[np.bool_] = self._clock % self._period == 0
        if self._drop_out > 0.0:
            for n in np.flatnonzero(exposed).tolist():
                sampled = _uniform(int(self._seed[n]), int(self._clock[n]), 0)
                exposed[n] = sampled >= self._drop_out
        return exposed

    def begin(self, trackers: Integers) -> None:
        """Remember the present state of trackers whose episodes have begun."""
        for past, now in zip(self._past, self._now, strict=True):
            past[self._slot[self._row], trackers] = now[trackers]
        self.see()

    def see(self) -> None:
        """Set `snapshot`; nothing from before the reset is seen."""
        late = np.minimum(self._latency.steps + self._delay, self._clock)
        slots = self._slot[(self._row - late) % self._kept]
        for seen, past in zip(self._seen, self._past, strict=True):
            seen[...] = past[slots, self._every]


class ShownState(Protocol):
    """What pictures show."""

    @property
    def shown(self) -> Snapshot:
        """The state, with the vibration of the cameras."""
        ...

    @property
    def steady(self) -> Snapshot:
        """The same without it."""
        ...

    @property
    def vibration(self) -> Vibration | None:
        """That of the cameras; None: there is none."""
        ...


class SeenState:
    """What N agents see: the truth, as far as neither a latency nor their cameras make it late.

    Attributes:
        snapshot: The state that packets tell.
        shown: The state that pictures show, with the vibration of the cameras.
        steady: The same without it.
        told: What sensors with errors tell, see `Readings.told`; None: none has errors.
        late: Steps by which messages to each tracker are late, shape (N,); None: none is.
    """

    def __init__(
        self,
        latency: Variation,  # Of all that agents see, in physics steps
        camera: ReadingConfig,  # Rate, delay and drop-out of pictures
        now: Snapshot,  # The present state
        told: Floats | None,  # What sensors with errors tell now
        vibration: Vibration | None = None,  # That of the cameras; None: there is none
    ) -> None:
        self._latency = Latency(latency, "observation_latency", len(now.light.sky))
        self._past: list[PastState] = []
        self._now, self._told_now = now, told
        self.snapshot, self.shown, self.told, self.late = now, now, told, None
        if not is_always_0(latency):
            past = PastState(self._latency, now, told)
            self._past.append(past)
            self.snapshot, self.shown, self.told = past.snapshot, past.snapshot, past.told
            self.late = self._latency.steps
        if _timing_of(camera) != _timing_of(_ON_TIME):
            pictures = PastState(self._latency, now, None, camera)
            self._past.append(pictures)
            self.shown = pictures.snapshot
        self.steady, self.vibration = self.shown, vibration
        if vibration is not None:
            self.shown = vibration.shaken(self.steady)

    def on_time(self) -> "SeenState":
        """Return the state as who sees the present has it."""
        return SeenState(0.0, _ON_TIME, self._now, self._told_now, self.vibration)

    @property
    def is_late(self) -> bool:
        """Whether `record` must be called after each physics step."""
        return bool(self._past)

    def sample(self, tracker: int, key: EpisodeKey) -> None:
        """Sample what is random in a tracker's episode."""
        if self.late is not None:
            self._latency.sample(tracker, key)
        for past in self._past:
            past.sample(tracker, key)
        if self.vibration is not None:
            self.vibration.sample(tracker, key)

    def record(self) -> None:
        """Remember the present state, after a physics step."""
        for past in self._past:
            past.record()

    def begin(self, trackers: Integers) -> None:
        """Begin the episodes of trackers, which are at their starts."""
        for past in self._past:
            past.begin(trackers)
        if self.vibration is not None:
            self.vibration.move()

    def see(self) -> None:
        """Set what agents see now, after some physics steps."""
        for past in self._past:
            past.see()
        if self.vibration is not None:
            self.vibration.move()


def _timing_of(sensor: ReadingConfig) -> tuple[float, int, float]:
    return sensor.rate, sensor.delay_steps, sensor.drop_out


def _arrays(snapshot: Snapshot) -> list[NDArray[np.generic]]:
    """Return all arrays of a snapshot."""
    return [array for record in snapshot for array in record]
