"""The shards of a rollout, in threads or in processes of Ray: where they run changes no byte."""

import logging
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, Protocol, TypeVar

import numpy as np
import torch

from eyas.benchmark.flight.policy_runner import connected, one_line
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.settings.config import EyasConfig
from eyas.lanes import limit_threads
from eyas.learning.config import TrainConfig
from eyas.learning.network import AnyNetwork, NetworkShape, network_of
from eyas.learning.rollout import Finished, Roller, Rollout

Job = TypeVar("Job")
Result = TypeVar("Result")


class TorchThreads:
    """Threads, in each of which PyTorch uses no more threads of its own.

    PyTorch's threads would keep the renderer's from the processors while they wait, and results
    would depend on their number.
    """

    def __init__(self, threads: int) -> None:
        torch.set_num_threads(1)
        self._threads = ThreadPoolExecutor(threads, "eyas-learning")

    def each(self, do: Callable[[Job], Result], jobs: Iterable[Job]) -> list[Result]:
        """Return what `do` gives for each job, in their order."""
        return list(self._threads.map(do, jobs))


class Shards(Protocol):
    """All environments of a stage."""

    def begin(self, streams: Sequence[np.random.Generator]) -> None:
        """Begin new episodes, each shard with random numbers of its own."""

    def roll(self, guided: float | None = None) -> Rollout:
        """Return what the environments do next with the network as it is now; the arrays are
        overwritten by the next call. `guided`: see `Roller.roll`.
        """

    def finished(self) -> list[Finished]:
        """Return what each shard has finished since `begin`."""

    def close(self) -> None:
        """Give back what the environments hold."""


MakeShards = Callable[[EyasConfig, AnyNetwork], Shards]
"""Makes the environments for the settings of a stage, and for the network that flies."""


class LocalShards:
    """Shards in threads of this process."""

    def __init__(self, config: EyasConfig, network: AnyNetwork) -> None:
        self._rollers = [Roller(config, network) for _ in range(TrainConfig.of(config).shards)]
        self._threads = TorchThreads(TrainConfig.of(config).shards)

    def begin(self, streams: Sequence[np.random.Generator]) -> None:
        """See `Shards.begin`."""
        for roller, own in zip(self._rollers, streams, strict=True):
            roller.begin(own)

    def roll(self, guided: float | None = None) -> Rollout:
        """See `Shards.roll`."""
        return Rollout.joined(self._threads.each(lambda own: own.roll(guided), self._rollers))

    def finished(self) -> list[Finished]:
        """See `Shards.finished`."""
        return [roller.finished for roller in self._rollers]

    def close(self) -> None:
        """See `Shards.close`."""
        for roller in self._rollers:
            roller.env.close()


_LOG = logging.getLogger("eyas")

_RETRIES = 3
"""How often a shard is begun anew in a block; one that always ends its process must not do so for
ever."""

Weights = dict[str, np.ndarray]


@contextmanager
def on_ray() -> Iterator[MakeShards]:
    """Yield what makes shards on Ray, see `connected` for where and for errors."""
    with connected() as ray:
        yield lambda config, network: RayShards(ray, config, network)


