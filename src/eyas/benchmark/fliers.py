"""Who flies the batches of a plan: this process, or the processes of Ray, imported here only."""

import logging
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from eyas.benchmark.episode import EpisodeSpec
from eyas.benchmark.plan import EvaluationPlan, Stamp, fly_batch, stamp
from eyas.benchmark.record import EpisodeRecord
from eyas.engine.core.errors import ConfigError, EyasError, MissingExtraError
from eyas.lanes import limit_threads

__all__ = ["Flier", "connected", "flown", "fly_here", "on_ray", "one_line"]


@contextmanager
def connected() -> Iterator[Any]:
    """Yield the module `ray`, connected to the cluster that `ray.init()` finds, or to a local one
    that lasts as long as the block.

    Raises:
        MissingExtraError: Ray is not installed.
        EyasError: There is no cluster at the address that the environment tells.
    """
    try:
        import ray
    except ImportError as error:
        raise MissingExtraError("--ray", "cluster") from error
    begun = not ray.is_initialized()
    if begun:
        _begin(ray)
    try:
        yield ray
    finally:
        if begun:
            ray.shutdown()


def _begin(ray: Any) -> None:  # noqa: ANN401  # a module
    main = threading.current_thread() is threading.main_thread()
    handler = signal.getsignal(signal.SIGTERM)
    try:
        ray.init()
    except Exception as error:  # Ray has no base for what can go wrong here
        raise EyasError(f"--ray: {one_line(error)}") from error
    if main:  # Ray's handler ends the process without a word
        signal.signal(signal.SIGTERM, handler)


def one_line(error: Exception) -> str:
    """Return the text of an error of Ray, which can have many lines."""
    return " ".join(str(error).split())[:500]


Flier = Callable[
    [EvaluationPlan, list[list[EpisodeSpec]], list[float]], Iterator[list[EpisodeRecord]]
]
"""Yields the records of batches, in any order, but those of a batch one after the other. It adds
to the last argument how long each call of the policy has taken [s], if this machine has made it."""


def fly_here(
    plan: EvaluationPlan, parts: list[list[EpisodeSpec]], answers: list[float]
) -> Iterator[list[EpisodeRecord]]:
    """Fly batches in this process; a record is there as soon as its episode ends."""
    for part in parts:
        yield from fly_batch(plan, part, answers)


def flown(made: Stamp, part: list[EpisodeSpec]) -> list[EpisodeRecord]:
    """Return the records of a batch: the same on every machine, however often it is flown.

    Raises:
        ConfigError: This machine has another build of Eyas, or another or no file of the policy.
        EyasError: The policy cannot be loaded here.
    """
    try:
        here = stamp(made.plan)
    except OSError as error:
        raise ConfigError(f"{made.plan.policy}: cannot read on a worker: {error}") from None
    if differs := made.other_build(here):
        raise ConfigError(f"a worker has another build of Eyas, which differs in {differs}")
    if here.policy != made.policy:
        raise ConfigError(f"a worker has another policy: {here.policy}, not {made.policy}")
    return [record for ended in fly_batch(made.plan, part) for record in ended]


_LOG = logging.getLogger("eyas")

_RETRIES = 3
"""How often a batch is flown again whose process was lost; one that always ends its process, by a
fault in a policy's native code, must not do so for ever."""


@contextmanager
def on_ray() -> Iterator[Flier]:
    """Yield what flies batches on Ray, see `connected` for where and for errors."""
    with connected() as ray:
        yield lambda plan, parts, _: _fly(ray, plan, parts)


def _fly(
    ray: Any,  # noqa: ANN401  # a module
    plan: EvaluationPlan,
    parts: list[list[EpisodeSpec]],
) -> Iterator[list[EpisodeRecord]]:
    """Yield the records of batches as they are done."""
    cores = int(ray.cluster_resources().get("CPU", 1))
    if len(parts) < cores and any(len(part) > 1 for part in parts):
        _LOG.warning(
            "%d batches for %d cores: a smaller --batch lets more of them fly", len(parts), cores
        )
    made = stamp(_with_whole_paths(plan))
    task = ray.remote(num_cpus=1, max_retries=_RETRIES)(_flown_by_one)
    waiting = [task.remote(made, part) for part in parts]
    try:
        while waiting:
            done, waiting = ray.wait(waiting)
            try:
                yield ray.get(done[0])
            except ray.exceptions.RayTaskError as error:
                raise getattr(error, "cause", error) from None
            except ray.exceptions.RayError as error:
                raise EyasError(f"--ray: a batch was lost: {one_line(error)}") from error
    finally:
        for task in waiting:
            ray.cancel(task, force=True)


def _flown_by_one(made: Stamp, part: list[EpisodeSpec]) -> list[EpisodeRecord]:
    """Return the records of a batch, flown by the one core that Ray has given this process."""
    limit_threads(1)
    try:
        return flown(made, part)
    except EyasError as error:
        raise EyasError(str(error)) from None  # one that can be pickled


def _with_whole_paths(plan: EvaluationPlan) -> EvaluationPlan:
    """Return a plan whose files are found from any folder."""
    told = {"policy": plan.policy, "latency": plan.latency}
    whole = {name: str(Path(text).resolve()) for name, text in told.items() if Path(text).is_file()}
    return plan.model_copy(update=whole)
