"""Box trackers for tests."""

from pathlib import Path

import numpy as np


class Drifting:
    """Knows where the bright square is, and says a box that is off by a pixel more each time."""

    def begin(self, picture, box):
        self.box, self.calls = box, 0

    def update(self, picture):
        self.calls += 1
        left, top, width, height = self.box
        return left + self.calls, top, width, height


class Fails:
    def begin(self, picture, box):
        pass

    def update(self, picture):
        raise RuntimeError("no luck\nat all")


class LosesIt:
    """Finds nothing, and counts how often it was begun."""

    def begin(self, picture, box):
        path = Path("begun")
        path.write_text(path.read_text() + "x" if path.exists() else "x")

    def update(self, picture):
        return None


class Wild:
    def begin(self, picture, box):
        pass

    def update(self, picture):
        return np.nan, -1e300, np.inf, 5.0
