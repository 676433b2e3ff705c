"""Settings of learning, and the learning algorithms by name."""

from collections.abc import Callable, Iterator, Mapping
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import Field, model_validator

from eyas.engine.core.allowed import TextForm
from eyas.engine.core.config import Config
from eyas.engine.core.named_code import NAMES_CODE
from eyas.engine.core.registry import Registry
from eyas.engine.settings.section import Changes, Section
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.simple_maps import simple_world

if TYPE_CHECKING:
    from eyas.engine.settings.config import EngineConfig

LESSON = 128  # Pictures in a step of learning of a tracker

Share = Annotated[float, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=1, le=2**40)]
DeviceName = Annotated[
    str,
    Field(pattern=r"^(host|cuda(:\d{1,4})?)$"),
    TextForm("'cuda', 'cuda:1' and so on or 'host'"),
]


class NumberType(StrEnum):
    """Numbers with which a network learns."""

    FLOAT32 = "float32"
    BFLOAT16 = "bfloat16"
    FASTEST = "fastest"


class NetworkKind(StrEnum):
    """Networks that learn flights."""

    EYAS = "eyas"  # Three convolutions, a layer, perhaps a memory, and two heads
    GC_VAT = "gc-vat"  # That of the benchmark's own method: actor and critic apart, with memories


class TeacherKind(StrEnum):
    """Who tells the right actions."""

    SIGHTED = "sighted"
    """An oracle that is told where the target is only while the picture shows at least 15 % of it,
    and goes on at its last velocity."""
    EXACT = "exact"  # An oracle that always knows where the target is


class Stage(Config):
    """A part of a curriculum."""

    total_timesteps: Count
    """Largest number of decisions, of all environments together."""
    until_tsr: Share | None = None
    """The stage ends as soon as an evaluation has at least this TSR."""
    settings: dict[str, Any] = {}  # noqa: RUF012  # pydantic copies it
    """Settings that differ from the common ones, for example `{"world": {"weather": "night"}}`."""
    simple_map: bool = False
    """Whether it is flown on the simple map that stands for the map, see
    `docs/maps/simpleway.md`."""

    def changes(self, world: WorldConfig) -> dict[str, Any]:
        """Return what differs from common settings that have this world."""
        if not self.simple_map:
            return self.settings
        inside = self.settings.get("world", {})
        if not isinstance(inside, Mapping):
            return self.settings  # refused as such
        name, weather = simple_world(world.map, world.weather)
        return {**self.settings, "world": {**inside, "map": name, "weather": weather}}


class Evaluation(Config):
    """How the network is tested during training; the figures stand in the curve."""

    every: Annotated[int, Field(ge=0, le=100_000)] = 4
    """Blocks from one evaluation to the next; 0: none."""
    protocol: Annotated[str, NAMES_CODE] = "paper"
    """Protocol, as for `eyas evaluate`."""
    weathers: Annotated[tuple[str, ...], NAMES_CODE] = ()
    """Weathers of the episodes; none: `world.weather`."""
    episodes: Annotated[int, Field(ge=1, le=1000)] = 5
    """Episodes of each weather and start direction."""
    seed: Annotated[int, Field(ge=0, lt=2**62)] = 2_000_000
    """Seed of the first episode: far from those of training and of `eyas evaluate`."""


class DaggerConfig(Config):
    """Dataset aggregation (Ross et al. 2011, arXiv:1011.0686): the network flies, the teacher
    labels the action that it would choose, and the network learns that from these views and from
    earlier ones of the block.
    """

    total_timesteps: Count = 100_000
    """Decisions after which the other goes on, with `dagger+ppo` or `dagger+` one of your own;
    rounded up to whole updates."""
    teacher: TeacherKind = TeacherKind.SIGHTED
    """Who labels the actions: an oracle that sees only what the picture shows and goes on at the
    target's last velocity, or one that always knows."""
    guided_timesteps: Annotated[int, Field(ge=0, le=2**40)] = 12_000
    """Over these decisions the share of environments that the teacher flies falls from all to none;
    0: the network flies all from the start."""
    fade: Annotated[float, Field(gt=0, le=1e6)] = 0.5
    """The label of an action counts 1/e when the target has been out of sight for this time
    [s]."""
    buffer: Count = 65_536
    """Latest decisions of a block that are kept, rounded up to whole updates. A block begins with
    an empty one, so that a run that is resumed gives the same as one that never stopped. Each takes
    the bytes of its picture: 7 kB at 48x48."""
    replay: Annotated[float, Field(ge=0, le=100)] = 1.0
    """Decisions drawn from what is kept for each new one that is learned from."""
    minibatches: Annotated[int, Field(ge=1, le=4096)] = 32
    """Parts of the new decisions of an update; each, with its share of old ones, is a step of the
    optimiser."""
    learning_rate: Annotated[float, Field(gt=0, le=1)] = 2e-3
    """Learning rate of Adam; it falls linearly to `train.final_rate` of this while the teacher
    teaches."""


