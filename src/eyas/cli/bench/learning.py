"""Learning in `eyas bench`: where the processor's time of a run with the preset `fast` goes."""

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import wraps
from typing import Any

from eyas.cli.bench.measurement import Measurement
from eyas.engine.core.config import updated
from eyas.engine.core.scratch import scratch
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import preset_file
from eyas.learning.algorithm import Algorithm
from eyas.learning.config import TrainConfig
from eyas.learning.dagger import Dagger
from eyas.learning.network import TrackingNetwork
from eyas.learning.rollout import Roller, Teacher
from eyas.learning.trainer import train

Method = tuple[type, str]  # A class, and the name of a method of it

_WHOLE: tuple[Method, ...] = ((Roller, "roll"), (Dagger, "update"))
"""All that is done for a decision."""

_PARTS: dict[str, Method] = {
    "environments": (EyasVectorEnv, "step"),
    "teacher": (Teacher, "lesson"),
    "network in flight": (TrackingNetwork, "forward"),
    "learning": (Algorithm, "descend"),
}
"""Parts of it, by the methods in which they are done; the rest is Python."""


def measure_learning(
    updates: int,  # Updates of the network, of 2,048 decisions each
) -> Measurement:
    """Return the speed of learning, and the shares of its parts in the processor's time."""
    config = load_settings(preset_file("fast"))
    decisions = updates * TrainConfig.of(config).update_decisions
    config = updated(config, {"train": {"stages": [{"total_timesteps": decisions}]}})
    whole, spent = _Spent(), {name: _Spent() for name in _PARTS}
    with scratch() as folder, ExitStack() as stack:
        for owner, method in _WHOLE:
            stack.enter_context(whole.of(owner, method))
        for name, (owner, method) in _PARTS.items():
            stack.enter_context(spent[name].of(owner, method))
        train(config, folder / "run", say=lambda _: None)
    shares = {name: each.cpu / whole.cpu for name, each in spent.items()}
    shares["Python"] = 1.0 - sum(shares.values())
    includes = ", ".join(f"{name} {share:.0%}" for name, share in shares.items())
    rate, cpu = decisions / whole.wall, 1e6 * whole.cpu / decisions
    return Measurement("learning, preset fast", rate, "decisions/s", includes, updates, cpu)


class _Spent:
    """Time spent in calls of some methods [s]."""

    def __init__(self) -> None:
        self.wall = self.cpu = 0.0

    @contextmanager
    def of(self, owner: type, name: str) -> Iterator[None]:
        """Count the calls of a method."""
        method: Callable[..., Any] = getattr(owner, name)

        @wraps(method)
        def counted(*args: object, **options: object) -> Any:  # noqa: ANN401  # as the method
            wall, cpu = time.perf_counter(), time.process_time()
            try:
                return method(*args, **options)
            finally:
                self.wall += time.perf_counter() - wall
                self.cpu += time.process_time() - cpu

        setattr(owner, name, counted)
        try:
            yield
        finally:
            setattr(owner, name, method)
