"""The seed of a run whose `env_config.json` asks for another world each time (`fixed_seed`)."""

import logging

from eyas.core.config import updated
from eyas.core.errors import MissingExtraError
from eyas.core.rng import TEST_SEEDS, fresh_seed
from eyas.settings.config import EyasConfig

__all__ = ["of_a_run"]

_LOG = logging.getLogger("eyas")


def of_a_run(config: EyasConfig, seed: int | None = None) -> EyasConfig:
    """Return the settings of one run: with a seed, and with traffic of it, where the original's
    file leaves them open.

    With `fixed_seed` false, targets, looks and starts follow a seed that is drawn, and with
    `rou_update` true the traffic does, too, where SUMO can record it. A seed that is given repeats
    the run. Other settings are returned as they are.

    Args:
        config: The settings.
        seed: The seed, if the settings have none; None: it is drawn, and a line names it.
    """
    if config.original is None or config.traffic.seed is not None:
        return config
    if "seed" in config.model_fields_set:
        seed = config.seed
    elif seed is None:
        seed = fresh_seed()
        _LOG.info(
            "fixed_seed is false: the seed of this run is %d; --seed %d repeats it", seed, seed
        )
    changes: dict[str, object] = {"seed": seed}
    if config.traffic.update_routes and config.traffic.recording is None and _sumo():
        changes["traffic"] = {"seed": seed % TEST_SEEDS}
    return updated(config, changes)


def _sumo() -> bool:
    """Return whether SUMO is installed."""
    from eyas.traffic.sumo_install import sumo_binary

    try:
        sumo_binary("netconvert")
    except MissingExtraError:
        _LOG.info("rou_update is true, but without SUMO the traffic is a recording that ships")
        return False
    return True
