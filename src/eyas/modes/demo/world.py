"""Builds the world of the demo: a map's traffic, thinned out as wished, and a parked car."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.modes.demo.parked import COLOUR, parked_car
from eyas.settings.config import EyasConfig
from eyas.sim.assets import Assets, load_assets
from eyas.sim.config import SimConfig
from eyas.sim.crowd import Crowd, crowd_of
from eyas.sim.simulation import Simulation
from eyas.sim.worlds import together
from eyas.state.motion import joined
from eyas.targets.catalogue import kind_index, models_of
from eyas.targets.rig import Rigs
from eyas.targets.vehicles.kinds import VEHICLE_KINDS
from eyas.trackers.kinds import tracker_of
from eyas.traffic.config import VehicleType
from eyas.traffic.replay import Replay

__all__ = ["DemoSimulation", "DemoWorld", "build_world"]

_CAR = kind_index(VehicleType.PASSENGER)


class DemoSimulation(Simulation):
    """A simulation whose parked car has the look of the original's."""

    def __init__(self, config: SimConfig, assets: Assets, parked: int) -> None:
        super().__init__(config, assets, tracker_of(config.tracker), together(1))
        self._parked = parked

    def reset(self, trackers: None = None) -> None:  # type: ignore[override]
        """Begin a new episode; see `Simulation.reset`."""
        super().reset(trackers)
        if self._parked >= 0:
            self._worlds.dress(0, self._parked, models_of(_CAR).start, COLOUR)


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
    crowd = crowd_of(config, trackers=1)
    assets = load_assets(config.world, config.traffic, crowd=crowd)
    motion = assets.traffic.motion
    driven = np.isin(motion.kind, [kind_index(kind.name) for kind in VEHICLE_KINDS])
    kept = ~driven | (np.cumsum(driven) <= vehicles)
    whole = motion._replace(table=motion.table[:, kept], kind=motion.kind[kept])
    targets, parked = _followed(crowd, whole.kind, driven[kept]), -1
    if crowd.follows_vehicles:
        car = parked_car(assets, len(motion.table), motion.rate)
        if car is not None:
            parked = len(whole.kind)
            whole, targets = joined([whole, car]), np.append(targets, True)
    traffic = Replay(whole._replace(table=np.ascontiguousarray(whole.table)), targets)
    own = replace(assets, traffic=traffic, rigs=Rigs(whole.kind))
    return DemoWorld(DemoSimulation(config, own, parked), own, parked)


def _followed(
    crowd: Crowd, kinds: NDArray[np.int32], driven: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return which actors an episode may choose as its target, shape (A,)."""
    if crowd.follows_vehicles:
        return driven
    if crowd.custom is not None:
        return ~driven
    asked: NDArray[np.bool_] = kinds == kind_index(crowd.target.value)
    return asked
