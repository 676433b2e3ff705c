"""What a policy sees and may do: the class of an entry, without which no two results compare."""

from enum import StrEnum

from eyas.benchmark.policies.table import PERSON
from eyas.engine.core.config import Config
from eyas.engine.policies.policy import Policy
from eyas.engine.settings.env import (
    ActionKind,
    EnvSpeeds,
    GimbalConfig,
    ObservationConfig,
    ObservationPart,
)


class EntryClass(StrEnum):
    """What a policy knows."""

    PIXELS = "pixels"  # What its camera and its own sensors show
    WORDS = "text+pixels"  # Pixels, and words or the attributes that they name
    DEPTH = "depth"  # Distances of pixels, without noise and whatever the weather
    LIDAR = "lidar"  # Distances that a lidar measures
    BOX = "box"  # Pixels, and the true box in the first picture
    HUMAN = "human"  # What a person sees in the same pictures, told as `box` and words are
    PRIVILEGED = "privileged"
    """More than a drone can know: the true state, classes of pixels, or code that flies in the
    process of the simulator, and could read it."""


_TRUTH = {ObservationPart.PRIVILEGED, ObservationPart.CLASSES}
"""Parts of observations that no sensor shows."""

_RANGES = {ObservationPart.LIDAR: EntryClass.LIDAR, ObservationPart.DEPTH: EntryClass.DEPTH}
"""Parts that measure distances, which night and fog do not dim: some drones have them."""

_WORDS = {"words", "attributes"}
"""Names of what is told in words, at the start or in each observation."""


class ResultEntry(Config):
    """What stands in a result of the policy."""

    entry_class: EntryClass
    apart: bool
    """Whether code of a user's has flown in a process of its own, see
    `eyas.benchmark.policies.sandbox`."""
    observation: ObservationConfig
    actions: ActionKind
    speeds: EnvSpeeds
    gimbal: GimbalConfig | None = None
    """How its actions turn the camera; None: they do not."""
    action_repeat: int
    latency: str


def entry_class(policy: Policy, *, beside: bool = False) -> EntryClass:
    """Return the class of a policy: of several that fit, the one that knows most."""
    parts = set(policy.env.observation.parts)
    if PERSON in policy.told:
        return EntryClass.HUMAN
    if beside or "truth" in policy.told or parts & _TRUTH:
        return EntryClass.PRIVILEGED
    for part, own in _RANGES.items():
        if part in parts:
            return own
    if "box" in policy.told:
        return EntryClass.BOX
    if _WORDS & (policy.told | {str(part) for part in parts}):
        return EntryClass.WORDS
    return EntryClass.PIXELS


def entry_of(policy: Policy, latency: str, *, apart: bool, beside: bool) -> ResultEntry:
    """Return what a result says of a policy."""
    env = policy.env
    return ResultEntry(
        entry_class=entry_class(policy, beside=beside),
        apart=apart,
        observation=env.observation,
        actions=env.actions,
        speeds=env.speeds,
        gimbal=env.gimbal if env.actions.gimbal else None,
        action_repeat=env.action_repeat,
        latency=latency,
    )
