"""Flies the batches of a plan: in this process, or in those of Ray, which is imported here only."""

import logging
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.flight.batch_flight import BatchFlight, Watcher
from eyas.benchmark.plan.latency import Measured, delay_from
from eyas.benchmark.plan.plan import EvaluationPlan, Stamp, opened, stamp
from eyas.benchmark.policies.person import RecordedPeople
from eyas.benchmark.policies.road_search import sighted
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.records.record import EpisodeRecord
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.errors import ConfigError, EyasError, MissingExtraError
from eyas.engine.core.identity.build import this_build
from eyas.engine.policies.policy import Policy
from eyas.lanes import limit_threads

Ray = Any  # the module, which has no types


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


def _begin(ray: Ray) -> None:
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


Runner = Callable[
    [EvaluationPlan, list[list[EpisodeSpec]], list[float]], Iterator[list[EpisodeRecord]]
]
"""Yields the records of batches, in any order, but those of a batch one after the other. It adds
to the last argument how long each call of the policy has taken [s], if this machine has made it."""


def fly_batch(
    plan: EvaluationPlan,
    episodes: list[EpisodeSpec],
    answers: list[float] | None = None,  # Gets how long each call of the policy has taken [s]
    watcher: Watcher | None = None,
    policy: Policy | None = None,  # Flies in the place of the plan's: a person at the controls
) -> Iterator[list[EpisodeRecord]]:
    """Yield the records of a batch, whenever some of its episodes end.

    Raises:
        EyasError: The policy cannot be loaded, or a setting is not supported.
    """
    delay = delay_from(plan.latency)
    assert len(episodes) == 1 or not isinstance(delay, Measured)
    if policy is None:
        policy, _ = opened(plan)
    if isinstance(policy, RecordedPeople):
        policy.choose([episode.name for episode in episodes])
    flight = BatchFlight(episodes, plan.rules, policy, delay)
    solved = solvable(episodes, plan.rules)
    told = {episode.name: can for episode, can in zip(episodes, solved, strict=True)}
    for ended in flight.fly(watcher):
        yield [each.model_copy(update={"solvable": told[each.name]}) for each in ended]
    if answers is not None:
        answers += flight.answers


def run_here(
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
def on_ray() -> Iterator[Runner]:
    """Yield what flies batches on Ray, see `connected` for where and for errors."""
    with connected() as ray:
        yield lambda plan, parts, _: _fly(ray, plan, parts)


def _fly(
    ray: Ray, plan: EvaluationPlan, parts: list[list[EpisodeSpec]]
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


SOLVED = 0.95  # TSR from which `sighted` has solved an episode


def solvable(episodes: list[EpisodeSpec], protocol: Protocol) -> list[bool | None]:
    """Return whether `sighted` solves each episode; None: the protocol does not ask.

    Kept in the cache, since it depends on the episodes only.
    """
    if not protocol.tells_solvable:
        return [None] * len(episodes)
    make = partial(_kept_shares, episodes, protocol)
    inputs = (this_build().world, protocol.hash, *episodes)
    shares = np.asarray(cached(EntryKind.OCCLUSION, make, inputs, of=np.ndarray))
    return [bool(share >= SOLVED) for share in shares.tolist()]


def _kept_shares(episodes: list[EpisodeSpec], protocol: Protocol) -> NDArray[np.float64]:
    """Return the TSR of `sighted` in each episode, shape (E,)."""
    flight = BatchFlight(episodes, protocol, sighted(protocol.oracles), delay_from("0"))
    kept = {record.name: record.tsr for ended in flight.fly() for record in ended}
    return np.array([kept[episode.name] for episode in episodes])
