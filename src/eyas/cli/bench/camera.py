"""The cost of camera models in `eyas bench --camera`: each beside the same pictures without it."""

import statistics
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from rich.table import Table

from eyas.engine.core.config import updated
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture

_VIEWS, _SIDE = 64, 84
_TURN = (12.0, 0.0, 0.0, 1.5)  # Command while it is measured: without motion nothing is blurred

_CASES: Mapping[str, Mapping[str, Any]] = {
    "pinhole": {},
    "sensor and automatic exposure": {"imager": {}},
    "the same, by Malvar's mosaic": {"imager": {"mosaic": "malvar"}},
    "barrel lens (k1 -0.1)": {"lens": {"model": "brown", "k1": -0.1}},
    "fisheye of half a sphere": {"lens": {"model": "fisheye"}, "field_of_view": 2.2},
    "vignetting and fringes": {"lens": {"vignetting": 0.4, "red": 0.004, "blue": -0.004}},
    "blur, at most 4 instants of 20 ms": {
        "shutter": {"blur": True, "exposure": 0.02, "most_samples": 4}
    },
    "rolling shutter of 20 ms": {"shutter": {"readout": 0.02}},
    "dirt and drops": {"dirt": {"drops": 8}},
    "link, JPEG of quality 40": {"link": {}},
    "defocus of 4 pixels": {"defocus": 0.05},
    "near infrared": {"spectrum": "near-infrared"},
    "thermal": {"spectrum": "thermal"},
    "small-drone": {"model": "small-drone"},
}


@dataclass(frozen=True, slots=True)
class CameraCost:
    """What a picture costs."""

    effect: str
    microseconds: float  # Median of the processor time of a picture [us]
    ratio: float  # Over that of a pinhole's, the median of measurements side by side


def measure_camera(seconds: float) -> list[CameraCost]:
    """Return the cost of camera models, measured by turns with a pinhole.

    Args:
        seconds: Time to measure each [s].
    """
    everyone = np.arange(_VIEWS, dtype=np.int32)
    picture = Picture.create(_VIEWS, _SIDE, _SIDE)
    simulations = []
    for camera in _CASES.values():
        simulation = build_simulation(updated(SimConfig(), {"camera": camera}), each_alone(_VIEWS))
        simulation.reset()
        simulation.advance(np.tile(np.array(_TURN), (_VIEWS, 1)), 50)
        simulation.draw(everyone, picture)
        simulations.append(simulation)
    spent: list[list[float]] = [[] for _ in simulations]
    end = time.perf_counter() + seconds * len(simulations)
    while time.perf_counter() < end or len(spent[0]) < 5:
        for simulation, times in zip(simulations, spent, strict=True):
            start = time.process_time()
            simulation.draw(everyone, picture)
            times.append(time.process_time() - start)
    costs = []
    for effect, times in zip(_CASES, spent, strict=True):
        ratios = [own / plain for own, plain in zip(times, spent[0], strict=True)]
        own = 1e6 * statistics.median(times) / _VIEWS
        costs.append(CameraCost(effect, own, statistics.median(ratios)))
    return costs


def camera_table(costs: list[CameraCost]) -> Table:
    """Return the costs as a table."""
    title = f"processor time of a picture of {_SIDE}x{_SIDE}, {_VIEWS} at once, in a turn"
    table = Table(title=title, title_justify="left")
    table.add_column("camera")
    table.add_column("us", justify="right")
    table.add_column("of a pinhole's", justify="right")
    for cost in costs:
        table.add_row(cost.effect, f"{cost.microseconds:,.0f}", f"{cost.ratio:.2f}")
    return table
