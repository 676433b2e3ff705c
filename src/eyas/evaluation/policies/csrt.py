"""OpenCV's box tracker CSRT, which gets the target's true first box, and a controller."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from eyas.core.errors import MissingExtraError
from eyas.envs.config import EnvConfig
from eyas.evaluation.policies.each import Each
from eyas.evaluation.policies.policy import env_config
from eyas.evaluation.steering import pixel_offset, towards

__all__ = ["Csrt", "csrt"]

_SIZE = 240, 320
"""Height and width of the pictures."""

_LEAST = 8
"""Smallest side of a box with which the tracker can begin [pixels]."""


class Csrt:
    """Tracks one target; hovers while it is lost.

    Args:
        cv2: The module.
        env: How long an action lasts.
    """

    def __init__(self, cv2: Any, env: EnvConfig) -> None:  # noqa: ANN401  # a module
        self._cv2, self._env = cv2, env
        self._box: tuple[int, int, int, int] | None = None
        self._tracker: Any = None

    def reset(self, box: tuple[int, int, int, int]) -> None:
        """Remember the box of the first picture: left, top, right, bottom."""
        left, top, right, bottom = box
        width, height = max(right - left, _LEAST), max(bottom - top, _LEAST)
        self._box = left, top, width, height

    def act(self, picture: Any) -> int:  # noqa: ANN401  # an array
        """Track, and steer to the middle of the box."""
        bgr = np.ascontiguousarray(picture[..., ::-1])
        if self._tracker is None:
            self._tracker = self._cv2.TrackerCSRT_create()
            self._tracker.init(bgr, self._box)
            found, box = True, self._box
        else:
            found, box = self._tracker.update(bgr)
        assert box is not None
        middle = np.array([box[0] + 0.5 * box[2]]), np.array([box[1] + 0.5 * box[3]])
        offset = pixel_offset(*middle, _SIZE)
        return int(towards(offset * bool(found), self._env)[0])


def csrt(changes: Mapping[str, Any]) -> Each:
    """Return the tracker.

    Raises:
        MissingExtraError: OpenCV is not installed.
    """
    try:
        import cv2
    except ImportError as error:
        raise MissingExtraError("the tracker CSRT", "policies") from error
    cv2.setNumThreads(1)  # for the same bytes on every machine
    image = {"width": _SIZE[1], "height": _SIZE[0], "layout": "hwc", "colours": "rgb", "frames": 1}
    fixed = {"observation": image, "actions": "discrete"}
    env = env_config({**fixed, "action_repeat": 4}, {**changes, **fixed})
    return Each(lambda: Csrt(cv2, env), env, "csrt")
