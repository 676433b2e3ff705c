"""The step on a device: a thread for each tracker runs the kernels of `eyas.engine.sim.step`."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sim.episode_sampling import ModelTable, follow
from eyas.engine.sim.step import Orders, StepKernels, StepState, begin_one, fly_one
from eyas.engine.targets.kind import Looks
from eyas.engine.task.done import DoneReason
from eyas.lanes import ParallelCall, parallel, specialised

_STEP_LIMIT: Final = int(DoneReason.STEP_LIMIT)

FEW: Final = 32
"""Threads that a card starts together where each has much to do, so that some thousands are on all
its processors."""

START: Final = np.dtype(
    [
        ("tracker", np.int64),
        ("number", np.int64),
        ("tick", np.int64),
        ("actor", np.int64),
        ("model", np.int64),
        *((name, np.float64) for name in ("pitch", "ahead", "left", "up", "heading")),
        *((name, np.float64) for name in ("field_of_view", "focal_x", "focal_y")),
        *((name, np.float32) for name in ("sky", "sun", "fog_density", "wind_x", "wind_y")),
    ],
    align=True,
)
"""What is drawn for an episode: the tracker; `EpisodeState.number` and `tick`; actor and model of
its target; the commanded pitch of its camera [rad]; `EpisodeState.start_offset`; the horizontal
field of view [rad] and focal lengths of its pictures [pixels]; its `LightState`."""


class Flown(NamedTuple):
    """How trackers have done in an action."""

    repeat: NDArray[np.int64]
    """Commands of `Orders.steps` physics steps that an action lasts, shape (1,)."""
    weight: NDArray[np.float64]  # Of the built-in reward, shape (1,)
    reward: NDArray[np.float64]  # Sum over these commands, shape (N,)
    reason: NDArray[np.int64]  # `DoneReason`, shape (N,)
    terminated: NDArray[np.uint8]  # 1: the episode has ended before its number of steps, shape (N,)
    truncated: NDArray[np.uint8]  # 1: it has ended by it, shape (N,)


class Focal(NamedTuple):
    """The pictures of N trackers."""

    length: NDArray[np.float64]  # Focal length along rows and along columns [pixels], shape (N, 2)


class Starts(NamedTuple):
    """K episodes to begin, in the first of N rows."""

    length: NDArray[np.int64]  # K, shape (1,)
    row: NDArray[np.void]  # Of `START`, shape (N,)
    looks: Looks  # Of all actors in the worlds of these trackers, N worlds


class FlightCalls(NamedTuple):
    """The drivers of the step, for one kind of tracker."""

    act: ParallelCall  # `StepState`, `Orders`, `Flown`: moves all active trackers by an action
    begin: ParallelCall  # `StepState`, `ModelTable`, `Looks`, `Focal`, `Starts`: begins episodes


def flight_calls(kernels: StepKernels) -> FlightCalls:
    """Return the drivers with the kernels of a step."""
    return _calls(kernels.fly_one, kernels.begin_one)


@lru_cache(maxsize=16)
def _calls(fly: Callable[..., Any], begin: Callable[..., Any]) -> FlightCalls:
    return FlightCalls(
        act=parallel(specialised(_act, fly_one=fly)),
        begin=parallel(specialised(_begin, begin_one=begin)),
    )


def _act(worker: int, workers: int, state: StepState, orders: Orders, flown: Flown) -> None:
    """Move trackers until the end of an action or of their episodes."""
    episodes = state.snapshot.episodes
    for n in range(worker, orders.commands.shape[0], workers):
        reward, reason = 0.0, 0
        if orders.active[n]:
            for _command in range(flown.repeat[0]):
                fly_one(state, orders, n)
                reward += flown.weight[0] * episodes.reward[n]
                reason = episodes.reason[n]
                if reason > 0:
                    break
        flown.reward[n], flown.reason[n] = reward, reason
        flown.terminated[n] = 1 if reason > 0 and reason != _STEP_LIMIT else 0
        flown.truncated[n] = 1 if reason == _STEP_LIMIT else 0


def _begin(  # the records that it writes
    worker: int,
    workers: int,
    state: StepState,
    models: ModelTable,
    looks: Looks,
    focal: Focal,
    starts: Starts,
) -> None:
    """Begin the episodes that have been drawn; each tracker has a world of its own."""
    _, cameras, targets, episodes, light = state.snapshot
    for k in range(worker, starts.length[0], workers):
        row = starts.row[k]
        n = row.tracker
        episodes.number[n], episodes.tick[n] = row.number, row.tick
        offset = episodes.start_offset[n]
        offset[0], offset[1], offset[2], offset[3] = row.ahead, row.left, row.up, row.heading
        cameras.field_of_view[n] = row.field_of_view
        focal.length[n, 0], focal.length[n, 1] = row.focal_x, row.focal_y
        light.sky[n], light.sun[n], light.fog_density[n] = row.sky, row.sun, row.fog_density
        light.wind_x[n], light.wind_y[n] = row.wind_x, row.wind_y
        for actor in range(looks.model.shape[1]):
            looks.model[n, actor] = starts.looks.model[k, actor]
            for channel in range(3):
                looks.colour[n, actor, channel] = starts.looks.colour[k, actor, channel]
        follow(targets, episodes, models, n, row.actor, row.model)
        begin_one(state, n, row.pitch)
