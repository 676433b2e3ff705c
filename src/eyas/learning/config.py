"""Settings of learning."""

from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from eyas.core.code_names import NAMES_CODE
from eyas.core.config import Config

__all__ = ["Evaluation", "Stage", "TrainConfig"]

Share = Annotated[float, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=1, le=2**40)]


class Stage(Config):
    """A part of a curriculum."""

    total_timesteps: Count
    """Largest number of decisions, of all environments together."""
    until_tsr: Share | None = None
    """The stage ends as soon as an evaluation has at least this TSR."""
    settings: dict[str, Any] = {}  # noqa: RUF012  # pydantic copies it
    """Settings that differ from the common ones, for example `{"world": {"weather": "night"}}`."""


class Evaluation(Config):
    """How the network is tested during training; the figures stand in the curve."""

    every: Annotated[int, Field(ge=0, le=100_000)] = 4
    """Blocks from one evaluation to the next; 0: none."""
    protocol: str = "paper"
    """Of `eyas evaluate`."""
    weathers: Annotated[tuple[str, ...], NAMES_CODE] = ()
    """None: `world.weather`."""
    episodes: Annotated[int, Field(ge=1, le=1000)] = 5
    """For each weather and start direction."""
    seed: Annotated[int, Field(ge=0, lt=2**62)] = 2_000_000
    """Of the first episode: far from those of training and of `eyas evaluate`."""


class TrainConfig(Config):
    """Proximal policy optimisation (Schulman et al. 2017, arXiv:1707.06347)."""

    environments: Annotated[int, Field(ge=1, le=65536)] = 32
    """Environments that are stepped together."""
    stages: tuple[Stage, ...] = (Stage(total_timesteps=600_000),)
    """The curriculum: one stage after the other."""
    evaluation: Evaluation = Evaluation()
    begin_from: str | None = None
    """Folder of another run, whose network this one teaches further; None: a new network."""
    n_steps: Annotated[int, Field(ge=2, le=65536)] = 64
    """Decisions of each environment between two updates."""
    updates_per_block: Annotated[int, Field(ge=1, le=100_000)] = 20
    """Updates between two checkpoints. Each block begins with new episodes, so that a run that is
    resumed gives the same as one that never stopped."""
    n_epochs: Annotated[int, Field(ge=1, le=100)] = 3
    """Passes over the data of a rollout."""
    minibatches: Annotated[int, Field(ge=1, le=4096)] = 4
    """Parts of a pass; each is a step of the optimiser."""
    learning_rate: Annotated[float, Field(gt=0, le=1)] = 5e-4
    """Of Adam; it falls linearly to `final_rate` of this over all stages."""
    final_rate: Share = 0.05
    """Share of the learning rate that is left at the end."""
    gamma: Share = 0.95
    """Discount of rewards, per decision."""
    gae_lambda: Share = 0.9
    """Lambda of generalised advantage estimation."""
    clip_range: Annotated[float, Field(gt=0, le=10)] = 0.2
    """Largest change of the ratio of probabilities that is rewarded."""
    ent_coef: Annotated[float, Field(ge=0, le=10)] = 0.01
    """Weight of the entropy of actions in the loss."""
    vf_coef: Annotated[float, Field(ge=0, le=100)] = 0.5
    """Weight of the error of the value in the loss."""
    max_grad_norm: Annotated[float, Field(gt=0, le=1e6)] = 0.5
    """Norm to which gradients are cut."""
    reward_scale: Annotated[float, Field(gt=0, le=1e6)] = 0.025
    """Factor on the rewards that are learned from."""
    hidden: Annotated[int, Field(ge=1, le=65536)] = 256
    """Width of the layer behind the convolutions, and of the memory."""
    memory: bool = False
    """Whether a gated recurrent unit follows that layer."""
    parts: Annotated[int, Field(ge=1, le=1024)] = 2
    """Parts of a minibatch whose gradients are found side by side, each in a thread. The result
    depends on their number in the last digits, but not on that of processors."""
    shards: Annotated[int, Field(ge=1, le=1024)] = 1
    """Parts into which the environments are split, with random numbers of their own. One is fastest
    in one process; the result does not depend on where the shards run."""

    @property
    def update_decisions(self) -> int:
        """Decisions of all environments between two updates."""
        return self.environments * self.n_steps

    def updates_of(self, stage: Stage) -> int:
        """Return the updates of a stage: as many as have at least its decisions."""
        return -(-stage.total_timesteps // self.update_decisions)

    @model_validator(mode="after")
    def _check_stages(self) -> Self:
        if not self.evaluation.every and any(stage.until_tsr is not None for stage in self.stages):
            raise ValueError("stages: 'until_tsr' needs evaluations: evaluation.every is 0")
        return self

    @model_validator(mode="after")
    def _check_shards(self) -> Self:
        if self.environments % self.shards:
            raise ValueError(
                f"environments: {self.environments} cannot be split into {self.shards} shards of "
                "equal size"
            )
        return self
