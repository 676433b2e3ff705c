"""Learning in `eyas bench`: where the processor's time of a run with the preset `fast` goes."""

import time
from contextlib import ExitStack
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

_ALL = "all"

_METHODS: dict[tuple[type, str], str] = {
    (Roller, "roll"): _ALL,
    (Dagger, "update"): _ALL,
    (EyasVectorEnv, "step"): "environments",
    (Teacher, "lesson"): "teacher",
    (TrackingNetwork, "forward"): "network in flight",
    (Algorithm, "descend"): "learning",
}
"""Methods in which a decision is made and learned from, by the part of it; the rest is Python."""


def measure_learning(
    updates: int,  # Updates of the network, of 2,048 decisions each
) -> Measurement:
    """Return the speed of learning, and the shares of its parts in the processor's time."""
    config = load_settings(preset_file("fast"))
    decisions = updates * TrainConfig.of(config).update_decisions
    changes = {"stages": [{"total_timesteps": decisions}], "evaluation": {"every": 0}}
    config = updated(config, {"train": changes})
    wall, cpu = (dict.fromkeys(_METHODS.values(), 0.0) for _ in range(2))
    with scratch() as folder, ExitStack() as stack:
        for (owner, method), part in _METHODS.items():
            before = getattr(owner, method)
            stack.callback(setattr, owner, method, before)
            setattr(owner, method, _counted(before, part, wall, cpu))
        train(config, folder / "run", say=lambda _: None)
    shares = {part: spent / cpu[_ALL] for part, spent in cpu.items() if part != _ALL}
    shares["Python"] = max(0.0, 1.0 - sum(shares.values()))
    includes = ", ".join(f"{part} {share:.0%}" for part, share in shares.items())
    rate, spent = decisions / wall[_ALL], 1e6 * cpu[_ALL] / decisions
    return Measurement("learning, preset fast", rate, "decisions/s", includes, updates, spent)


def _counted(method: Any, part: str, wall: dict[str, float], cpu: dict[str, float]) -> Any:  # noqa: ANN401
    """Return a method whose calls add to the time of a part [s]."""

    @wraps(method)
    def counted(*args: object) -> object:
        start, on_processor = time.perf_counter(), time.process_time()
        result = method(*args)
        wall[part] += time.perf_counter() - start
        cpu[part] += time.process_time() - on_processor
        return result

    return counted
