"""Policies such as users write."""

import numpy as np


def forward(picture):
    assert picture.shape == (84, 84, 3)
    return 0


def together(pictures):
    assert pictures.dtype == np.uint8
    return np.full(len(pictures), 6)


together.batched = True
together.env_settings = {"observation": {"width": 16, "height": 12}, "action_repeat": 25}


class BoxTracker:
    """Hovers; fails in the first episode whose target is not in the middle of its first picture."""

    env_settings = {"observation": {"width": 64, "height": 48}, "action_repeat": 25}

    def reset(self, box):
        self.box = box

    def act(self, picture):
        left, top, right, bottom = self.box
        assert left < 32 < right, self.box
        assert top < 24 < bottom, self.box
        return 6


class Fails:
    """Raises in its third decision, for half of the episodes."""

    env_settings = {"observation": {"parts": ["privileged"]}, "action_repeat": 25}
    made = 0

    def __init__(self):
        type(self).made += 1
        self.bad, self.calls = type(self).made % 2 == 0, 0

    def act(self, state):
        self.calls += 1
        if self.bad and self.calls == 3:
            raise RuntimeError("no\nidea")
        return 6


def wrong(pictures):
    return np.full(len(pictures), 7)


wrong.batched = True