class RayShards:
    """Shards in processes of one core each.

    The processes get the weights before each rollout. A process that is lost is replaced: the new
    one begins the block anew and repeats its rollouts with the weights that they were made with,
    so nothing is lost and no byte differs.

    Raises:
        ConfigError: The cluster has fewer cores than there are shards.
    """

    def __init__(self, ray: Any, config: EyasConfig, network: AnyNetwork) -> None:  # noqa: ANN401
        _check_cores(int(ray.cluster_resources().get("CPU", 0)), TrainConfig.of(config).shards)
        self._ray, self._config, self._network = ray, config, network
        self._worker = ray.remote(num_cpus=1)(_Worker)
        self._workers = [self._started() for _ in range(TrainConfig.of(config).shards)]
        self._streams: Sequence[np.random.Generator] = ()
        self._rolls: list[tuple[Any, float | None]] = []  # weights and `guided`, since it began
        self._finished = [Finished() for _ in self._workers]
        self._lost = [0 for _ in self._workers]

    def begin(self, streams: Sequence[np.random.Generator]) -> None:
        """See `Shards.begin`."""
        self._streams, self._rolls = streams, []
        self._lost = [0 for _ in self._workers]
        for worker, own in zip(self._workers, streams, strict=True):
            worker.begin.remote(own)

    def roll(self, guided: float | None = None) -> Rollout:
        """See `Shards.roll`."""
        state = self._network.state_dict()
        weights = self._ray.put({name: each.numpy() for name, each in state.items()})
        self._rolls.append((weights, guided))
        rolling = [worker.roll.remote(*self._rolls[-1]) for worker in self._workers]
        rolled = [self._got(number, each) for number, each in enumerate(rolling)]
        self._finished = [finished for _, finished in rolled]
        return Rollout.joined([rollout for rollout, _ in rolled])

    def finished(self) -> list[Finished]:
        """See `Shards.finished`."""
        return self._finished

    def close(self) -> None:
        """See `Shards.close`."""
        for worker in self._workers:
            self._ray.kill(worker)

    def _started(self) -> Any:  # noqa: ANN401  # an actor
        return self._worker.remote(self._config, self._network.shape)

    def _got(self, number: int, rolling: Any) -> tuple[Rollout, Finished]:  # noqa: ANN401
        """Return what a shard gives, if need be from a new process."""
        errors = self._ray.exceptions
        while True:
            try:
                rolled: tuple[Rollout, Finished] = self._ray.get(rolling)
                return rolled
            except errors.RayTaskError as error:
                raise getattr(error, "cause", error) from None
            except errors.RayError as error:
                self._lost[number] += 1
                if self._lost[number] > _RETRIES:
                    raise EyasError(f"--ray: a shard was lost: {one_line(error)}") from error
                _LOG.warning("shard %d was lost; its block begins anew elsewhere", number)
                rolling = self._begun_anew(number)

    def _begun_anew(self, number: int) -> Any:  # noqa: ANN401  # what Ray will give
        """Return the last rollout of a shard, made once more."""
        worker = self._workers[number] = self._started()
        worker.begin.remote(self._streams[number])
        return [worker.roll.remote(*each) for each in self._rolls][-1]


class _Worker:
    """A shard in a process of its own."""

    def __init__(self, config: EyasConfig, shape: NetworkShape) -> None:
        limit_threads(1)
        torch.set_num_threads(1)
        self._config = config
        self._network = network_of(shape, TrainConfig.of(config))
        self._roller: Roller | None = None
        self._streams: np.random.Generator | None = None

    def begin(self, streams: np.random.Generator) -> None:
        self._streams = streams

    def roll(self, weights: Weights, guided: float | None) -> tuple[Rollout, Finished]:
        state = {name: torch.from_numpy(each.copy()) for name, each in weights.items()}
        self._network.load_state_dict(state)
        try:
            roller = self._ready()
        except EyasError as error:
            raise EyasError(str(error)) from None  # one that can be pickled
        return roller.roll(guided), roller.finished

    def _ready(self) -> Roller:
        """Return the environments, which begin here: nobody waits for the answer of `begin`, so an
        error there would be lost.
        """
        self._roller = self._roller or Roller(self._config, self._network)
        if self._streams is not None:
            self._roller.begin(self._streams)
            self._streams = None
        return self._roller


def _check_cores(cores: int, shards: int) -> None:
    if shards > cores:
        raise ConfigError(
            f"train.shards: {shards} need as many cores; the cluster of Ray has {cores}"
        )
    if shards == 1 and cores > 1:
        _LOG.warning(
            "train.shards is 1, so all environments share one of the cluster's %d cores", cores
        )
