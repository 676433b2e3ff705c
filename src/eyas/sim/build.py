"""The one place where the rooms are joined."""

import logging

from eyas.sim.config import SimConfig
from eyas.sim.place import load_place
from eyas.sim.simulation import Simulation
from eyas.sim.supported import require_parts

__all__ = ["build_simulation"]

_LOG = logging.getLogger("eyas")


def build_simulation(config: SimConfig, count: int, *, shared_world: bool) -> Simulation:
    """Return a simulation; call its `reset` first.

    Args:
        config: The settings.
        count: Number of trackers.
        shared_world: One world and one time for all trackers, each with a target of its own, or an
            independent world for each.

    Raises:
        EyasError: A setting is not supported, or there is no traffic for it.
    """
    require_parts(config)
    if config.light.visibility is not None and config.world.weather != "foggy":
        _LOG.warning(
            "light.visibility (Env_Params.foggy_use_default): without effect in the weather '%s'; "
            "only 'foggy' has fog",
            config.world.weather,
        )
    place = load_place(config.world, config.traffic, count)
    return Simulation(config, place, count, shared_world=shared_world)
