"""Settings of a target that wants to be lost."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from eyas.engine.core.config import Config
from eyas.engine.core.named_code import NAMES_CODE

Weight = Annotated[float, Field(ge=-1e9, le=1e9)]


class EvaderDriver(StrEnum):
    """Who moves the target."""

    AGENT = "agent"  # An agent beside the tracker's
    CRUISE = "cruise"  # At the limit of the road, turns at random; on foot, straight on
    ABRUPT = "abrupt"  # The same, but brakes, dashes and turns without warning
    HIDE = "hide"  # Goes away from the tracker, and stands where nothing is seen from above


class EvaderSight(StrEnum):
    """What the agent that moves the target sees."""

    TRACKER = "tracker"  # Numbers: the tracker's place and motion, and the ways on
    PICTURE = "picture"  # The picture of a camera on its roof or at its head


class EvaderConfig(Config):
    """The target as an agent (docs/pursuit.md). It begins where a recorded one is, and in its
    place.
    """

    driver: EvaderDriver | None = None
    """Who moves the target; None: it moves as recorded. `agent`: an agent, see
    `EyasParallelEnv(agents="tracker+target")`; else one of the fixed drivers."""
    sees: EvaderSight = EvaderSight.TRACKER
    """What the agent sees: numbers, or a picture of the size of `env.observation`."""
    reward: Annotated[dict[str, Weight], NAMES_CODE] = Field(default_factory=dict)
    """Terms of the target's reward, and the factor on each, as `reward.terms`; empty: the
    tracker's reward with the opposite sign."""
