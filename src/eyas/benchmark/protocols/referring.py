"""The target is named in words, among others that look like it; no box is given."""

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import islice
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.episode_batch import EpisodeBatch, episode_groups
from eyas.benchmark.episodes.look_alikes import (
    HEIGHT,
    PITCH,
    StagedStart,
    case_of,
    repeat_start,
    staged_start,
)
from eyas.benchmark.flight.meter import LOOK
from eyas.benchmark.flight.scenario import Scenario
from eyas.benchmark.protocols.envelope import Envelope
from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.errors import SpawnError
from eyas.engine.policies.policy import Instruction
from eyas.engine.policies.sight import nearest_to_middle, visible_shares
from eyas.engine.settings.env import EnvConfig
from eyas.engine.sim.simulation import Simulation
from eyas.engine.targets.grammar.naming import Phrase
from eyas.engine.traffic.library import CANONICAL_MIX, DENSE_VEHICLES, TEST_TRAFFIC

_VARIANTS: Final = ("right", "other", "contradictory", "none")
_TRIED: Final = 12  # Number of seeds that are tried for each episode
_LEAST_VISIBLE: Final = 0.5  # Smallest share of the target that is visible at the start

_CHOSEN_BY: Final = 3.0
"""Time by which a policy should have chosen [s]; judged over the half second before."""

_CHOICE: Final = 0.5
_END: Final = 5.0  # Length of the end of an episode, over which success is judged [s]


def stage(simulation: Simulation, episodes: Sequence[EpisodeSpec]) -> list[StagedStart | None]:
    """Begin episodes among look-alikes; the variants of an episode begin alike.

    Returns:
        What is staged of each; None where the seed has no such start.
    """
    staged: list[StagedStart | None] = []
    first: dict[int, int] = {}
    for tracker, episode in enumerate(episodes):
        source = first.setdefault(episode.seed, tracker)
        if source == tracker:
            staged.append(staged_start(simulation, tracker, episode.seed))
        else:
            start = staged[source]
            staged.append(start)
            if start is not None:
                repeat_start(simulation, tracker, source, start)
    return staged


