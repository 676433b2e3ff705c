"""What an evaluation flies, and with what."""

import json
import re
import shlex
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, model_validator

from eyas.benchmark.episodes.episode import FIRST_SEED, SETS_APART, EpisodeSpec, Place
from eyas.benchmark.plan.entry import ResultEntry, entry_of
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.policies.sandbox import open_sandboxed
from eyas.benchmark.policies.table import ORACLES, fingerprint, open_policy, runs_code
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.protocols.table import PROTOCOLS, protocol_named
from eyas.engine.core.config import Config
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.identity.build import Build, this_build
from eyas.engine.core.installed import installed_version
from eyas.engine.core.named_code import Origin, origin_of
from eyas.engine.core.rng import TEST_SEEDS
from eyas.engine.policies.policy import Policy
from eyas.engine.world.maps import MAPS

Names = Annotated[tuple[str, ...], Field(min_length=1)]
Seed = Annotated[int, Field(ge=0, lt=2**62)]


class EvaluationPlan(Config):
    """An evaluation. The same plan in the same version gives the same records, bit for bit."""

    policy: str
    """A name, the path of a file, or `package.module:name`."""
    protocol: str = "paper"
    """A name, or `package.module:NAME`."""
    maps: Names = ("citystreet",)
    weathers: Names = ("day",)
    targets: Names | None = None
    """What is followed; None: the protocol's targets."""
    episodes: Annotated[int, Field(ge=1, le=100_000)] | None = None
    """Episodes of each place and start direction; None: the protocol's number."""
    seeds: Annotated[tuple[Seed, ...], Field(min_length=1)] = (FIRST_SEED,)
    """Seed of the first episode of each set of episodes."""
    latency: str = "0"
    """Milliseconds, a profile, the path of a file with one latency in each line, or `measured`."""
    sampled: bool = False
    """Whether a network's actions are sampled instead of the best ones."""
    in_process: bool = False
    """Whether code of a user's flies in the process of the simulator, which it could read."""
    env: dict[str, Any] = {}  # noqa: RUF012  # pydantic copies it
    """Changes of what the policy sees and does."""
    settings: dict[str, Any] = {}  # noqa: RUF012  # the same
    """Changes of `tracker`, `control`, `camera`, `start.velocity` and `extras`: another
    protocol."""
    batch: Annotated[int, Field(ge=1, le=4096)] = 64
    """Episodes that are flown together. A network's last bits may depend on it."""

    @model_validator(mode="before")
    @classmethod
    def _at_home(cls, values: Any) -> Any:  # noqa: ANN401  # whatever a caller gives
        """Take the protocol's maps and weathers if none are named."""
        if not isinstance(values, dict) or {"maps", "weathers"} <= values.keys():
            return values
        protocol = protocol_named(str(values.get("protocol", "paper")))
        return {"maps": protocol.maps, "weathers": protocol.weathers, **values}

    @property
    def rules(self) -> Protocol:
        """The protocol, with the changes."""
        protocol = protocol_named(self.protocol)
        return protocol.changed(self.settings) if self.settings else protocol

    def parts_of(self, episodes: Sequence[EpisodeSpec]) -> list[list[EpisodeSpec]]:
        """Return episodes in batches, in which no two share a start unless they are a team's.

        In another weather, or as another variant, a start has the same traffic: a policy that flew
        both at once could do in one what it sees in the other.
        """
        size = 1 if self.latency == "measured" else self.batch
        if self.rules.team:
            whole = max(size // len(self.rules.variants), 1) * len(self.rules.variants)
            return [list(episodes[at : at + whole]) for at in range(0, len(episodes), whole)]
        met = Counter[tuple[object, ...]]()
        rounds: list[list[EpisodeSpec]] = []
        for episode in episodes:
            place, direction, seed, traffic, _ = episode
            start = (place.map, place.target, direction, seed, traffic)
            if met[start] == len(rounds):
                rounds.append([])
            rounds[met[start]].append(episode)
            met[start] += 1
        return [own[at : at + size] for own in rounds for at in range(0, len(own), size)]

    @property
    def followed(self) -> tuple[str, ...]:
        """The targets."""
        return self.targets or self.rules.targets

    @property
    def count(self) -> int:
        """Number of all episodes; nothing that the plan names is loaded to know it."""
        places = len(self.maps) * len(self.weathers) * len(self.followed)
        each = self.episodes or self.rules.episodes
        versions = max(len(self.rules.variants), 1)
        return places * len(self.rules.directions) * each * versions * len(self.seeds)

    @property
    def command(self) -> str:
        """The command that repeats it."""
        usual = {name: field.default for name, field in type(self).model_fields.items()}
        home = EvaluationPlan(policy=self.policy, protocol=self.protocol)
        usual |= {"maps": home.maps, "weathers": home.weathers}
        chosen = self.model_dump(
            exclude={"env", "settings", "sampled", "in_process", "policy", "seeds"}
        )
        told = {name: value for name, value in chosen.items() if value != usual[name]}
        words = ["eyas", "evaluate", "--policy", self.policy]
        if self.seeds != (FIRST_SEED,):
            words += [
                "--seeds" if len(self.seeds) > 1 else "--seed",
                ",".join(map(str, self.seeds)),
            ]
        for name, value in told.items():
            if isinstance(value, tuple):
                option = f"--{name.removesuffix('s')}"
                words += [word for each in value for word in (option, each)]
            else:
                words += [f"--{name}", str(value)]
        if self.sampled:
            words.append("--sample")
        if self.in_process:
            words.append("--in-process")
        for key, value in _flat("", {"env": self.env, **self.settings}):
            text = value if isinstance(value, str) else json.dumps(value)
            words += ["--set", f"{key}={text}"]
        return shlex.join(words)


_NOT_FLOWN = ("learning", "robotics", "engine/exports", "engine/overlay", "engine/video")
"""Rooms that have no part in an evaluation."""


class Stamp(Config):
    """Identity of an evaluation: records with equal stamps belong together."""

    version: str
    """Version of Eyas."""
    build: Build
    """Digests of the code and data of Eyas."""
    protocol: str
    """Hash of the protocol."""
    rules: Origin | None = None
    """Origin of the protocol's code; None: Eyas."""
    policy: str | None
    """Hash of the policy's file; None if it has none."""
    plan: EvaluationPlan
    entry: ResultEntry | None = None
    """What the policy sees and may do; None where nobody has opened it yet."""

    @property
    def program(self) -> str:
        """Twelve hexadecimal digits that differ between programs that fly and measure."""
        return self.build.id_without(_NOT_FLOWN)

    def other_build(self, other: "Stamp") -> str:
        """Return in words what differs in the programs that fly; nothing if nothing does."""
        networks = self.policy is not None or other.policy is not None
        return self.build.difference(other.build, without=_NOT_FLOWN, libraries=networks)


def stamp(plan: EvaluationPlan) -> Stamp:
    """Return the stamp of a plan."""
    return Stamp(
        version=installed_version(),
        build=this_build(),
        protocol=plan.rules.hash,
        rules=None if (path := PROTOCOLS.path(plan.protocol)) is None else origin_of(path),
        policy=fingerprint(plan.policy),
        plan=plan,
    )


def folder_name(plan: EvaluationPlan) -> str:
    """Return the name of the folder of a plan's results, unless a user chooses one."""
    return re.sub(r"[^\w.-]+", "-", f"{Path(plan.policy).stem}-{plan.protocol}")


def batches(plan: EvaluationPlan) -> list[list[EpisodeSpec]]:
    """Return the episodes that are flown together; an interrupted batch is flown again whole.

    Those of one set are the same as if it were flown alone.
    """
    protocol = plan.rules
    places = [
        Place(name, weather, target)
        for name in plan.maps
        for weather in plan.weathers
        for target in plan.followed
    ]
    count = plan.episodes or protocol.episodes
    found = []
    for seed in plan.seeds:
        found += plan.parts_of(protocol.choose(places, protocol, count, seed))
    return found


def opened(plan: EvaluationPlan) -> tuple[Policy, ResultEntry]:
    """Return the policy of a plan, and what a result says of it.

    Code of a user's, and files that may hold some, fly in a process of their own.

    Raises:
        EyasError: It cannot be loaded, or may not act as it wants in this protocol.
    """
    foreign = runs_code(plan.policy)
    apart = foreign and not plan.in_process
    make = open_sandboxed if apart else open_policy
    usual = plan.rules.oracles if plan.policy in ORACLES else {}
    policy = make(plan.policy, {**usual, **plan.env}, sampled=plan.sampled)
    plan.rules.envelope.refuse(policy.env, plan.protocol)
    beside = foreign and plan.in_process
    return policy, entry_of(policy, plan.latency, apart=apart, beside=beside)


def check(plan: EvaluationPlan) -> ResultEntry:
    """Refuse a plan that cannot be flown, before anything is written; else return its entry.

    Raises:
        EyasError: A name or a setting is wrong.
    """
    delay_from(plan.latency)
    if plan.latency == "measured" and plan.rules.team:
        raise ConfigError(
            f"--latency: 'measured' is not allowed in protocol '{plan.protocol}': the answers of a "
            "team are not made one by one; measure in 'long', and use the file of latencies"
        )
    if len(set(plan.maps)) < len(plan.maps) or len(set(plan.weathers)) < len(plan.weathers):
        raise ConfigError("--map, --weather: a name is there twice")
    first = sorted(plan.seeds)
    if any(later - seed < SETS_APART for seed, later in pairwise(first)):
        raise ConfigError(
            f"--seeds: {', '.join(map(str, plan.seeds))}: sets could share episodes; allowed: "
            f"first seeds that differ by {SETS_APART} or more"
        )
    policy, entry = opened(plan)
    if plan.rules.elsewhere:
        _refuse_taught(plan)
    for name in plan.maps:
        for weather in plan.weathers:
            for target in plan.followed:
                episode = EpisodeSpec(Place(name, weather, target), 0.0, 0)
                MAPS.get(episode.place.town[0]).light(weather)  # refuses unknown names
                plan.rules.settings_of(episode, policy.env)  # refuses wrong ones
    return entry


def _refuse_taught(plan: EvaluationPlan) -> None:
    """Refuse maps on which policies are taught."""
    for name in plan.maps:
        town, seed = Place(name, "", "").town
        if town in MAPS.built_in and seed < TEST_SEEDS:
            raise ConfigError(
                f"--map: '{name}' is not allowed in protocol '{plan.protocol}', as policies are "
                f"taught there; allowed: {', '.join(plan.rules.maps)}, any other "
                f"NAME:SEED from seed {TEST_SEEDS} on (extra sumo), and maps of your own"
            )


def _flat(path: str, values: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _flat(f"{path}{key}.", value)
        else:
            yield f"{path}{key}", value
