"""Flies a batch of episodes with one policy."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.episodes.from_above import seen_from_above
from eyas.benchmark.flight.meter import Meter
from eyas.benchmark.flight.scenario import Scenario
from eyas.benchmark.flight.team_radio import Radio
from eyas.benchmark.plan.latency import Delay
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.records.record import EpisodeRecord
from eyas.engine.core.errors import ActionError
from eyas.engine.envs.actions import command_width, make_actions
from eyas.engine.policies.policy import Decision, Failure, Policy, PolicyInput, Start
from eyas.engine.policies.steering import PERIOD

_PERIOD = 0.128  # Time between two looks [s]


def clear_shares(episodes: list[EpisodeSpec], protocol: Protocol) -> list[float]:
    """Return the mean share of each target that nothing hides from a drone exactly above it."""
    seen = seen_from_above(episodes, protocol, _PERIOD)
    shares: list[float] = seen.shares.mean(axis=1).tolist()
    return shares


Mask = NDArray[np.bool_]

Watcher = Callable[[EpisodeBatch, Meter], None]  # Called after each control step, for films


class BatchFlight:
    """A batch of episodes that begin together.

    Attributes:
        answers: How long each call of the policy has taken [s].

    Args:
        delay: How long its answers take; until then the last action is held, and the policy takes
            no new picture.
    """

    def __init__(
        self, episodes: list[EpisodeSpec], protocol: Protocol, policy: Policy, delay: Delay
    ) -> None:
        self._episodes, self._protocol, self._policy = episodes, protocol, policy
        self._delay = delay
        self._batch = EpisodeBatch(episodes, protocol, policy.env)
        make = protocol.scenario
        self._scenario = (
            Scenario(len(episodes)) if make is None else make(self._batch, protocol, episodes)
        )
        self._radio = Radio(episodes, protocol) if protocol.team else None
        self._meter = Meter(self._batch, protocol)
        self._actions = make_actions(policy.env)
        count = len(episodes)
        self._active = np.ones(count, np.bool_)
        self._failed: dict[int, Failure] = {}
        width = command_width(policy.env.actions)
        self._commands = np.zeros((count, width))
        self._next = np.zeros((count, width))
        self._ready = np.zeros(count, np.int64)
        """Control step from which each policy can look again."""
        self._effective = np.zeros(count, np.int64)
        """Control step from which its next command holds."""
        self.answers: list[float] = []

    def fly(self, watcher: Watcher | None = None) -> Iterator[list[EpisodeRecord]]:
        """Yield the records of the episodes that end, whenever some end."""
        seeds = np.array([episode.seed for episode in self._episodes])
        clear = clear_shares(self._episodes, self._protocol)
        self._delay.begin(seeds.tolist())
        self._told = words = self._scenario.instruction()
        self._batch.tell(words)
        start = Start(seeds, self._boxes, words, self._batch.roads, self._batch.is_open)
        self._guarded(lambda: self._policy.begin(start))
        told = np.zeros(len(seeds), np.bool_)
        for step in range(self._protocol.steps):
            self._batch.covered[:] = self._scenario.covered(step)
            if (new := self._scenario.new_instruction(step)) is not None:
                self._batch.tell(new)
                self._told = new
            self._answer(step)  # before the next look, whose answer takes this one's place
            self._decide(step)
            self._answer(step)
            self._batch.advance(self._held(), self._active)
            self._meter.measure(self._active)
            self._scenario.measure(step, self._active)
            self._active &= self._meter.reason == 0
            if watcher is not None:
                watcher(self._batch, self._meter)
            if len(ended := np.flatnonzero(self._scenario.over(self._active) & ~told)):
                told[ended] = True
                yield [
                    self._meter.record(
                        row,
                        self._episodes[row],
                        clear[row],
                        self._failed.get(row),
                        self._scenario.figures(row),
                    )
                    for row in ended.tolist()
                ]
            if not self._active.any():
                return
        raise AssertionError("the number of steps ends each episode")

    def _held(self) -> NDArray[np.float64]:
        """Return the commands, those that climb inside the protocol's heights."""
        if not self._commands[:, 2].any():
            return self._commands
        return self._protocol.envelope.held(self._commands, self._batch.heights())

    def _answer(self, step: int) -> None:
        """Let those actions hold whose latency is over."""
        effective = self._effective <= step
        self._commands[effective] = self._next[effective]

    def _decide(self, step: int) -> None:
        """Let the policy look and choose actions, for those that are ready."""
        deciding = self._active & (self._ready <= step)
        if not deciding.any():
            return
        self._batch.look(deciding, np.full(len(deciding), step == 0))
        batch = self._batch
        heard = None if self._radio is None else self._radio.heard()
        sight = PolicyInput(
            observation=batch.observations,
            deciding=deciding,
            snapshot=batch.snapshot,
            visible=batch.visible,
            covered=batch.covered,
            heard=heard,
            clock=step * self._protocol.period,
            told=self._told,
        )
        begun = time.perf_counter()
        decision = self._guarded(lambda: self._policy.act(sight))
        taken = time.perf_counter() - begun
        self.answers.append(taken)
        if decision is None:
            return
        for row, failure in decision.failed.items():
            self._fail(row, failure)
        deciding &= self._active
        if self._radio is not None and decision.messages is not None:
            self._radio.say(deciding, decision.messages)
        self._take(decision.actions, deciding)
        # Policies count control steps of 8 ms, whichever the protocol has.
        held = self._policy.env.action_repeat * PERIOD
        repeat = max(map(self._control_steps, (PERIOD, held, self._delay.period)))
        for row in np.flatnonzero(deciding & self._active).tolist():
            late = self._control_steps(self._delay.next(row, taken))
            self._effective[row] = step + late
            self._ready[row] = step + max(late, repeat)

    def _control_steps(self, seconds: float) -> int:
        """Return a time in control steps, rounded up; 1e-9 ignores the quotient's rounding
        error.
        """
        return int(np.ceil(seconds / self._protocol.period - 1e-9))

    def _take(self, actions: Any, deciding: Mask) -> None:  # noqa: ANN401  # a policy's
        """Set the next commands; those whose action is not allowed fail."""
        for row in np.flatnonzero(deciding).tolist():
            try:
                self._next[row] = self._actions.commands([actions[row]])[0]
            except (ActionError, IndexError, KeyError, TypeError) as error:
                self._fail(row, Failure.of(error, traced=False))

    def _guarded(self, call: Callable[[], Decision | None]) -> Decision | None:
        """Call the policy; if it raises, all its episodes have failed."""
        try:
            return call()
        except Exception as error:  # whatever a user's code raises is a record
            for row in np.flatnonzero(self._active).tolist():
                self._fail(row, Failure.of(error))
            return None

    def _fail(self, row: int, failure: Failure) -> None:
        self._failed[row] = failure
        self._active[row] = False

    def _boxes(self) -> NDArray[np.int32]:
        if not self._protocol.first_box:
            return np.zeros((len(self._episodes), 4), np.int32)
        image = self._policy.env.observation
        size = image.height, image.width
        boxes: NDArray[np.int32] = self._batch.gathered(lambda group: group.subjects(size)[1])
        return boxes
