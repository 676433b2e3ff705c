"""A protocol: the settings in which all policies fly, with a hash that tells them apart."""

import hashlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from eyas.benchmark.episodes.episode import EpisodeSpec, Place, episodes_of
from eyas.benchmark.protocols.envelope import ENVELOPE, Envelope
from eyas.engine.core.clock import PHYSICS_STEP, physics_steps
from eyas.engine.core.config import updated
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.env import EnvConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import preset_file
from eyas.engine.sim.config import SimConfig
from eyas.engine.traffic.config import Demand

if TYPE_CHECKING:
    from eyas.benchmark.episodes.episode_batch import EpisodeBatch
    from eyas.benchmark.flight.scenario import Scenario
    from eyas.benchmark.records.record import EpisodeRecord
    from eyas.engine.sim.simulation import Simulation

_DIRECTIONS = (0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi)
LEAST_SIZE = 1.5 / 84.0
"""Share of the picture's width that a target's longest side must span to count as followed: what
the smallest one, a robot of .34 m, has at 24 m. A car has less from 320 m on."""

FARTHEST = 60.0
"""See `Protocol.farthest`: twice as far as a target in the picture of a drone at the largest height
can be, so that it binds only where a camera turns."""

NEVER = 2**31 - 1  # Value of `done.no_reward_steps` with which a lost target ends no episode

Chooser = Callable[[Sequence[Place], "Protocol", int, int], list[EpisodeSpec]]
"""Chooses the episodes of places: so many for each place and direction, from a first seed on. More
episodes include the fewer ones, and the seeds do not depend on the places."""

Stage = Callable[["Simulation", Sequence[EpisodeSpec]], Sequence[Any]]
"""Changes how the episodes of a simulation begin; returns what a scenario must know of each."""

MakeScenario = Callable[["EpisodeBatch", "Protocol", Sequence[EpisodeSpec]], "Scenario"]
"""Makes what happens in a batch of flights beside the flights."""

_FIXED = set(SimConfig.model_fields) - {"seed", "same_target"}
"""Settings that are part of a protocol: all of the simulation, none of its uses. Each drone has a
world of its own, so that none shares its target."""

_PLACED = ("world.map", "world.seed", "world.weather", "target", "start.direction")
"""Settings that the episodes decide, see `Protocol.settings_of`."""

_IDLE: Mapping[str, Callable[[SimConfig], bool]] = {
    "lidar": lambda config: not config.lidar.enabled,
    "tracker.flight": lambda config: config.tracker.supervised,
    "tracker.off_centre": lambda config: config.tracker.supervised,
    "traffic.group_size": lambda config: config.traffic.demand is Demand.KEEP_ALIVE,
    "traffic.group_interval": lambda config: config.traffic.demand is Demand.KEEP_ALIVE,
    "traffic.route_length": lambda config: config.traffic.demand is Demand.KEEP_ALIVE,
    "traffic.route_count": lambda config: config.traffic.demand is Demand.KEEP_ALIVE,
    "traffic.update_routes": lambda config: True,
}
"""When settings have no effect on an episode."""


_AS_PUBLISHED: Mapping[str, str] = {"signals": "amber", "lamps": "dark"}
"""Defaults of `traffic` when the first hashes were published, where it has others now."""

_SINCE: Mapping[str, Any] = {"tracker": {"off_centre": False}}
"""What the original's files have come to mean since then, and the presets with them, but protocols
do not."""


def _joined(first: Mapping[str, Any], second: Mapping[str, Any]) -> dict[str, Any]:
    """Return nested settings with some changed."""
    both = dict(first)
    for name, value in second.items():
        inner = both.get(name)
        if isinstance(value, Mapping) and isinstance(inner, Mapping):
            value = _joined(inner, value)
        both[name] = value
    return both


