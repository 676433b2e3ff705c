"""One flight of five minutes with all that comes in one: how far does a policy get?"""

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.flight.meter import LOOK
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.protocols.referring import REFERRING, ReferringScenario
from eyas.engine.core.rng import stream
from eyas.engine.policies.policy import COME_BACK, Instruction
from eyas.engine.sim.simulation import Simulation
from eyas.engine.targets.grammar.claims import Claim
from eyas.engine.targets.grammar.naming import NO_PHRASE, Phrase, contradictory, phrase_about
from eyas.engine.targets.grammar.wording import Wording, in_words
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.library import TEST_TRAFFIC

STAGES: Final = {
    "found": 20.0,  # The one that is named, among others
    "followed": 70.0,  # Through crowns and shade
    "fault": 100.0,  # After the camera was covered
    "weather": 160.0,  # In fog and dusk
    "refused": 190.0,  # Still the same, after words that fit nothing in view
    "changed": 245.0,  # The other one that is named now
    "home": 300.0,  # Back where the flight began
}
"""Time by which each stage is passed [s], judged over the five seconds before."""

_JUDGED: Final = 5.0  # [s]
_FAULT: Final = (75.0, 80.0)  # While the camera is covered [s]
_TURN: Final = (110.0, 140.0)  # While the weather turns [s]
_VISIBILITY, _LIGHT = 60.0, 0.3  # Of the fog at its end [m], and share of the light
_CONTRADICTED: Final = 165.0  # When words come that fit nothing in view [s]
_CHANGED: Final = (195.0, 215.0)
"""Between which times another target is named: as soon as words tell one in view apart [s]. Where
none can be named, the first target has to be followed on."""
_HOME: Final = 250.0  # When the drone is called back [s]
_NEAR: Final = 40.0  # Distance from its start at which a drone is back [m]


class MissionScenario(ReferringScenario):
    """Says, covers and turns what the stages are about, and judges who has passed them."""

    def __init__(
        self, batch: EpisodeBatch, protocol: Protocol, episodes: Sequence[EpisodeSpec]
    ) -> None:
        super().__init__(batch, protocol, episodes)
        self._random = [stream(episode.seed, "mission") for episode in episodes]
        self._phrases = [self._starts[row].phrases["right"] for row in range(batch.count)]
        self._target = [self._starts[row].actor for row in range(batch.count)]
        self._renamed = np.zeros(batch.count, np.bool_)
        self._begun = batch.snapshot().trackers.position.copy()
        self._home = np.zeros(self._nearest.shape, np.bool_)
        self._wanted = np.full(self._nearest.shape, -2)  # -1 is who follows nobody
        self._clear = [group.simulation.snapshot.light.fog_density.copy() for group in batch.groups]

    def covered(self, step: int) -> NDArray[np.bool_]:
        """Cover all cameras for a while."""
        start, end = _FAULT
        covered: NDArray[np.bool_] = ~self._nobody & (start <= step * self._period < end)
        return covered

    def new_instruction(self, step: int) -> Instruction | None:
        """Return what is said in the middle of a flight."""
        time, before = step * self._period, list(self._phrases)
        if step == round(_HOME / self._period):
            self._phrases = [Phrase(COME_BACK, None, None)] * len(self._phrases)
        elif step == round(_CONTRADICTED / self._period):
            self._each(self._contradict)
        elif _CHANGED[0] <= time < _CHANGED[1] and step % LOOK == 0:
            self._each(self._rename)
        same = all(new is old for new, old in zip(self._phrases, before, strict=True))
        return None if same else self._said()

    def measure(self, step: int, active: NDArray[np.bool_]) -> None:
        """Turn the weather, and remember whom each flight follows and has to."""
        super().measure(step, active)
        time = (step + 1) * self._period
        turned = min(max((time - _TURN[0]) / (_TURN[1] - _TURN[0]), 0.0), 1.0)
        if 0.0 < turned and time < _TURN[1] + 1.0:
            for group, clear in zip(self._batch.groups, self._clear, strict=True):
                light = group.simulation.snapshot.light
                light.fog_density[:] = (1.0 - turned) * clear + turned / _VISIBILITY
                light.sky[:] = light.sun[:] = 1.0 - turned * (1.0 - _LIGHT)
        if (step + 1) % LOOK == 0:
            self._wanted[:, step // LOOK] = self._target
            place = self._batch.snapshot().trackers.position
            away = np.square(place - self._begun)[:, :2].sum(axis=1)
            self._home[:, step // LOOK] = active & (away <= _NEAR * _NEAR)

    def figures(self, row: int) -> dict[str, float | None]:
        """Return the share of stages that are passed in a row, and which these are."""
        followed = self._nearest[row] == self._wanted[row]
        passed, figures = True, dict[str, float | None]()
        for name, end in STAGES.items():
            last = round(end / self._look)
            looks = (self._home[row] if name == "home" else followed)[:last]
            passed &= bool(looks[-round(_JUDGED / self._look) :].mean() >= 0.5)
            figures[name] = float(passed)
        return {"score": float(np.mean([*figures.values()])), **figures}

    def _said(self) -> Instruction:
        attributes = np.stack([phrase.attributes for phrase in self._phrases])
        return Instruction(tuple(phrase.words for phrase in self._phrases), attributes)

    def _each(self, say: Callable[[Simulation, int, int], None]) -> None:
        """Say something to each drone: its simulation, its number there, its row."""
        for group in self._batch.groups:
            for own, row in enumerate(group.rows.tolist()):
                say(group.simulation, own, row)

    def _contradict(self, simulation: Simulation, own: int, row: int) -> None:
        claim = self._phrases[row].claim
        assert isinstance(claim, Claim)
        wrong = contradictory(claim, simulation.view.in_view(own), self._random[row])
        if wrong is not None:
            words = in_words(wrong, Wording.TEST, self._random[row])
            self._phrases[row] = Phrase(words, wrong, self._phrases[row].kind)

    def _rename(self, simulation: Simulation, own: int, row: int) -> None:
        if self._renamed[row]:
            return
        view = simulation.view.in_view(own)
        for other in np.flatnonzero(view.actor != self._target[row]).tolist():
            phrase = phrase_about(view, other, self._random[row], Wording.TEST)
            if phrase is not NO_PHRASE:
                self._phrases[row], self._target[row] = phrase, int(view.actor[other])
                self._renamed[row] = True
                simulation.follow(own, self._target[row])
                return


MISSION = REFERRING.like(
    "mission",
    "300 s: found by words, followed, a fault, turning weather, wrong and new words, home",
    {
        "traffic": {"vehicle_type": "passenger", "max_vehicles": TrafficConfig().max_vehicles},
        "light": {"sun": 1e-9},
        "control": {"frequency": 31.25},
        "done": {"total_steps": 150_000},
    },
    episodes=48,
    maps=("citystreet", "downtown"),
    columns=("score", *STAGES, "tsr"),
    rank="score",
    gaps=(),
    scenario=MissionScenario,
    variants={"right": {}},
    recordings=TEST_TRAFFIC[:1],
    oracles={"action_repeat": 4},
    groups={},
)
"""Where `light` changes anything, as here by nothing, a flight can change it."""
