"""The time before the first episode, which grows with the trackers in the original's program."""

from eyas.engine.settings.config import EyasConfig

__all__ = ["AGENT_STEPS", "CHANNEL_STEPS", "started_later"]

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
