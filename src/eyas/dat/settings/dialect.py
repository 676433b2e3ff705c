"""The original's `env_config.json` as a dialect of the settings, and what it leaves open for a run:
its seed (`fixed_seed`), and the time before the first episode, which grows with the trackers.
"""

import logging
import random
from pathlib import Path
from typing import Any

from eyas.dat.settings.adapter import (
    check_original,
    from_original,
    is_original,
    original_key_of,
    save_original,
    to_original,
    with_original,
)
from eyas.dat.settings.layout import CUSTOM, own_target_folders, with_own_target
from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.config import updated
from eyas.engine.core.errors import DataFileError, MissingExtraError
from eyas.engine.core.rng import TEST_SEEDS, fresh_seed
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import Nested
from eyas.engine.traffic.config import Source

_LOG = logging.getLogger("eyas")


def of_a_run(config: EyasConfig, seed: int | None = None) -> EyasConfig:
    """Return the settings of one run: with a seed, and with traffic of it, where the original's
    file leaves them open.

    With `fixed_seed` false, targets, looks and starts follow a seed that is drawn, and with
    `rou_update` true the traffic does, too: SUMO records it anew, and without SUMO the run begins
    somewhere in the recording that ships. A seed that is given repeats the run. Other settings are
    returned as they are.

    Args:
        seed: The seed, if the settings have none; None: it is drawn, and a line names it.
    """
    if config.original is None or config.traffic.seed is not None:
        return config
    traffic = config.traffic
    recorded = traffic.recording is None and traffic.source is Source.RECORDED
    varied = traffic.update_routes and recorded
    if "seed" in config.model_fields_set:
        seed = config.seed
    elif seed is None:
        seed = fresh_seed()
        anew = ", and SUMO records its traffic, anew at each start" * (varied and _sumo())
        _LOG.info(
            "fixed_seed is false: the seed of this run is %d%s; --seed %d repeats it",
            *(seed, anew, seed),
        )
    changes: dict[str, object] = {"seed": seed}
    if varied:
        changes |= {"traffic": {"seed": seed % TEST_SEEDS}} if _sumo() else _later(config, seed)
    return updated(config, changes)


def _later(config: EyasConfig, seed: int) -> dict[str, object]:
    """Return changes by which a run begins later in the recording that ships, at a whole second.

    With the seed of that recording, they are not applied twice.
    """
    from eyas.engine.traffic.library import CANONICAL_SEED, STANDARD_DURATION

    video, first = config.video, config.start.warm_up_steps
    flown = first + config.done.total_steps + video.warm_up_steps
    needed = max(video.start_time + video.total_time, flown / PHYSICS_RATE)
    room = int(STANDARD_DURATION - needed) if video.episode_frames is None else 0
    seconds = random.Random(seed).randrange(max(room, 1))
    return {
        "traffic": {"seed": CANONICAL_SEED},
        "start": {"warm_up_steps": first + seconds * PHYSICS_RATE},
        "video": {"start_time": video.start_time + seconds},
    }


def _sumo() -> bool:
    """Return whether SUMO is installed."""
    from eyas.engine.traffic.sumo_install import sumo_binary

    try:
        sumo_binary("netconvert")
    except MissingExtraError:
        _LOG.info("rou_update is true, but without SUMO the run begins somewhere in a recording")
        return False
    return True


CHANNEL_STEPS = 4  # Steps for each channel of a recording [2 ms]

AGENT_STEPS = 6  # Steps for each agent of a training [2 ms]


def started_later(config: EyasConfig, steps: int) -> EyasConfig:
    """Return settings by which the first episode begins some steps of 2 ms later, as with the
    original, if they come from its file; native ones state the whole time.
    """
    if config.original is None:
        return config
    later = config.start.warm_up_steps + steps
    start = config.start.model_copy(update={"warm_up_steps": later})
    return config.model_copy(update={"start": start})


_CLIENT_KEY = "Benchmark"  # the one group of the `config.json` of the original's client


class _Dat:
    """See `Dialect`."""

    file = "env_config.json"

    def is_spoken(self, values: Nested) -> bool:
        return is_original(dict(values))

    def read(self, values: Nested, path: Path) -> EyasConfig:
        if _CLIENT_KEY in values:
            raise DataFileError(
                f"{path}: the settings of the original's client, not of its simulator; give its "
                "Webots_Simulation/traffic_project/config/env_config.json (the speeds of actions "
                "are env.speeds here)"
            )
        keys, own = with_own_target(dict(values), own_target_folders(path))
        return _with_custom(from_original(keys), own)

    def changed(self, config: EyasConfig, changes: Nested, path: Path | None) -> EyasConfig:
        keys, own = with_own_target(dict(changes), own_target_folders(path))
        return _with_custom(with_original(config, keys), own)

    def check(self, config: EyasConfig) -> None:
        check_original(config)

    def key_of(self, path: str) -> str:
        return original_key_of(path)

    def save(self, config: EyasConfig, path: Path) -> bool:
        return save_original(config, path)

    def content_of(self, config: EyasConfig) -> dict[str, Any]:
        return to_original(config)

    def of_a_run(self, config: EyasConfig, seed: int | None = None) -> EyasConfig:
        return of_a_run(config, seed)

    def started(self, config: EyasConfig, channels: int) -> EyasConfig:
        return started_later(config, CHANNEL_STEPS * channels)


def _with_custom(config: EyasConfig, custom: dict[str, Any] | None) -> EyasConfig:
    return config if custom is None else updated(config, {CUSTOM: custom})


DAT = _Dat()
