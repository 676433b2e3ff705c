"""When a road can be crossed: no recorded vehicle will be there meanwhile."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import interpreted
from eyas.state.motion import Motion
from eyas.targets.catalogue import KINDS, MODELS, models_of, sections_of
from eyas.targets.kind import Section
from eyas.traffic.trailer import folded

__all__ = ["Gaps"]

_CLEAR: Final = 1.8
"""From the line that is crossed to the side of a vehicle, at least [m]."""

_BEFORE: Final = 0.5
"""For how long before somebody crosses nothing may be on the line [s]."""

_AFTER: Final = 1.5
"""The same afterwards [s]."""

_PATIENCE: Final = 60.0
"""The longest that somebody waits for a gap [s]."""

Floats = NDArray[np.float64]

_folded = interpreted(folded)


class Gaps:
    """The gaps in traffic.

    Args:
        vehicles: The vehicles; None: there are none.
        samples: Number of samples.
        rate: Samples per second [Hz].
    """

    def __init__(self, vehicles: Motion | None, samples: int, rate: float) -> None:
        self._vehicles, self._samples, self._rate = vehicles, samples, rate
        self._known: dict[bytes, NDArray[np.int64]] = {}

    def first(self, line: Floats, ready: float, lasts: float) -> float | None:
        """Return when a line can be crossed [s]; None: not before patience is at an end.

        Args:
            line: From kerb to kerb [m], shape (2, 2).
            ready: Earliest time [s].
            lasts: How long it takes [s].
        """
        busy, rate = self._busy_before(line), self._rate
        first = math.ceil(ready * rate)
        starts = np.arange(first, first + int(_PATIENCE * rate))
        low = np.clip(starts - int(_BEFORE * rate), 0, self._samples)
        high = np.clip(starts + math.ceil((lasts + _AFTER) * rate) + 1, 0, self._samples)
        free = np.flatnonzero(busy[high] == busy[low])
        return float(starts[free[0]]) / rate if len(free) else None

    def _busy_before(self, line: Floats) -> NDArray[np.int64]:
        """Return at how many samples before each a vehicle is on a line, shape (samples + 1,)."""
        key = min(line.tobytes(), line[::-1].tobytes())  # there and back
        if key not in self._known:
            busy = np.zeros(self._samples, np.bool_)
            for kind in [] if self._vehicles is None else np.unique(self._vehicles.kind).tolist():
                busy |= self._met_by(kind, line)
            self._known[key] = np.concatenate([[0], np.cumsum(busy)])
        return self._known[key]

    def _met_by(self, kind: int, line: Floats) -> NDArray[np.bool_]:
        """Return when a vehicle of a kind is on a line, shape (samples,)."""
        assert self._vehicles is not None
        length, width = np.array([MODELS[model].size[:2] for model in models_of(kind)]).max(axis=0)
        rows = self._vehicles.table[: self._samples, self._vehicles.kind == kind]
        middle, across = line.mean(axis=0), line[1] - line[0]
        reach = 0.5 * (float(np.hypot(*across)) + length + width) + _CLEAR + abs(KINDS[kind].ahead)
        near = (np.abs(rows["x"] - middle[0]) < reach) & (np.abs(rows["y"] - middle[1]) < reach)
        sample, actor = np.nonzero(near & (rows["present"] > 0.0))
        own = rows[sample, actor]
        met = np.zeros(self._samples, np.bool_)
        for section in _largest(kind):
            x, y = _axis(own, section, KINDS[kind].ahead) - line[0][:, None, None]
            share = np.clip((x * across[0] + y * across[1]) / (across @ across), 0.0, 1.0)
            away = np.hypot(x - share * across[0], y - share * across[1])
            clear = 0.5 * section.size[1] + _CLEAR
            met[sample[away.min(axis=1, initial=np.inf) < clear]] = True
        return met


def _largest(kind: int) -> list[Section]:
    """Return the sections of a kind's models, each as large as in any; rigid ones are one."""
    largest = []
    for same in zip(*(_sections(model) for model in models_of(kind)), strict=True):
        length, width, height = np.array([section.size for section in same]).max(axis=0).tolist()
        longest = max(same, key=lambda section: section.size[0])
        largest.append(longest._replace(size=(length, width, height)))
    return largest


def _sections(model: int) -> tuple[Section, ...]:
    return sections_of(model) or (Section(MODELS[model].name, 0.0, MODELS[model].size, 0, ()),)


def _axis(own: NDArray[np.void], section: Section, middle: float) -> Floats:
    """Return points along a section of some vehicles [m], shape (2, vehicles, points).

    Args:
        own: Their samples.
        section: The section.
        middle: Distance of their middles ahead of their reference points [m].
    """
    x, y, c, s = _folded(own["hitch"], section.towed)
    # Where their reference points would be if they were straight, from where they are.
    x, y = x + middle * (1.0 - c), y - middle * s
    cosine, sine = np.cos(own["yaw"]), np.sin(own["yaw"])
    place = np.stack([own["x"] + cosine * x - sine * y, own["y"] + sine * x + cosine * y])
    heading = np.stack([cosine * c - sine * s, sine * c + cosine * s])
    length = section.size[0]
    places = middle + section.ahead + np.linspace(-0.5, 0.5, int(length) + 2) * length
    points: Floats = place[..., None] + places * heading[..., None]
    return points
