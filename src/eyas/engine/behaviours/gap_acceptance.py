"""When a road can be crossed: it is green, and no recorded vehicle will be there meanwhile."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.motion import SampledMotion
from eyas.engine.targets.catalogue import KINDS, MODELS, models_of, sections_of
from eyas.engine.targets.kind import Section
from eyas.engine.traffic.signals import Aspect, SignalPlan
from eyas.engine.traffic.trailer import folded_by
from eyas.lanes import exact, interpreted

_CLEAR: Final = 1.8  # From the line that is crossed to the side of a vehicle, at least [m]

_ASIDE: Final = 0.3
"""From who waits at the kerb to the side of a vehicle, at least: tails cut corners [m]."""

_BEFORE: Final = 0.5  # For how long before somebody crosses nothing may be on the line [s]

_AFTER: Final = 1.5  # The same afterwards [s]

_PATIENCE: Final = 60.0  # The longest that somebody waits for a gap [s]

Floats = NDArray[np.floating]

_folded_by = interpreted(folded_by)


class GapAcceptance:
    """The gaps in traffic."""

    def __init__(
        self,
        vehicles: SampledMotion | None,  # The vehicles; None: there are none
        samples: int,  # Number of samples
        rate: float,  # Samples per second [Hz]
        # What crossings with lights show, see `walk_plan`; None: there are none
        lights: SignalPlan | None = None,
    ) -> None:
        self._samples, self._rate = samples, rate
        self._tracks: list[_KindTracks] = []
        if vehicles is not None:
            kinds = np.unique(vehicles.kind).tolist()
            self._tracks = [_tracks_of(vehicles, kind, samples) for kind in kinds]
        self._known: dict[tuple[bytes, float], NDArray[np.int64]] = {}
        self._lights = lights
        self._rows = {} if lights is None else {name: k for k, name in enumerate(lights.edges)}

    def first(
        self,
        line: Floats,  # From the kerb at which one waits to the other one [m], shape (2, 2)
        ready: float,  # Earliest time [s]
        lasts: float,  # How long it takes [s]
        light: str = "",  # Name of the crossing's light; empty: it has none
        to_kerb: float = 0.0,  # How long after one's start one is on the road [s]
    ) -> float | None:
        """Return when a line can be crossed [s].

        None: patience ends before there is a gap, or a long vehicle turns over the kerb in
        between.
        """
        busy, rate = self._busy_before(line, _CLEAR), self._rate
        first = math.ceil(ready * rate)
        starts = np.arange(first, first + int(_PATIENCE * rate))
        low = np.clip(starts - int(_BEFORE * rate), 0, self._samples)
        high = np.clip(starts + math.ceil((lasts + _AFTER) * rate) + 1, 0, self._samples)
        free = np.flatnonzero(
            (busy[high] == busy[low]) & self._shown(light, starts, lasts, to_kerb)
        )
        if not len(free):
            return None
        swept = self._busy_before(line[[0, 0]], _ASIDE)
        wait = np.clip([first, starts[free[0]]], 0, self._samples)
        return float(starts[free[0]]) / rate if np.ptp(swept[wait]) == 0 else None

    def _shown(
        self, light: str, starts: NDArray[np.int64], lasts: float, to_kerb: float
    ) -> NDArray[np.bool_]:
        """Return at which of consecutive samples a light lets one cross.

        It is green until one is on the road, and traffic has red until one has crossed.
        """
        if self._lights is None or light not in self._rows:
            return np.full(len(starts), not light)
        after, still = math.ceil(lasts * self._rate) + 1, math.ceil(to_kerb * self._rate)
        times = np.arange(starts[0], starts[-1] + max(after, still) + 1) / self._rate
        aspect = self._lights.only(self._rows[light]).at(times)[:, 0]
        held = np.concatenate([[0], np.cumsum(aspect == Aspect.RED)])
        other = np.concatenate([[0], np.cumsum(aspect != Aspect.GREEN)])
        here = np.arange(len(starts))
        goes: NDArray[np.bool_] = other[here + still + 1] == other[here]
        finishes: NDArray[np.bool_] = held[here + after] == held[here]
        return np.logical_and(goes, finishes)

    def _busy_before(
        self,
        line: Floats,  # Where it begins and ends [m], shape (2, 2)
        clear: float,  # Up to which distance of its sides it is a vehicle on it [m]
    ) -> NDArray[np.int64]:
        """Return at how many samples before each a vehicle is on a line, shape (samples + 1,)."""
        key = min(line.tobytes(), line[::-1].tobytes()), clear  # there and back
        if key not in self._known:
            busy = np.zeros(self._samples, np.bool_)
            for tracks in self._tracks:
                busy[_met_by(tracks, line, clear)] = True
            self._known[key] = np.concatenate([[0], np.cumsum(busy)])
        return self._known[key]


class _KindTracks(NamedTuple):
    """The motion of the vehicles of one kind."""

    rows: NDArray[np.void]  # Their samples, shape (samples, vehicles)
    x: Floats  # Their places in order; far away where they are absent [m]
    y: Floats  # Of the same samples [m]
    at: NDArray[np.intp]  # Which samples these are, in the order of `rows`
    sections: list[Section]
    middle: float  # Distance of their middles ahead of their reference points [m]
    reach: float  # How far from its reference point a vehicle reaches, at most [m]


def _tracks_of(vehicles: SampledMotion, kind: int, samples: int) -> _KindTracks:
    rows, middle = vehicles.table[:samples, vehicles.kind == kind], KINDS[kind].ahead
    length, width = np.array([MODELS[model].size[:2] for model in models_of(kind)]).max(axis=0)
    x = np.where(rows["present"] > 0.0, rows["x"], np.float32(np.inf)).ravel()
    at = np.argsort(x, kind="stable")
    reach = 0.5 * (float(length) + float(width)) + abs(middle)
    return _KindTracks(rows, x[at], rows["y"].ravel()[at], at, _largest(kind), middle, reach)


def _met_by(tracks: _KindTracks, line: Floats, clear: float) -> NDArray[np.int64]:
    """Return at which samples a vehicle is on a line, see `GapAcceptance`; some more than once."""
    middle, across = line.mean(axis=0), line[1] - line[0]
    reach = 0.5 * float(exact.hypot(*across)) + tracks.reach + clear
    first, last = (np.float32(middle[0] + end) for end in (-reach - 1.0, reach + 1.0))
    few = slice(int(np.searchsorted(tracks.x, first)), int(np.searchsorted(tracks.x, last)))
    near = (np.abs(tracks.x[few] - middle[0]) < reach) & (np.abs(tracks.y[few] - middle[1]) < reach)
    sample, actor = np.divmod(tracks.at[few][near], tracks.rows.shape[1])
    own, met = tracks.rows[sample, actor], []
    for section in tracks.sections:
        x, y = _axis(own, section, tracks.middle) - line[0][:, None, None]
        share = np.clip(
            (x * across[0] + y * across[1]) / max(exact.product(across, across), 1e-9), 0.0, 1.0
        )
        away = exact.hypot(x - share * across[0], y - share * across[1])
        met.append(sample[away.min(axis=1, initial=np.inf) < 0.5 * section.size[1] + clear])
    return np.concatenate(met)


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


def _axis(
    own: NDArray[np.void],  # Their samples
    section: Section,
    middle: float,  # Distance of their middles ahead of their reference points [m]
) -> Floats:
    """Return points along a section of some vehicles [m], shape (2, vehicles, points)."""
    x, y, c, s = _folded_by(exact.sin(own["hitch"]), exact.cos(own["hitch"]), section.towed)
    # Where their reference points would be if they were straight, from where they are.
    x, y = x + middle * (1.0 - c), y - middle * s
    cosine, sine = exact.cos(own["yaw"]), exact.sin(own["yaw"])
    place = np.stack([own["x"] + cosine * x - sine * y, own["y"] + sine * x + cosine * y])
    heading = np.stack([cosine * c - sine * s, sine * c + cosine * s])
    length = section.size[0]
    places = middle + section.ahead + np.linspace(-0.5, 0.5, int(length) + 2) * length
    points: Floats = place[..., None] + places * heading[..., None]
    return points
