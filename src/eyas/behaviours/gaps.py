"""When a road can be crossed: it is green, and no recorded vehicle will be there meanwhile."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.state.motion import Motion
from eyas.targets.catalogue import KINDS, MODELS, models_of
from eyas.traffic.signals import Aspect, SignalPlan

__all__ = ["Gaps"]

_CLEAR: Final = 1.8
"""From the line that is crossed to the side of a vehicle, at least [m]."""

_BENT: Final = 1.5
"""The same for vehicles with a trailer is so much more: in bends they leave their box [m]."""

_BEFORE: Final = 0.5
"""For how long before somebody crosses nothing may be on the line [s]."""

_AFTER: Final = 1.5
"""The same afterwards [s]."""

_PATIENCE: Final = 60.0
"""The longest that somebody waits for a gap [s]."""

Floats = NDArray[np.float64]


class Gaps:
    """The gaps in traffic.

    Args:
        vehicles: The vehicles; None: there are none.
        samples: Number of samples.
        rate: Samples per second [Hz].
        lights: What crossings with lights show, see `walk_plan`; None: there are none.
    """

    def __init__(
        self,
        vehicles: Motion | None,
        samples: int,
        rate: float,
        lights: SignalPlan | None = None,
    ) -> None:
        self._vehicles, self._samples, self._rate = vehicles, samples, rate
        self._known: dict[bytes, NDArray[np.int64]] = {}
        self._columns: dict[int, dict[str, NDArray[np.float32]]] = {}
        self._lights = lights
        self._rows = {} if lights is None else {name: k for k, name in enumerate(lights.edges)}

    def first(
        self, line: Floats, ready: float, lasts: float, light: str = "", to_kerb: float = 0.0
    ) -> float | None:
        """Return when a line can be crossed [s]; None: not before patience is at an end.

        Args:
            line: From kerb to kerb [m], shape (2, 2).
            ready: Earliest time [s].
            lasts: How long it takes [s].
            light: Name of the crossing's light; empty: it has none.
            to_kerb: How long after one's start one is on the road [s].
        """
        busy, rate = self._busy_before(line), self._rate
        first = math.ceil(ready * rate)
        starts = np.arange(first, first + int(_PATIENCE * rate))
        low = np.clip(starts - int(_BEFORE * rate), 0, self._samples)
        high = np.clip(starts + math.ceil((lasts + _AFTER) * rate) + 1, 0, self._samples)
        free = np.flatnonzero(
            (busy[high] == busy[low]) & self._shown(light, starts, lasts, to_kerb)
        )
        return float(starts[free[0]]) / rate if len(free) else None

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
        sizes = np.array([MODELS[model].size for model in models_of(kind)])
        length, width = sizes[:, 0].max(), sizes[:, 1].max()
        clear = 0.5 * width + _CLEAR + (_BENT if KINDS[kind].trailers else 0.0)
        rows = self._of(kind)
        middle, across = line.mean(axis=0), line[1] - line[0]
        reach = 0.5 * (float(np.hypot(*across)) + length) + clear + abs(KINDS[kind].ahead)
        near = (np.abs(rows["x"] - middle[0]) < reach) & (np.abs(rows["y"] - middle[1]) < reach)
        sample, actor = np.nonzero(near & (rows["present"] > 0.0))
        own = {name: column[sample, actor] for name, column in rows.items()}
        places = KINDS[kind].ahead + np.linspace(-0.5, 0.5, int(length) + 2) * length
        x = own["x"][:, None] + places * np.cos(own["yaw"])[:, None] - line[0, 0]
        y = own["y"][:, None] + places * np.sin(own["yaw"])[:, None] - line[0, 1]
        share = np.clip((x * across[0] + y * across[1]) / (across @ across), 0.0, 1.0)
        away = np.hypot(x - share * across[0], y - share * across[1]).min(axis=1, initial=np.inf)
        met = np.zeros(self._samples, np.bool_)
        met[sample[away < clear]] = True
        return met

    def _of(self, kind: int) -> dict[str, NDArray[np.float32]]:
        """Return where vehicles of a kind are, shape (samples, vehicles) each: read many times."""
        if kind not in self._columns:
            assert self._vehicles is not None
            table, chosen = self._vehicles.table[: self._samples], self._vehicles.kind == kind
            columns = {name: table[name][:, chosen] for name in ("x", "y", "yaw", "present")}
            self._columns[kind] = columns
        return self._columns[kind]
