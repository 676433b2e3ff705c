"""The end of an episode and its reason."""

import math
from enum import IntEnum

from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.snapshot import TargetState, TrackerState
from eyas.engine.state.terrain import Terrain, relief_at
from eyas.engine.task.rules import Rules
from eyas.lanes import kernel


class DoneReason(IntEnum):
    """Why an episode has ended."""

    NONE = 0
    HEIGHT = 1
    DISTANCE = 2
    VELOCITY = 3
    YAW_RATE = 4
    TILT = 5
    TARGET_LOST = 6
    NO_REWARD = 7
    STEP_LIMIT = 8
    NOT_A_NUMBER = 9
    CRASH = 10

    @property
    def sentence(self) -> str:
        """The reason as an English sentence."""
        return _SENTENCES[self]

    @property
    def original(self) -> str:
        """The original's `doneState`; only limits of the body have one, others give `none`."""
        return _ORIGINALS.get(self, "none")


_SENTENCES = {
    DoneReason.NONE: "The episode goes on.",
    DoneReason.HEIGHT: "The tracker is too low or too high.",
    DoneReason.DISTANCE: "The tracker is too far from where its commands should have brought it.",
    DoneReason.VELOCITY: "The tracker is too fast.",
    DoneReason.YAW_RATE: "The tracker turns too fast.",
    DoneReason.TILT: "The tracker tilts too far.",
    DoneReason.TARGET_LOST: "The target has left the world.",
    DoneReason.NO_REWARD: "There was no reward for too long.",
    DoneReason.STEP_LIMIT: "The episode has reached its number of steps.",
    DoneReason.NOT_A_NUMBER: "A value of the state is not a finite number.",
    DoneReason.CRASH: "The tracker has touched something.",
}
_ORIGINALS = {
    DoneReason.HEIGHT: "height",
    DoneReason.DISTANCE: "distance",
    DoneReason.VELOCITY: "velocity",
    DoneReason.YAW_RATE: "yaw velocity",
    DoneReason.TILT: "pitch or yaw angle",
}

_NONE, _HEIGHT, _DISTANCE = (int(DoneReason.NONE), int(DoneReason.HEIGHT), int(DoneReason.DISTANCE))
_VELOCITY, _YAW_RATE, _TILT = (
    int(DoneReason.VELOCITY),
    int(DoneReason.YAW_RATE),
    int(DoneReason.TILT),
)
_TARGET_LOST, _NO_REWARD = int(DoneReason.TARGET_LOST), int(DoneReason.NO_REWARD)
_STEP_LIMIT, _NOT_A_NUMBER = int(DoneReason.STEP_LIMIT), int(DoneReason.NOT_A_NUMBER)


@kernel(inline=True)
def broken_limit(trackers: TrackerState, n: int, terrain: Terrain, rules: Rules) -> int:
    """Return the `DoneReason` of the first limit that body `n` violates, or `NONE`.

    Heights are measured above z = 0 on flat land, as in the original, and above the relief below
    the body on hills; roads have these heights.
    """
    position, commanded = trackers.position[n], trackers.commanded_position[n]
    velocity, euler = trackers.velocity[n], trackers.euler[n]
    height = position[2] - relief_at(terrain, position[0], position[1])
    if height < rules.min_height or height > rules.max_height:
        return _HEIGHT
    error_x, error_y = commanded[0] - position[0], commanded[1] - position[1]
    if math.sqrt(error_x * error_x + error_y * error_y) > rules.distance_error:
        return _DISTANCE
    speed = math.sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1])
    if speed >= rules.velocity:
        return _VELOCITY
    if abs(trackers.angular_velocity[n, 2]) > rules.yaw_rate:
        return _YAW_RATE
    if abs(euler[0]) > rules.roll or abs(euler[1]) > rules.pitch:
        return _TILT
    return _NONE


@kernel(inline=True)
def judge(
    trackers: TrackerState,
    targets: TargetState,
    episodes: EpisodeState,
    n: int,
    terrain: Terrain,
    rules: Rules,
) -> int:
    """Count one physics step of tracker `n` and return its `DoneReason`; call after `observe`.

    The order is the original's: limits of the body, lost target, no reward, number of steps. All
    are ignored during the grace steps, but not-a-number never is. Two faults of the original are
    corrected: a lost target stays lost (the original reports it for only one step of 2 ms, which
    clients miss), and a limit that is no longer violated has no effect.
    """
    episodes.step_count[n] += 1
    episodes.breach[n] = broken_limit(trackers, n, terrain, rules)
    episodes.crash[n] = is_crash(episodes.breach[n])
    if episodes.reward[n] > rules.cut_off:
        episodes.no_reward_count[n] = 0
    else:
        episodes.no_reward_count[n] += 1
    if not math.isfinite(_total(trackers, targets, episodes, n)):
        episodes.not_a_number[n] = True
    reason = _reason(targets, episodes, n, rules)
    episodes.reason[n] = reason
    return reason


@kernel(inline=True)
def _total(trackers: TrackerState, targets: TargetState, episodes: EpisodeState, n: int) -> float:
    """Return a sum that is finite if the state is, unless its terms come near 1e308."""
    euler = trackers.euler[n]
    total: float = episodes.reward[n] + euler[0] + euler[1] + euler[2]
    total += trackers.angular_velocity[n, 2]
    for axis in range(3):
        total += trackers.position[n, axis] + trackers.velocity[n, axis] + targets.centre[n, axis]
    return total


@kernel(inline=True)
def _reason(targets: TargetState, episodes: EpisodeState, n: int, rules: Rules) -> int:
    if episodes.not_a_number[n]:
        return _NOT_A_NUMBER
    if episodes.step_count[n] < rules.grace_steps:
        return _NONE
    if episodes.breach[n] != _NONE:
        return int(episodes.breach[n])
    if targets.lost[n]:
        return _TARGET_LOST
    if episodes.no_reward_count[n] > rules.no_reward_steps:
        return _NO_REWARD
    if episodes.step_count[n] >= rules.total_steps:
        return _STEP_LIMIT
    return _NONE


@kernel
def is_crash(breach: int) -> bool:
    """Return whether the original calls a violated limit a crash."""
    return breach == _DISTANCE or breach == _YAW_RATE
