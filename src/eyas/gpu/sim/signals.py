"""When the lights of signals change: in whole physics steps, so that a thread can look it up."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.sim.views.additions import SignalLights
from eyas.engine.traffic.signals import SignalPlan
from eyas.lanes import kernel

_AROUND = np.arange(-2, 3)
"""Physics steps around the end of a phase in one of which it ends: times are rounded."""


class SignalTimes(NamedTuple):
    """The changes of the lights on P poles, pole by pole."""

    first: NDArray[np.int64]
    """Where those of each pole begin, and at last their number, shape (P + 1,)."""
    tick: NDArray[np.int64]  # From when on [physics steps]; 0 for the first of each
    part: NDArray[np.int32]  # What part is shown, -1: none


def signal_times(lights: SignalLights | None, last: int) -> SignalTimes:
    """Return the changes of lights up to a time [physics steps]; None: there are no lights."""
    if lights is None:
        return SignalTimes(np.zeros(1, np.int64), np.zeros(0, np.int64), np.zeros(0, np.int32))
    changes = [_changes(lights.plan.only(row), last) for row in lights.row.tolist()]
    tick, aspect = (np.concatenate(each) for each in zip(*changes, strict=True))
    part = np.where(aspect < 0, -1, lights.first_part + aspect).astype(np.int32)
    first = np.cumsum([0, *(len(ticks) for ticks, _ in changes)], dtype=np.int64)
    return SignalTimes(first, tick, part)


def _changes(plan: SignalPlan, last: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return when one light changes [physics steps], and the `Aspect` that it then shows."""
    cycle, offset, end = float(plan.cycle[0]), float(plan.offset[0]), plan.end[0]
    ends = np.concatenate([[0.0], end[np.isfinite(end)]])
    cycles = np.zeros(1)
    if cycle > 0.0:
        cycles = np.arange(-offset // cycle - 1.0, (last * PHYSICS_STEP - offset) // cycle + 2.0)
    times = offset + cycles[:, None] * cycle + ends
    near = np.round(times.reshape(-1, 1) / PHYSICS_STEP).astype(np.int64) + _AROUND
    tick = np.unique(np.clip(np.append(near.ravel(), 0), 0, last))
    aspect = plan.at(tick * PHYSICS_STEP)[:, 0]
    changed = np.append(True, aspect[1:] != aspect[:-1])
    return tick[changed], aspect[changed]


@kernel(inline=True)
def shown_part(times: SignalTimes, pole: int, tick: int) -> int:
    """Return the part that a pole shows at a time [physics steps], -1: none."""
    low, high = times.first[pole], times.first[pole + 1]
    while high - low > 1:
        middle = (low + high) // 2
        if times.tick[middle] <= tick:
            low = middle
        else:
            high = middle
    return int(times.part[low])
