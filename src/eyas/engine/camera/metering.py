"""Metering: pictures are exposed as those before them were found right."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.exposure import (
    ExposureState,
    Zones,
    advance_exposure,
    answer_meter,
    follow_meter,
    gain_of,
)
from eyas.engine.camera.imager import ImagerState
from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import compiled, kernel, parallel
from eyas.lanes.vector import WIDTH, lane, lesser, load, splat

_ROUNDS = 12
"""Corrections of the exposure before the first picture; each is exact unless light is clipped."""

_METERED_ROWS = 128  # At least so many rows are metered; of more, every second, third or so


class Exposed(NamedTuple):
    """Sensors and their exposures."""

    imagers: ImagerState
    exposure: ExposureState
    limits: NDArray[np.float64]  # Shortest and longest time [s], lowest and highest speed


class Metered(NamedTuple):
    """Pictures to meter."""

    radiance: NDArray[np.float32]
    zones: Zones
    trackers: NDArray[np.int64]
    step: NDArray[np.int64]


@compiled
def expose(work: Exposed, trackers: NDArray[np.int64], step: NDArray[np.int64]) -> None:
    """Set the exposure of the pictures of some trackers, shape (V,), steps of shape (N,)."""
    for view in range(len(trackers)):
        n = trackers[view]
        advance_exposure(work.exposure, work.imagers, work.limits, n, step[n])


@parallel
def meter(worker: int, workers: int, work: Exposed, metered: Metered) -> None:
    """Meter the pictures whose turn is this worker's, each tracker's once in an instant."""
    state, trackers = work.exposure, metered.trackers
    for view in range(worker, len(trackers), workers):
        n = trackers[view]
        now = metered.step[n]
        if state.metered[n] >= now:
            continue
        first = state.metered[n] < 0
        answer_meter(state, n, _mean_of(work, metered, view, n))
        rounds = 0
        while first and rounds < _ROUNDS and abs(state.error[n]) > 0.001:
            # Without a past: the exposure at which the camera would have arrived.
            follow_meter(state, work.imagers, work.limits, n, 1.0)
            answer_meter(state, n, _mean_of(work, metered, view, n))
            rounds += 1
        state.metered[n] = now


@kernel
def _mean_of(
    work: Exposed, metered: Metered, view: int, n: int
) -> tuple[float, float, float, float]:
    """Return the weighted mean of a picture, 1 at saturation, and those of its channels."""
    radiance, zones = metered.radiance, metered.zones
    height, width = radiance.shape[2], radiance.shape[3]
    exposed = work.exposure.time[n] * gain_of(work.imagers, work.exposure, n)
    scale = f4(exposed * work.imagers.white[n] / work.imagers.full_well[n])
    one, none = f4(1.0), splat(f4(0.0))
    total, red, green, blue, weights = none, none, none, none, none
    for row in range(0, height, max(height // _METERED_ROWS, 1)):
        for eighth in range(len(zones.columns) // WIDTH):
            at = (3 * view * height + row) * width + min(eighth * WIDTH, width - WIDTH)
            weight = load(zones.columns, eighth * WIDTH) * zones.rows[row]
            r = load(radiance, at) * scale
            g = load(radiance, at + height * width) * scale
            b = load(radiance, at + 2 * height * width) * scale
            grey = f4(0.2126) * r + f4(0.7152) * g + f4(0.0722) * b
            total += weight * lesser(grey, one)
            red += weight * lesser(r, one)
            green += weight * lesser(g, one)
            blue += weight * lesser(b, one)
            weights += weight
    whole = _sum_of(weights)
    return (
        _sum_of(total) / whole,
        _sum_of(red) / whole,
        _sum_of(green) / whole,
        _sum_of(blue) / whole,
    )


@kernel(inline=True)
def _sum_of(lanes: float) -> float:
    total = 0.0
    for k in range(WIDTH):
        total += lane(lanes, k)
    return total
