"""The lines that a log has for each step, in the original's words, and the line of an episode."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.errors import DataFileError
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.done import DoneReason

_PATTERN = re.compile(
    r"id: (?P<id>\S+) done: (?P<done>\S+) reward: (?P<reward>\S+) count: (?P<count>\S+)"
    r" time: (?P<time>\S+) carDir: (?P<direction>\S+) pitchAngle: (?P<pitch>\S+)"
    r" doneState: (?P<state>.*)"
)


@dataclass(frozen=True, slots=True)
class StepLine:
    """A tracker's last step: what the original prints for each if its `Verbose` is true."""

    name: str
    """Name of the tracker; the original's `id`."""
    done: bool
    """Whether the episode has ended."""
    reward: float
    """The built-in reward."""
    step_count: int
    """Steps of 2 ms since the reset; the original's `count`."""
    time: float
    """Simulated time [s]."""
    direction: int
    """`eyas.engine.task.direction.TargetDirection`; the original's `carDir`."""
    camera_pitch: float
    """Positive down [rad]; the original's `pitchAngle`."""
    done_state: str
    """The limit that the body violates: `none`, `height`, `distance`, `velocity`, `yaw velocity` or
    `pitch or yaw angle`; the original's `doneState`."""

    def __str__(self) -> str:
        return (
            f"id: {self.name} done: {int(self.done)} reward: {self.reward:g}"
            f" count: {self.step_count} time: {self.time:g} carDir: {self.direction}"
            f" pitchAngle: {self.camera_pitch:g} doneState: {self.done_state}"
        )

    @classmethod
    def parse(cls, line: str) -> "StepLine":
        """Return the step of a line of a log, whatever precedes it there.

        Raises:
            DataFileError: It is not such a line.
        """
        found = _PATTERN.search(line.rstrip("\n"))
        try:
            if found is None:
                raise ValueError("no step")
            return cls(
                name=found["id"],
                done=bool(int(found["done"])),
                reward=float(found["reward"]),
                step_count=int(found["count"]),
                time=float(found["time"]),
                direction=int(found["direction"]),
                camera_pitch=float(found["pitch"]),
                done_state=found["state"],
            )
        except ValueError:
            raise DataFileError(f"{line[:60]!r} is not the line of a step") from None


def step_line(
    snapshot: Snapshot,  # The state after the step
    tracker: int,  # The tracker
    name: str,  # Name of the tracker
) -> str:
    """Return the line of a tracker's last step, without a line break."""
    episodes = snapshot.episodes
    return str(
        StepLine(
            name=name,
            done=bool(episodes.done[tracker]),
            reward=float(episodes.reward[tracker]),
            step_count=int(episodes.step_count[tracker]),
            time=float(episodes.tick[tracker]) * PHYSICS_STEP,
            direction=int(episodes.direction[tracker]),
            camera_pitch=float(snapshot.trackers.gimbal[tracker, 1]),
            done_state=DoneReason(int(episodes.breach[tracker])).original,
        )
    )


class EpisodeLines:
    """Tells each episode of N trackers in one line, when it has ended."""

    def __init__(
        self,
        names: Sequence[str],  # Their names
    ) -> None:
        count = len(names)
        self._names = names
        self._number = np.full(count, -1, np.int64)
        self._reward = np.zeros(count)
        self._told = np.ones(count, np.bool_)
        self._steps = np.zeros(count, np.int64)

    def after(
        self,
        snapshot: Snapshot,  # The state after an action
    ) -> Iterator[str]:
        """Yield the lines of the episodes that have ended since the last call."""
        episodes = snapshot.episodes
        begun = episodes.number != self._number
        for tracker in np.flatnonzero(begun & ~self._told).tolist():
            yield self._line(tracker, "It was begun anew.")
        self._reward[begun], self._told[begun] = 0.0, False
        self._number[:] = episodes.number
        self._reward += np.where(self._told, 0.0, episodes.reward)
        self._steps[:] = episodes.step_count
        for tracker in np.flatnonzero(episodes.done & ~self._told).tolist():
            yield self._line(tracker, DoneReason(int(episodes.reason[tracker])).sentence)
            self._told[tracker] = True

    def _line(self, tracker: int, why: str) -> str:
        steps = int(self._steps[tracker])
        return (
            f"{self._names[tracker]}: episode {self._number[tracker]}: {steps} steps "
            f"({steps * PHYSICS_STEP:.3f} s), sum of rewards {self._reward[tracker]:.6g}. {why}"
        )