def in_order(
    places: Sequence[Place], protocol: "Protocol", count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the episodes of consecutive seeds, whatever happens in them; see `Chooser`."""
    episodes = protocol.starts(places, count, first_seed)
    if not protocol.variants:
        return episodes
    return [each._replace(variant=own) for each in episodes for own in protocol.variants]


@dataclass(frozen=True)
class Protocol:
    """A protocol; its settings are those of the preset `dat-eval`, with changes."""

    name: str
    title: str  # What it measures, in a few words
    changes: Mapping[str, Any] = field(default_factory=dict)
    directions: tuple[float, ...] = _DIRECTIONS  # Start directions [rad]
    targets: tuple[str, ...] = ("SUMO_VEHICLE",)  # What is followed, unless a user names others
    episodes: int = 25
    """Default number of episodes for each place and direction: a hundred for each place."""
    maps: tuple[str, ...] = ("citystreet",)  # Where it is flown unless a user names other maps
    weathers: tuple[str, ...] = ("day",)  # In which it is flown unless a user names others
    recordings: tuple[int, ...] = ()
    """Seeds of the recorded traffic that its episodes take in turn; none: that of the settings."""
    elsewhere: bool = False
    """Whether it is not flown on maps on which policies are taught: on those of Eyas only with
    seeds from `eyas.engine.core.rng.TEST_SEEDS` on."""
    drawn: tuple[str, ...] = ()
    """Places that were drawn for it, and are part of its hash; empty: places are the user's."""
    columns: tuple[str, ...] = ("cr", "tsr", "flawless", "worst_fifth", "seen", "visible")
    """The figures that are printed; the files have all."""
    rank: str = "tsr"  # The figure by which a leaderboard ranks
    gaps: tuple[str, ...] = ()
    """Names of its figures that are differences of two shares, from -1 to 1."""
    alike: bool = False  # Whether all others of the target's kind look like it
    choose: Chooser = in_order  # Which its episodes are
    stage: Stage | None = None  # Changes how its episodes begin; None: they begin as sampled
    scenario: MakeScenario | None = None  # What happens in its flights beside the flights
    groups: Mapping[str, Callable[["EpisodeRecord"], str]] = field(default_factory=dict)
    """Groups of rows in its tables, beside those of all protocols: what each record belongs to."""
    variants: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Versions of each episode, with changes of the settings; none: there is one."""
    reference: str = ""
    """The variant from which the others' figure `fall` counts; none: there is no such figure."""
    ratings: Mapping[str, float] = field(default_factory=dict)
    """Elo ratings of the variants, which are opponents; none: there is no figure `elo`."""
    team: bool = False  # Whether the variants are drones that follow one target together
    first_box: bool = True  # Whether policies are told the target's true box in the first picture
    tells_solvable: bool = False
    """Whether records say if the policy `sighted` solves the episode, where a TSR can say so."""
    oracles: Mapping[str, Any] = field(default_factory=dict)
    """Changes of `env` for the oracles, before those of a user's: it is theirs that the drone can
    be flown, and no part of what is measured."""
    envelope: Envelope = ENVELOPE  # What drones may do
    farthest: float = FARTHEST
    """Distance from the camera over which a target does not count as followed [m]."""

    @cached_property
    def settings(self) -> EyasConfig:
        """The settings, without place, direction, seed and `env`."""
        return updated(load_settings(preset_file("dat-eval")), _joined(_SINCE, self.changes))

    def changed(self, changes: Mapping[str, Any]) -> "Protocol":
        """Return a protocol with other settings, and so with another hash."""
        return replace(self, changes=_joined(self.changes, changes))

    def like(
        self,
        name: str,
        title: str,
        changes: Mapping[str, Any] | None = None,
        **others: Any,  # noqa: ANN401  # fields of any type
    ) -> "Protocol":
        """Return a protocol that is as this one but for what is said.

        Args:
            name: Its name.
            title: What it measures, in a few words.
            changes: Settings that differ from this one's, nested.
            others: Other fields, such as `maps`, `episodes` or `columns`.
        """
        return replace(self.changed(changes or {}), name=name, title=title, **others)

    def starts(self, places: Sequence[Place], count: int, first_seed: int) -> list[EpisodeSpec]:
        """Return the episodes of consecutive seeds, so many for each place and direction."""
        recordings = self.recordings or (None,)
        return episodes_of(places, self.directions, count, first_seed, recordings)

    @property
    def steps(self) -> int:
        """Number of control steps in an episode; actions last one or several of them."""
        return self.settings.done.total_steps // physics_steps(self.settings.control.frequency)

    @property
    def period(self) -> float:
        """Length of a control step [s]."""
        return physics_steps(self.settings.control.frequency) * PHYSICS_STEP

    @cached_property
    def hash(self) -> str:
        """Twelve hexadecimal digits of what the episodes mean: the settings that have an effect and
        are not at their (first) defaults. The world in which they happen has a digest of its own
        (`eyas.engine.core.identity.build.Build.world`).
        """
        settings = self.settings.model_dump(mode="json", include=_FIXED, exclude_defaults=True)
        told = settings.setdefault("traffic", {})
        for name, former in _AS_PUBLISHED.items():
            told[name] = getattr(self.settings.traffic, name)
            if told[name] == former:
                del told[name]
        idle = (path for path, is_idle in _IDLE.items() if is_idle(self.settings))
        for path in (*_PLACED, *idle):
            *groups, name = path.split(".")
            group = settings
            for each in groups:
                group = group.get(each, {})
            group.pop(name, None)
        meaning = {name: value for name, value in settings.items() if value != {}}
        content = [meaning, self.directions, self.alike, self.first_box]
        content += [self.variants, self.team] if self.variants else []
        content += [self.recordings] if self.recordings else []
        content += [self.drawn] if self.drawn else []
        content += [
            astuple(self.envelope),
            self.farthest,
            LEAST_SIZE,
            _name_of(self.choose),
            _name_of(self.scenario),
        ]
        content += [] if self.stage is None else [_name_of(self.stage)]
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:12]

    def settings_of(
        self,
        episode: EpisodeSpec,  # The episode
        env: EnvConfig,  # What the policy sees and how it acts
    ) -> EyasConfig:
        """Return the settings of an episode."""
        place = episode.place
        map_name, map_seed = place.town
        changes: dict[str, Any] = {
            "world": {"map": map_name, "seed": map_seed, "weather": place.weather},
            "target": place.target,
            "start": {"direction": episode.direction},
        }
        if episode.traffic is not None:
            changes["traffic"] = {"seed": episode.traffic}
        own = self.variants.get(episode.variant, {})
        return updated(self.settings, _joined(changes, own)).model_copy(update={"env": env})


def _name_of(made: Callable[..., object] | None) -> str:
    """Return what stands for a function in a hash; what it does is in the digest of the program."""
    return "" if made is None else made.__qualname__