class PpoConfig(Config):
    """Proximal policy optimisation (Schulman et al. 2017, arXiv:1707.06347)."""

    n_epochs: Annotated[int, Field(ge=1, le=100)] = 3
    """Passes over the data of a rollout."""
    minibatches: Annotated[int, Field(ge=1, le=4096)] = 4
    """Parts of a pass; each is a step of the optimiser."""
    clip_range: Annotated[float, Field(gt=0, le=10)] = 0.2
    """Largest change of the ratio of probabilities that is rewarded."""
    ent_coef: Annotated[float, Field(ge=0, le=10)] = 0.01
    """Weight of the entropy of actions in the loss."""


class Round(Config):
    """A part of the training of a tracker: flights, then lessons from all pictures there are."""

    flights: Annotated[int, Field(ge=0, le=100_000)]
    """Batches of 32 flights, of an oracle in the first round, then of the tracker itself."""
    steps: Annotated[int, Field(ge=1, le=100_000_000)]
    """Steps of the optimiser, of 128 pictures each."""


class TrackerTraining(Config):
    """How the network of a tracker is taught, which follows what its first box shows
    (docs/following-one-target.md).
    """

    rounds: Annotated[tuple[Round, ...], Field(min_length=1)] = (
        Round(flights=24, steps=1200),
        Round(flights=20, steps=1200),
        Round(flights=20, steps=1500),
        Round(flights=0, steps=4500),
    )
    """Rounds of batches of 32 flights, of an oracle in the first and then of the tracker itself,
    and steps of learning of 128 pictures from all that there are. The first round needs
    flights."""
    drives: Annotated[int, Field(ge=1, le=100_000)] = 45
    """Batches of traffic of 35 s from which it learns beforehand where drivers go."""
    drive_steps: Annotated[int, Field(ge=1, le=100_000_000)] = 10_000
    """Steps of the optimiser for that."""
    learning_rate: Annotated[float, Field(gt=0, le=1)] = 2e-3
    """Learning rate of AdamW; in each round it rises to this and falls to a fiftieth of it."""

    @property
    def pictures(self) -> int:
        """Pictures in all lessons, with those that come more than once."""
        return LESSON * sum(each.steps for each in self.rounds)

    def scaled(self, total: int) -> dict[str, Any]:
        """Return the changes with `total` pictures in all lessons: each round with its share of
        steps and flights, at least 1 where there were any, and the traffic with its share.
        """
        factor = total / self.pictures
        rounds = [
            {
                "flights": max(round(each.flights * factor), min(each.flights, 1)),
                "steps": max(round(each.steps * factor), 1),
            }
            for each in self.rounds
        ]
        drives = {name: getattr(self, name) for name in ("drives", "drive_steps")}
        shares = {name: max(round(count * factor), 1) for name, count in drives.items()}
        return {"rounds": rounds, **shares}

    @model_validator(mode="after")
    def _check_first(self) -> Self:
        if not self.rounds[0].flights:
            raise ValueError("rounds.0.flights: 0 is not allowed: nothing to learn from")
        return self


