"""Builds a simulation from its settings."""

import logging
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.evader import EvaderDriver, EvaderSight
from eyas.engine.sim.assets import Assets, load_assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.crowd import crowd_of
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.urban_wind import wind_field
from eyas.engine.sim.worlds import ALONE, largest_world
from eyas.engine.trackers.config import TrackerConfig
from eyas.engine.trackers.kinds import tracker_of
from eyas.engine.trackers.tracker import Tracker

_LOG = logging.getLogger("eyas")


def build_simulation(
    config: SimConfig, world_of: NDArray[np.integer], *, tracker: Tracker | None = None
) -> Simulation:
    """Return a simulation; call its `reset` before anything else.

    Args:
        config: The settings.
        world_of: Number of the world of each tracker, shape (N,): `each_alone(N)`, `together(N)`,
            or other numbers; see `eyas.engine.sim.worlds.Worlds`.
        tracker: A tracker in the place of the kind in `tracker.kind`.

    Raises:
        EyasError: A setting is not supported, or no traffic matches the settings.
    """
    assets = assets_of(config, world_of)
    chosen = tracker_in(config, assets) if tracker is None else tracker
    return Simulation(config, assets, chosen, world_of)


def assets_of(config: SimConfig, world_of: NDArray[np.integer]) -> Assets:
    """Return map, traffic and renderer of a simulation; see `build_simulation`."""
    trackers = largest_world(world_of)
    goes_on = bool((np.asarray(world_of) != ALONE).any())
    crowd = crowd_of(config, trackers if goes_on else 0)
    evader = config.evader
    bodies = evader.driver is EvaderDriver.AGENT and evader.sees is EvaderSight.PICTURE
    assets = load_assets(config.world, config.traffic, trackers, crowd, bodies=bodies)
    if config.light.visibility is not None and not assets.lighting.foggy:
        _LOG.warning(
            "light.visibility (Env_Params.foggy_use_default): without effect in the weather '%s', "
            "which has no fog",
            config.world.weather,
        )
    return assets


def tracker_in(config: SimConfig, assets: Assets) -> Tracker:
    """Return the kind of tracker of some settings, in the wind of the map that it flies over."""
    own = in_one_wind(config)
    made = tracker_of(own)
    if not own.wind.buildings:
        return made
    memory: Any = made.memory  # that of a drone with equipment
    return replace(made, memory=partial(memory, field=wind_field(assets.scene)))


def in_one_wind(config: SimConfig) -> TrackerConfig:
    """Return the settings of the tracker, in the wind of the world if it is one that feels it."""
    wind, tracker = config.world.wind, config.tracker
    if wind is None or not tracker.has_drag:
        return tracker
    update = {"speed": wind.speed, "direction": wind.direction}
    return tracker.model_copy(update={"wind": tracker.wind.model_copy(update=update)})
