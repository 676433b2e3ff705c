"""A box tracker that flies: it gets the target's true first box, a controller steers to its box."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from eyas.benchmark.policies.box_trackers import Box, BoxTracker, box_tracker
from eyas.benchmark.policies.own_policy import PerEpisodePolicy
from eyas.engine.policies.policy import env_config
from eyas.engine.policies.steering import pixel_offset, towards
from eyas.engine.settings.env import EnvConfig

_SIZE = 240, 320  # Height and width of the pictures


class BoxPilot:
    """Tracks one target; hovers while it is lost."""

    def __init__(self, make: Callable[[], BoxTracker], env: EnvConfig) -> None:
        self._tracker, self._env = make(), env
        self._first: Box | None = None

    def reset(self, box: tuple[int, int, int, int]) -> None:
        """Remember the box of the first picture: left, top, right, bottom."""
        left, top, right, bottom = box
        self._first = left, top, right - left, bottom - top

    def act(self, picture: Any) -> int:  # noqa: ANN401  # an array
        """Track, and steer to the middle of the box."""
        box = self._first
        if box is not None:
            self._tracker.begin(picture, box)
            self._first = None
        else:
            box = self._tracker.update(picture)
        if box is None:
            return int(towards(np.zeros((1, 2)), self._env)[0])
        middle = np.array([box[0] + 0.5 * box[2]]), np.array([box[1] + 0.5 * box[3]])
        return int(towards(pixel_offset(*middle, _SIZE), self._env)[0])


def pilot(said: str, changes: Mapping[str, Any]) -> PerEpisodePolicy:
    """Return the policy of a box tracker.

    Args:
        said: A name of `BOX_TRACKERS`, or `package.module:Class`.

    Raises:
        EyasError: The box tracker cannot be used here.
    """
    make = box_tracker(said, "--policy")
    image = {"width": _SIZE[1], "height": _SIZE[0], "layout": "hwc", "colours": "rgb", "frames": 1}
    fixed = {"observation": image, "actions": "discrete"}
    env = env_config({**fixed, "action_repeat": 4}, {**changes, **fixed})
    return PerEpisodePolicy(lambda: BoxPilot(make, env), env, said, frozenset({"box"}))


csrt, kcf, mosse = (partial(pilot, name) for name in ("csrt", "kcf", "mosse"))
medianflow, nano, stay = (partial(pilot, name) for name in ("medianflow", "nano", "stay"))