def among_look_alikes(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the first seeds of each place that have such a start, with a target that is seen.

    Raises:
        SpawnError: There are too few.
    """
    chosen = []
    for place in places:
        make = partial(_first_seeds, place, protocol, count, first_seed)
        inputs = (protocol.hash, place, count, first_seed)
        found = cached(EntryKind.OCCLUSION, make, inputs, of=np.ndarray)
        if len(found) < count:
            raise SpawnError(
                f"protocol '{protocol.name}': only {len(found)} of {count * _TRIED} starts in "
                f"'{place.map}' have look-alikes; {count} are needed"
            )
        chosen += [
            EpisodeSpec(place, direction, int(seed), protocol.recordings[0], variant)
            for seed in found.tolist()
            for direction in protocol.directions
            for variant in protocol.variants
        ]
    return chosen


def _first_seeds(
    place: Place, protocol: Protocol, count: int, first_seed: int
) -> NDArray[np.int64]:
    traffic = protocol.recordings[0]
    tried = [EpisodeSpec(place, 0.0, first_seed + k, traffic) for k in range(count * _TRIED)]
    return np.array(list(islice(_with_a_start(tried, protocol), count)), np.int64)


def _with_a_start(episodes: list[EpisodeSpec], protocol: Protocol) -> Iterator[int]:
    """Yield the seeds of episodes that can begin; a few are begun at a time."""
    step = 64
    for at in range(0, len(episodes), step):
        part = episodes[at : at + step]
        (group,) = episode_groups(part, protocol, EnvConfig())
        seen = visible_shares(group.subjects()[0]) >= _LEAST_VISIBLE
        for episode, start, clear in zip(part, group.staged, seen.tolist(), strict=True):
            if start is not None and clear:
                yield episode.seed


class ReferringScenario(Scenario):
    """Tells policies their targets in words, and finds out whom each of them follows: the one in
    the picture that is nearest to its middle.
    """

    def __init__(
        self, batch: EpisodeBatch, protocol: Protocol, episodes: Sequence[EpisodeSpec]
    ) -> None:
        super().__init__(batch.count)
        self._batch, self._period = batch, protocol.period
        self._variant = [episode.variant for episode in episodes]
        self._starts: dict[int, StagedStart] = {}
        for group in batch.groups:
            self._starts |= dict(zip(group.rows.tolist(), group.staged, strict=True))
        self._nearest = np.full((batch.count, protocol.steps // LOOK), -1, np.int64)
        """Whom each follows at each look; -1: nobody is in the picture."""

    def instruction(self) -> Instruction:
        """Return the words of each episode's variant."""
        phrases: list[Phrase] = [
            self._starts[row].phrases[variant] for row, variant in enumerate(self._variant)
        ]
        attributes = np.stack([phrase.attributes for phrase in phrases])
        return Instruction(tuple(phrase.words for phrase in phrases), attributes)

    def measure(self, step: int, active: NDArray[np.bool_]) -> None:
        """Find out whom the active flights follow, at every look."""
        if (step + 1) % LOOK == 0:
            nearest = self._batch.gathered(lambda group: nearest_to_middle(group.simulation))
            self._nearest[active, step // LOOK] = nearest[active]

    def figures(self, row: int) -> dict[str, float | None]:
        """Return success and choice, by variant.

        `language_gap` is twice the success with the right words, and minus twice that with
        another's: its mean over both variants is the difference of their means, and its interval,
        of whole seeds, that of the difference.
        """
        start, variant = self._starts[row], self._variant[row]
        success = self._follows(row, start.actor, self._nearest.shape[1] * self._look, _END)
        figures: dict[str, float | None] = {}
        for own in _VARIANTS:
            figures[f"success_{own}"] = success if own == variant else None
        right, other = variant == "right", variant == "other"
        chosen = self._follows(row, start.actor, _CHOSEN_BY, _CHOICE)
        figures["chosen"] = chosen if right else None
        figures["obeyed"] = success if right else None
        if other:
            last = self._nearest.shape[1] * self._look
            figures["obeyed"] = self._follows(row, start.other, last, _END)
        figures["language_gap"] = 2.0 * success * (right - other) if right or other else None
        return figures

    @property
    def _look(self) -> float:
        """Time between two looks [s]."""
        return LOOK * self._period

    def _follows(self, row: int, actor: int, until: float, length: float) -> float:
        """Return 1 if one is followed at half of the looks in a time before another [s], else 0."""
        last = round(until / self._look)
        looks = self._nearest[row, last - round(length / self._look) : last]
        return float((looks == actor).mean() >= 0.5)


REFERRING = Protocol(
    "referring",
    "20 s: the target is named in words among 1, 3 or 7 look-alikes; no box",
    {
        "traffic": {
            "demand": "keep_alive",
            "vehicle_type": CANONICAL_MIX.model_dump(),
            "max_vehicles": DENSE_VEHICLES,
        },
        "extras": [],
        "start": {"height": HEIGHT, "pitch": PITCH},
        "done": {"total_steps": 10_000, "no_reward_steps": NEVER},
    },
    directions=(0.0,),
    episodes=100,
    columns=("language_gap", *(f"success_{own}" for own in _VARIANTS[:2]), "chosen", "obeyed"),
    rank="language_gap",
    gaps=("language_gap",),
    choose=among_look_alikes,
    recordings=TEST_TRAFFIC[:1],
    stage=stage,
    scenario=ReferringScenario,
    variants={variant: {} for variant in _VARIANTS},
    first_box=False,
    envelope=Envelope(highest=HEIGHT + 3.0),
    groups={
        "phrase": lambda record: case_of(record.seed)[0].value,
        "look-alikes": lambda record: str(case_of(record.seed)[1]),
    },
)