class WordsTraining(Config):
    """How the network of a listener is taught, which follows what words name
    (docs/following-words.md).
    """

    blocks: Annotated[int, Field(ge=1, le=100_000)] = 60
    """Blocks of new pictures of a listener, after each of which the run can be resumed."""
    scenes: Annotated[int, Field(ge=32, le=2**16, multiple_of=32)] = 1024
    """Pictures of a block, a multiple of 32: as many of each map and weather as of the others."""
    passes: Annotated[int, Field(ge=1, le=100)] = 2
    """How often each picture is shown."""
    learning_rate: Annotated[float, Field(gt=0, le=1)] = 3e-3
    """Learning rate of AdamW; it rises to this and falls to a fiftieth of it."""

    @property
    def block_pictures(self) -> int:
        """Pictures in the lessons of a block."""
        return self.scenes * self.passes

    @property
    def pictures(self) -> int:
        """Pictures in all lessons, with those that come more than once."""
        return self.blocks * self.block_pictures

    def scaled(self, total: int) -> dict[str, Any]:
        """Return the change with `total` pictures in all lessons: so many blocks, at least 1."""
        return {"blocks": max(round(total / self.block_pictures), 1)}


class TrainConfig(Section):
    """How a network is taught."""

    section = "train"

    method: Annotated[str, NAMES_CODE] = "ppo"
    """By rewards (proximal policy optimisation), by a teacher (dataset aggregation), or by a
    teacher at first; `tracker`: the network of a tracker that follows what its first box shows,
    which `train.tracker` alone configures (docs/following-one-target.md); `words`: that of a
    listener, which `train.words` alone configures (docs/following-words.md); `pursuit`: a tracker
    and the driver of its target against each other (docs/pursuit.md). Also
    `package.module:Class`; two joined by `+` learn one after the other."""
    ppo: PpoConfig = PpoConfig()
    dagger: DaggerConfig = DaggerConfig()
    tracker: TrackerTraining = TrackerTraining()
    words: WordsTraining = WordsTraining()
    own: dict[str, Any] = {}  # noqa: RUF012  # pydantic copies it
    """Settings of an algorithm that is not one of Eyas: fields of its `Settings`."""
    environments: Annotated[int, Field(ge=1, le=65536)] = 32
    """Environments that are stepped together."""
    stages: tuple[Stage, ...] = (Stage(total_timesteps=600_000),)
    """The curriculum: stages with a number of decisions of all environments, the TSR of an
    evaluation at which they end early, what differs from the common settings, and whether it is
    flown on the simple map (docs/maps/simpleway.md) that stands for the map."""
    evaluation: Evaluation = Evaluation()
    begin_from: Annotated[str, Field(min_length=1)] | None = None
    """Folder of another run, whose network this one teaches further; None: a new network."""
    n_steps: Annotated[int, Field(ge=2, le=65536)] = 64
    """Decisions of each environment between two updates."""
    updates_per_block: Annotated[int, Field(ge=1, le=100_000)] = 20
    """Updates between two checkpoints. Each block begins with new episodes, so that a run that is
    resumed gives the same as one that never stopped."""
    learning_rate: Annotated[float, Field(gt=0, le=1)] = 5e-4
    """Learning rate of Adam; it falls linearly to `final_rate` of this over all stages."""
    final_rate: Share = 0.05
    """Share of the learning rate that is left at the end."""
    gamma: Share = 0.95
    """Discount of rewards, per decision."""
    gae_lambda: Share = 0.9
    """Lambda of generalised advantage estimation."""
    vf_coef: Annotated[float, Field(ge=0, le=100)] = 0.5
    """Weight of the error of the value in the loss."""
    max_grad_norm: Annotated[float, Field(gt=0, le=1e6)] = 0.5
    """Norm to which gradients are cut."""
    reward_scale: Annotated[float, Field(gt=0, le=1e6)] = 0.025
    """Factor on the rewards that are learned from."""
    network: NetworkKind = NetworkKind.EYAS
    """The network: `eyas`, or `gc-vat`, that of the benchmark's own method, which has a memory."""
    hidden: Annotated[int, Field(ge=1, le=65536)] = 256
    """Width of the layer behind the convolutions, and of the memory."""
    memory: bool = False
    """Whether a gated recurrent unit follows that layer."""
    parts: Annotated[int, Field(ge=1, le=1024)] = 2
    """Parts of a minibatch whose gradients are found side by side, each in a thread. The result
    depends on their number in the last digits, but not on that of processors."""
    channels_last: bool = False
    """Whether pictures and weights have their channels last in memory: a third faster on
    processors with AVX2, with other last digits."""
    number_type: NumberType = NumberType.FLOAT32
    """Numbers of the network while it learns. `bfloat16`: less time on processors that
    multiply these (AMX, AVX512-BF16), half as much again on others. `fastest`: bfloat16 where the
    device multiplies it, else float32; other machines then learn other networks."""
    device: DeviceName | None = None
    """Where environments and network are: `cuda`, `cuda:1` and so on are graphics processors of
    NVIDIA; `host` does on this processor what these would do, for tests. None: this processor."""
    loggers: Annotated[tuple[str, ...], NAMES_CODE] = ("tensorboard",)
    """Where the curves go beside `curve.csv`: `tensorboard`, if it is installed, `wandb` (Weights &
    Biases), `mlflow`, or your own, `package.module:Class`."""
    shards: Annotated[int, Field(ge=1, le=1024)] = 1
    """Parts into which the environments are split, with random numbers of their own. One is fastest
    in one process; the result does not depend on where the shards run."""

    @property
    def update_decisions(self) -> int:
        """Decisions of all environments between two updates."""
        return self.environments * self.n_steps

    def updates_of(self, stage: Stage) -> int:
        """Return the updates of a stage: as many as have at least its decisions."""
        return self.rounded(stage.total_timesteps) // self.update_decisions

    def rounded(self, decisions: int) -> int:
        """Return the decisions of the fewest whole updates that have at least so many."""
        return -(-decisions // self.update_decisions) * self.update_decisions

    @property
    def run_decisions(self) -> int:
        """Decisions of all stages."""
        return sum(map(self.updates_of, self.stages)) * self.update_decisions

    def variants(self, config: "EngineConfig") -> Iterator[tuple[str, Changes]]:
        """Yield what the stages change, see `Section`."""
        for at, stage in enumerate(self.stages):
            yield f"stages.{at}", stage.changes(config.world)

    def alone(self) -> Self:
        """Return the section without stages."""
        return self.model_copy(update={"stages": ()})

    def scaled(self, total: int) -> dict[str, Any]:
        """Return the changes that make it a run of `total` decisions, or pictures in lessons."""
        section = getattr(self, self.method, None)
        if isinstance(section, TrackerTraining | WordsTraining):
            return {self.method: section.scaled(total)}
        return {"stages": self.scaled_stages(total)}

    def scaled_stages(self, total: int) -> list[dict[str, Any]]:
        """Return the stages with `total` decisions together, each with its share, at least 1."""
        factor = total / sum(stage.total_timesteps for stage in self.stages)
        counts = [max(round(stage.total_timesteps * factor), 1) for stage in self.stages]
        return [
            {**stage.model_dump(mode="json"), "total_timesteps": count}
            for stage, count in zip(self.stages, counts, strict=True)
        ]

    @model_validator(mode="after")
    def _check_stages(self) -> Self:
        if not self.evaluation.every and any(stage.until_tsr is not None for stage in self.stages):
            raise ValueError("stages: 'until_tsr' needs evaluations: evaluation.every is 0")
        return self

    @model_validator(mode="after")
    def _check_shards(self) -> Self:
        if self.device is not None and self.shards > 1:
            raise ValueError(f"shards: {self.shards} are not there on a device; allowed: 1")
        if self.environments % self.shards:
            raise ValueError(
                f"environments: {self.environments} cannot be split into {self.shards} shards of "
                "equal size"
            )
        return self


SETTING = "train.method"

ALGORITHMS: Registry[Callable[..., Any]] = Registry(
    SETTING,
    Callable,  # type: ignore[arg-type]  # a protocol of the standard library
    {
        "ppo": "eyas.learning.ppo:Ppo",
        "dagger": "eyas.learning.dagger:Dagger",
        "tracker": "eyas.learning.tracking.training:train",
        "words": "eyas.learning.words.training:train",
        "pursuit": "eyas.learning.pursuit.training:train",
    },
    group="eyas.algorithms",
)
"""Each is a subclass of `Algorithm`, which learns from rollouts, or a function that does a whole
run with networks and data of its own: `train(config, folder, *, resume, say) -> Path`."""
