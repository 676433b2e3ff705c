"""Visual servoing: finds what was in the middle of the first picture again, and flies to it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from eyas.engine.policies.policy import Decision, PolicyInput, Start, env_config
from eyas.engine.policies.steering import DEPTH, PERIOD, pixel_offset, towards
from eyas.lanes import exact

_SIZE = 84
_PATCH = 14  # Side of the pattern [pixels]
_REACH = 11  # Farthest motion between two pictures [pixels]
_LEARNING = 0.1  # Share of a new picture in the pattern, where the match is good
_GOOD = 0.6  # Least correlation of a good match
_GAIN = 5.0  # Rate at which a camera is turned, by how far it would have to be [1/s]
_HIGHEST = 0.6  # How far it may be turned up [rad]
_SHARES = np.zeros((7, 4))
_SHARES[:4, :2] = [[1, 0], [-1, 0], [0, 1], [0, -1]]  # The seven actions as shares of the speeds

Floats = NDArray[np.float64]


class Servo:
    """Follows a pattern of pixels by normalised correlation, from the picture alone.

    It takes what is in the middle of the first picture for the target.
    """

    sampled = False
    told: frozenset[str] = frozenset()

    actions = "discrete"

    def __init__(self, changes: Mapping[str, Any]) -> None:
        image = {"width": _SIZE, "height": _SIZE, "colours": "rgb", "layout": "chw", "frames": 1}
        own = {"observation": image, "action_repeat": 4}
        self.env = env_config(own, {**changes, "observation": image, "actions": self.actions})

    def begin(self, start: Start) -> None:
        """Forget the patterns."""
        count = len(start.seeds)
        self._pattern: list[Floats | None] = [None] * count
        self._place = np.full((count, 2), 0.5 * (_SIZE - _PATCH))

    def act(self, sight: PolicyInput) -> Decision:
        """Find the patterns, and steer."""
        pictures: Any = sight.observation
        for row in np.flatnonzero(sight.deciding).tolist():
            self._find(row, pictures[row].astype(np.float64))
        middle = self._place + 0.5 * _PATCH
        offset = pixel_offset(middle[:, 1], middle[:, 0], (_SIZE, _SIZE))
        return self._steer(offset, sight.deciding)

    def _steer(self, offset: Floats, deciding: NDArray[np.bool_]) -> Decision:
        """Return the actions towards what is ahead and to the left [m], shape (N, 2), of those who
        decide, shape (N,).
        """
        return Decision(towards(offset, self.env))

    def _find(self, row: int, picture: Floats) -> None:
        """Move the place of a pattern to its best match in a picture, shape (3, H, W)."""
        top, left = np.round(self._place[row]).astype(int)
        pattern = self._pattern[row]
        if pattern is None:
            self._pattern[row] = picture[:, top : top + _PATCH, left : left + _PATCH]
            return
        first = max(top - _REACH, 0), max(left - _REACH, 0)
        area = picture[:, first[0] : top + _REACH + _PATCH, first[1] : left + _REACH + _PATCH]
        if min(area.shape[1:]) < _PATCH:
            return
        match = _correlation(area, pattern)
        best = np.unravel_index(int(match.argmax()), match.shape)
        place = first[0] + int(best[0]), first[1] + int(best[1])
        self._place[row] = place
        if match[best] > _GOOD:
            seen = picture[:, place[0] : place[0] + _PATCH, place[1] : place[1] + _PATCH]
            self._pattern[row] = (1.0 - _LEARNING) * pattern + _LEARNING * seen


class GimbalServo(Servo):
    """Also turns its camera to the pattern, up and down, which takes less time than to fly there.

    What is far enough ahead to turn the camera to it is still flown to.
    """

    actions = "shares+gimbal"

    def begin(self, start: Start) -> None:
        """Forget the patterns, and take the cameras to look as in their first pictures."""
        super().begin(start)
        self._raised = np.zeros(len(start.seeds))
        """How far each camera has been turned up [rad]."""

    def _steer(self, offset: Floats, deciding: NDArray[np.bool_]) -> Decision:
        """Return what flies and turns the camera."""
        up = exact.atan(offset[:, 0] / DEPTH)
        period = PERIOD * self.env.action_repeat
        most = self.env.gimbal.pitch_rate
        raised = np.clip(self._raised + _GAIN * period * up, 0.0, _HIGHEST)
        rate = np.clip((raised - self._raised) / period, -most, most)
        ahead = DEPTH * exact.tan(up + self._raised)
        self._raised = self._raised + np.where(deciding, period * rate, 0.0)
        flown = _SHARES[towards(np.stack((ahead, offset[:, 1]), axis=1), self.env)]
        return Decision(np.column_stack((flown, -rate / most, np.zeros(len(rate)))))


def _correlation(area: Floats, pattern: Floats) -> Floats:
    """Return the normalised correlation of a pattern with each place of an area, -1 to 1."""
    windows = sliding_window_view(area, pattern.shape[1:], axis=(1, 2))
    centred = pattern - pattern.mean(axis=(1, 2), keepdims=True)
    dot = (windows * centred[:, None, None]).sum(axis=(0, 3, 4))
    spread = np.square(windows).sum(axis=(0, 3, 4)) - (
        np.square(windows.sum(axis=(3, 4))) / pattern[0].size
    ).sum(axis=0)
    match: Floats = dot / np.sqrt(np.maximum(spread, 1.0) * max(np.square(centred).sum(), 1.0))
    return match
