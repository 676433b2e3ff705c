"""The learning algorithms by name: what `train.method` chooses from."""

from collections.abc import Callable
from typing import Any

from eyas.engine.core.registry import Registry

SETTING = "train.method"

ALGORITHMS: Registry[Callable[..., Any]] = Registry(
    SETTING,
    Callable,  # type: ignore[arg-type]  # a protocol of the standard library
    {
        "ppo": "eyas.learning.ppo:Ppo",
        "dagger": "eyas.learning.dagger:Dagger",
        "tracker": "eyas.learning.tracking.training:train",
        "words": "eyas.learning.words.training:train",
    },
    group="eyas.algorithms",
)
"""Each is a subclass of `Algorithm`, which learns from rollouts, or a function that does a whole
run with networks and data of its own: `train(config, folder, *, resume, say) -> Path`."""
