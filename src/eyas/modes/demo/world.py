"""Builds the world of the demo: a map's traffic, thinned out as wished, and a parked car."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from eyas.modes.demo.parked import COLOUR, MODEL, parked_car
from eyas.settings.config import EyasConfig
from eyas.sim.assets import Assets, load_assets
from eyas.sim.build import TRACKERS
from eyas.sim.config import SimConfig
from eyas.sim.simulation import Simulation
from eyas.sim.supported import require_parts
from eyas.sim.worlds import together
from eyas.state.motion import Motion, joined
from eyas.targets.catalogue import model_index
from eyas.targets.rig import Rigs
from eyas.traffic.replay import Replay

__all__ = ["DemoSimulation", "DemoWorld", "build_world"]


class DemoSimulation(Simulation):
    """A simulation whose parked car has the look of the original's."""

    def __init__(self, config: SimConfig, assets: Assets, parked: int) -> None:
        super().__init__(config, assets, TRACKERS[config.tracker.kind], together(1))
        self._parked = parked

    def reset(self, trackers: None = None) -> None:  # type: ignore[override]
        """Begin a new episode; see `Simulation.reset`."""
        super().reset(trackers)
        if self._parked >= 0:
            self._worlds.dress(0, self._parked, model_index(MODEL), COLOUR)


class DemoWorld(NamedTuple):
    """One drone in one world."""

    simulation: Simulation
    assets: Assets
    parked: int
    """Actor that is the parked car; -1: there is none."""


def build_world(config: EyasConfig, vehicles: int) -> DemoWorld:
    """Return the world of a configuration.

    Args:
        config: The settings.
        vehicles: Largest number of vehicles that drive.

    Raises:
        EyasError: A setting is not supported, or no traffic matches the settings.
    """
    require_parts(config)
    assets = load_assets(config.world, config.traffic)
    motion = assets.traffic.motion
    driving = Motion(motion.table[:, :vehicles], motion.kind[:vehicles], motion.rate, 0.0)
    car = parked_car(assets, len(motion.table), motion.rate)
    parked = -1 if car is None else len(driving.kind)
    whole = driving if car is None else joined([driving, car])
    table = np.ascontiguousarray(whole.table)
    traffic = Replay(whole._replace(table=table))
    own = replace(assets, traffic=traffic, rigs=Rigs(whole.kind))
    return DemoWorld(DemoSimulation(config, own, parked), own, parked)
