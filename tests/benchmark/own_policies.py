"""Policies such as users write."""

# ruff: noqa: RUF012  # as users write them
import numpy as np

from eyas import ATTRIBUTES, Decision, Policy


def forward(picture):
    assert picture.shape == (84, 84, 3)
    return 0


def together(pictures):
    assert pictures.dtype == np.uint8
    return np.full(len(pictures), 6)


together.batched = True
together.env_settings = {"observation": {"width": 16, "height": 12}, "action_repeat": 25}


class BoxTracker:
    """Hovers, if its target is in the middle of the first picture."""

    env_settings = {"observation": {"width": 64, "height": 48}, "action_repeat": 25}

    def reset(self, box):
        self.box = box

    def act(self, picture):
        left, top, right, bottom = self.box
        assert abs(left + right - 64) < 16, self.box
        assert abs(top + bottom - 48) < 16, self.box
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


class CannotBegin:
    """Fails before its first picture."""

    def reset(self, box):
        raise OSError("no weights")

    def act(self, picture):
        return 6


def wrong(pictures):
    return np.full(len(pictures), 7)


wrong.batched = True


def hovering_module(torch):
    """Return a module whose best action is to hover, whatever it sees."""

    class Hovering(torch.nn.Module):
        env_settings = {
            "observation": {"width": 16, "height": 12, "layout": "chw"},
            "action_repeat": 25,
        }

        def __init__(self):
            super().__init__()
            self.scores = torch.nn.Parameter(torch.tensor([0.0, 0, 0, 0, 0, 0, 1]))

        def forward(self, image):
            return image.float().mean(dim=(1, 2, 3))[:, None] * 0.0 + self.scores

    # A pickle tells a class by its name in its module.
    Hovering.__qualname__ = "Hovering"
    globals()["Hovering"] = Hovering
    return Hovering()


class TimesOfLooks:
    """Hovers, and counts how often it is asked."""

    count = {}
    env_settings = {"observation": {"width": 16, "height": 12}}

    def act(self, picture):
        self.count[id(self)] = self.count.get(id(self), 0) + 1
        return 6


class WordsOnly:
    """Flies 8 m to where the words say that the target is, without a look, and hovers there."""

    env_settings = {"observation": {"parts": ["attributes"]}, "action_repeat": 25}
    ways = {"left": 2, "right": 3, "top": 0, "bottom": 1}

    def reset(self, attributes):
        names = [f"place_{side}" for side in self.ways]
        ends = [f"place_{side}most" for side in self.ways]
        self.action = 6
        for side, *places in zip(self.ways, names, ends, strict=True):
            if any(attributes[ATTRIBUTES.index(place)] for place in places):
                self.action = self.ways[side]

    def act(self, attributes):
        action, self.action = self.action, 6
        return action


class OneOf:
    """Turns if its target begins in the middle; an object for each episode."""

    env_settings = {"observation": {"width": 32, "height": 24}, "action_repeat": 25}

    def reset(self, box):
        self.box = np.array(box)

    def act(self, picture):
        return int(self.box.sum() % 7)


class Batch(Policy):
    """The same for all episodes together."""

    env_settings = OneOf.env_settings
    told = frozenset({"box"})

    def begin(self, start):
        assert not start.seeds.any()
        assert start.told is None
        self.boxes = start.boxes()

    def act(self, sight):
        assert sight.observation.shape[1:] == (24, 32, 3)
        return Decision(self.boxes.sum(1) % 7)
