"""A learning algorithm: what becomes of a network by one rollout after the other."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

from eyas.engine.core.config import Config, validated
from eyas.engine.core.errors import ConfigError, MissingExtraError
from eyas.learning.config import ALGORITHMS, SETTING, TrainConfig

try:
    import torch
    from torch import Tensor, nn
except ImportError as error:
    raise MissingExtraError("eyas.Algorithm", "train") from error

from eyas.learning.network import ACTIONS, AnyNetwork

if TYPE_CHECKING:  # rollouts ask here whether a teacher is wanted
    from eyas.learning.rollout import Rollout
    from eyas.learning.shards import TorchThreads


@dataclass
class Learner:
    """What learns, and with what; shared by the algorithms of a run."""

    network: AnyNetwork
    optimiser: torch.optim.Optimizer
    """Adam, of the network's parameters; its rate is set before each update."""
    config: TrainConfig
    generator: torch.Generator
    """The only random numbers of updates: begun anew with each block, so that a run that is
    resumed gives the same as one that never stopped."""
    threads: "TorchThreads"  # Find the gradients of the parts of a minibatch side by side


class RolloutViews(Protocol):
    """T views of each of N environments."""

    pictures: Tensor  # uint8, shape (T, N, C, H, W)
    states: Tensor  # What the network carried, shape (T, N, S)
    ended: Tensor  # Whether the episode ended with each decision, shape (T, N)


LossOf = Callable[[Tensor, float], tuple[Tensor, Tensor]]
"""Returns what a part of a minibatch adds to the loss, a scalar, and to the figures that the update
returns. It is given the part, and its share of the minibatch, by which means are multiplied."""


class Algorithm(ABC):
    """A learning algorithm; a subclass says what to do with a rollout.

    Minibatches are numbers of environments if the network has a memory, which needs whole
    sequences, else numbers of single decisions.

    Attributes:
        Settings: Class of its settings: of the section of `train` with its name, or, if it is not
            one of Eyas, of `train.own`.
        columns: Names of the figures that an update returns: columns of the curve.
        taught: Whether a teacher tells the right actions: `Rollout.labels` and their `weights`.

    Args:
        learner: What learns.
        settings: Its settings.
    """

    Settings: ClassVar[type[Config]] = Config
    columns: ClassVar[tuple[str, ...]] = ()
    taught: ClassVar[bool] = False

    def __init__(self, learner: Learner, settings: Any) -> None:  # noqa: ANN401  # `Settings`
        self.learner, self.settings = learner, settings

    @abstractmethod
    def update(self, data: "Rollout") -> Tensor:
        """Improve the network with a rollout; return the figures of `columns`.

        Args:
            data: What the network as it is now has done; the next rollout overwrites it.
        """

    def begin(self, updates: int) -> None:  # noqa: B027  # most have nothing to forget
        """Begin a block of so many updates."""

    def guided(self, decisions: int) -> float | None:
        """Return the share of environments that the teacher flies in the next rollout; None: it is
        not asked.

        Args:
            decisions: Those of the run so far.
        """
        return None

    @property
    def learning_rate(self) -> float:
        """The rate with which the optimiser begins."""
        return self.learner.config.learning_rate

    def report(self, figures: Mapping[str, float]) -> str:
        """Return what the line of a block tells beside return and rate; figures of `columns`."""
        return ""

    def state_dict(self) -> dict[str, Any]:
        """Return what it must remember from block to block, beside network and optimiser: plain
        values and tensors, for the checkpoint.
        """
        return {}

    def load_state_dict(self, state: Mapping[str, Any]) -> None:  # noqa: B027  # as above
        """Remember what `state_dict` has returned."""

    def everything(self, data: RolloutViews) -> Tensor:
        """Return the minibatch that has all views."""
        steps, count = data.ended.shape
        memory = self.learner.network.shape.memory
        return torch.arange(count if memory else steps * count, device=data.ended.device)

    def taken(self, array: Tensor, part: Tensor) -> Tensor:
        """Return the values of a minibatch, of an array of shape (T, N, ...): shape (B, ...)."""
        if self.learner.network.shape.memory:
            return array[:, part].flatten(0, 1)
        return array.flatten(0, 1)[part]

    def outputs(self, data: RolloutViews, part: Tensor) -> tuple[Tensor, Tensor]:
        """Return logits (B, 7) and values (B,) of the network for a minibatch."""
        network = self.learner.network
        states, pictures = self.taken(data.states, part), self.taken(data.pictures, part)
        features = network.features(pictures, states[:, : ACTIONS - 1])
        if network.memory is not None:
            memory, kept = data.states[0, part, ACTIONS - 1 :], []
            for number, seen in enumerate(features.view(len(data.ended), len(part), -1)):
                memory = network.memory(seen, memory)
                kept.append(memory)
                memory = torch.where(data.ended[number, part, None] > 0.0, 0.0, memory)
            features = torch.cat(kept)
        return network.heads(features)

    def descend(self, chosen: Tensor, loss_of: LossOf) -> Tensor:
        """Take a step of the optimiser; return the sum of the parts' figures.

        Args:
            chosen: A minibatch, which is split into `train.parts`.
            loss_of: Tells the loss, whose gradient is cut to the norm `train.max_grad_norm`.
        """
        config, weights = self.learner.config, tuple(self.learner.network.parameters())

        def work(part: Tensor) -> tuple[Tensor, tuple[Tensor, ...]]:
            loss, figures = loss_of(part, len(part) / len(chosen))
            return figures.detach(), torch.autograd.grad(loss, weights)

        found = self.learner.threads.each(work, chosen.chunk(config.parts))
        gradients = zip(*(parts for _, parts in found), strict=True)
        for weight, parts in zip(weights, gradients, strict=True):
            weight.grad = torch.stack(parts).sum(0)
        nn.utils.clip_grad_norm_(weights, config.max_grad_norm)
        self.learner.optimiser.step()
        return torch.stack([figures for figures, _ in found]).sum(0)


class Phase(NamedTuple):
    """A part of a run in which one algorithm learns."""

    name: str
    algorithm: type[Algorithm]
    settings: Config
    end: int  # Decisions of the run after which the next one learns


def phases_of(config: TrainConfig) -> list[Phase]:
    """Return the phases of a run by `train.method`: `dagger+ppo` is two of them.

    Raises:
        ConfigError: An algorithm does not exist, or its settings are wrong.
    """
    found = []
    names = config.method.split("+")
    for number, name in enumerate(names, 1):
        kind = ALGORITHMS.get(name)
        if not isinstance(kind, type) or not issubclass(kind, Algorithm):
            raise ConfigError(f"{SETTING}: {name!r} is not an Algorithm, which learns by rollouts")
        if name in ALGORITHMS.built_in:
            settings: Config = getattr(config, name)
        else:
            settings = validated(kind.Settings, config.own, "train.own")
        end, decisions = config.run_decisions, getattr(settings, "total_timesteps", None)
        if number < len(names):
            if decisions is None:
                raise ConfigError(
                    f"{SETTING}: {config.method!r} is not allowed: {name!r} has no end before the "
                    "run's; allowed before '+': one with total_timesteps, such as 'dagger'"
                )
            end = min(config.rounded(decisions), end)
        found.append(Phase(name, kind, settings, end))
    return found
