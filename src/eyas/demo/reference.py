"""Flights of a protocol by people, for a leaderboard: each episode once, in real time.

The person sees the pictures that a policy would get, 31 in a second, and the target's box before
the flight begins. What is held at each look is logged, see `eyas.benchmark.policies.person`.
"""

import queue
import statistics
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.evaluation import run
from eyas.benchmark.flight.batch_flight import clear_shares
from eyas.benchmark.flight.policy_runner import fly_batch, solvable
from eyas.benchmark.plan.plan import EvaluationPlan, check
from eyas.benchmark.policies.person import Attempt, Flown, append, in_spans, read_log
from eyas.benchmark.policies.table import FLIGHTS, PERSON
from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.records.result import STAMP
from eyas.benchmark.report.leaderboard.submission import write_people
from eyas.demo import messages as said
from eyas.demo.controls import camera_turn, command_of
from eyas.demo.flight_thread import Audience
from eyas.demo.frame import DemoFrame
from eyas.demo.session import SILENCE
from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.core.faults import FaultLog
from eyas.engine.core.files import refusals
from eyas.engine.envs.actions import FourNumbers
from eyas.engine.policies.policy import Decision, Failure, PolicyInput, Start, env_config

SIZE = {"width": 640, "height": 480}  # Of the pictures that people see [pixels]
REPEAT = 4  # Control steps of 8 ms between two of them
COUNTDOWN = 3.0  # Time over which the first picture is shown with the target's box [s]
PATIENCE = 5.0  # Time after which a flight is left whose page says nothing [s]
FILE = f"people{FLIGHTS}"


def plan_for(protocol: str, out: Path, **choices: Any) -> EvaluationPlan:  # noqa: ANN401
    """Return what people fly; the log of their flights is made in the folder if it is not there.

    Args:
        choices: Fields of the plan, such as `maps` and `episodes`.

    Raises:
        EyasError: The protocol cannot be flown by a person, or something else is wrong.
    """
    path = out / FILE
    plan = EvaluationPlan(policy=str(path), protocol=protocol, batch=1, **choices)
    if plan.rules.team:
        raise ConfigError(
            f"--record-for: '{protocol}' is not allowed: several drones fly in it; allowed: "
            "protocols with one drone"
        )
    gimbal = plan.rules.envelope.gimbal is not None
    env = {
        "actions": "velocity+gimbal" if gimbal else "velocity",
        "action_repeat": REPEAT,
        "observation": SIZE,
    }
    if not path.exists():
        with refusals(out):
            out.mkdir(parents=True, exist_ok=True)
        append(path, {"env": env})
    check(plan)
    return plan


class _EndedError(EyasError):
    """The demo is ended; what is flown is kept."""


class ReferenceThread:
    """Flies the episodes of a plan with whoever has the controls; see `FlightThread`.

    Attributes:
        stage: What pages are told: which flight is made, is ready, or that all are over.
    """

    def __init__(self, plan: EvaluationPlan, audience: Audience) -> None:
        self._plan, self._audience = plan, audience
        self._path = Path(plan.policy)
        self._inbox: queue.SimpleQueue[said.Message | None] = queue.SimpleQueue()
        self._faults = FaultLog()
        self._stopped, self._left, self._heard = False, "", 0.0
        self._ready: said.ReadyMessage | None = None
        self._held: dict[Any, float] = {}
        self._source = 0, 0.0
        self._frames = 0
        self._sent: dict[int, float] = {}
        self._delays: list[float] = []
        self.stage: dict[str, Any] = {"stage": "making"}

    def put(self, message: said.Message) -> None:
        """Take what the pilot says; may be called in any thread."""
        self._inbox.put(message)

    def stop(self) -> None:
        """End `run`; may be called in any thread."""
        self._inbox.put(None)

    def run(self) -> None:
        """Fly what is left, until all episodes are flown, or `stop`.

        Raises:
            EyasError: A flight cannot be made or written.
        """
        out = self._path.parent
        try:
            resume = (out / STAMP).exists()
            run(self._plan, out, resume=resume, quiet=True, runner=self._fly_all)
        except _EndedError:
            return
        write_people(out)
        self._tell(stage="over", folder=str(out))
        self.hear(time.monotonic() + 1.0)  # until pages have it

    def _tell(self, **stage: Any) -> None:  # noqa: ANN401  # JSON
        self.stage = stage
        self._audience.tell({"reference": stage})

    def _fly_all(
        self, plan: EvaluationPlan, parts: list[list[EpisodeSpec]], _: list[float]
    ) -> Iterator[list[EpisodeRecord]]:
        """Yield the record of each episode, see `Runner`."""
        total = plan.count
        for number, part in enumerate(parts, total - len(parts) + 1):
            if self._stopped:
                raise _EndedError
            log = read_log(self._path)
            if part[0].name in log.of_episodes:  # begun, but not recorded, when the demo ended
                yield from fly_batch(plan, part)
                continue
            where = {"number": number, "total": total, "map": part[0].place.map}
            self._tell(stage="making", **where)
            clear_shares(part, plan.rules)  # kept in the cache, so that a flight begins at once
            solvable(part, plan.rules)
            ready = self._wait_for_pilot(where)
            attempt = len(log.attempts) + 1
            append(self._path, Attempt(attempt=attempt, episode=part[0].name, **ready.model_dump()))
            yield self._fly(plan, part, attempt)

    def _wait_for_pilot(self, where: dict[str, Any]) -> said.ReadyMessage:
        self._ready = None
        self._tell(stage="ready", **where)
        while self._ready is None:
            if self._stopped:
                raise _EndedError
            self.hear(time.monotonic() + 0.1)
        return self._ready

    def _fly(
        self, plan: EvaluationPlan, part: list[EpisodeSpec], attempt: int
    ) -> list[EpisodeRecord]:
        """Fly one episode, and log what was done in it."""
        self._left, self._held, self._delays, self._sent = "", {}, [], {}
        self._heard = time.monotonic() + COUNTDOWN  # pages may be slow to begin
        pilot = _Pilot(self, read_log(self._path).env)
        records = [one for ended in fly_batch(plan, part, policy=pilot) for one in ended]
        delay = round(1e3 * statistics.median(self._delays), 1) if self._delays else None
        flown = Flown(
            attempt=attempt,
            actions=in_spans(pilot.actions),
            left=pilot.left,
            picture_ms=delay,
            pace=pilot.pace,
        )
        append(self._path, flown)
        return records

    def hear(self, until: float) -> None:
        """Take messages until a time [s]."""
        while True:
            left = until - time.monotonic()
            try:
                message = self._inbox.get(timeout=left) if left > 0 else self._inbox.get_nowait()
            except queue.Empty:
                return
            if message is None:
                self._stopped = True
                return
            with self._faults.guard(f"message {type(message).__name__}"):
                self._take(message)

    def _take(self, message: said.Message) -> None:
        now = time.monotonic()
        if isinstance(message, said.KeysMessage):
            self._held, self._heard = dict(message.held), now
            self._source = message.sequence, message.time
        elif isinstance(message, said.AckMessage):
            if (sent := self._sent.pop(message.frame, None)) is not None:
                self._delays.append(now - sent)
        elif isinstance(message, said.ReadyMessage):
            self._ready = message
        elif isinstance(message, said.LeaveMessage):
            self._left = "left by the pilot"
        elif not isinstance(message, said.LookMessage):
            self._audience.tell({"error": "message: not while flights are recorded"})

    def left(self) -> str:
        """Return why the flight is left; empty: it is not."""
        if self._stopped:
            return "the demo was ended"
        if time.monotonic() - self._heard > PATIENCE:
            return f"the page said nothing for {PATIENCE:g} s"
        return self._left

    def held(self) -> dict[Any, float]:
        """Return the controls that are held now."""
        return self._held if time.monotonic() - self._heard < SILENCE else {}

    def show(self, picture: Any, **state: Any) -> None:  # noqa: ANN401  # JSON
        """Send a picture, with what is told beside it, to all who can take one."""
        if self._audience.wants_frame():
            self._frames += 1
            sequence, changed = self._source
            told = {"frame": self._frames, "sequence": sequence, "input": changed, **state}
            self._sent[self._frames] = time.monotonic()
            self._audience.show(DemoFrame(self._frames, told, picture))


class _Pilot:
    """A policy: whoever has the controls. Each look waits for its time."""

    sampled = False
    told = frozenset({PERSON, "box", "words"})

    def __init__(self, thread: ReferenceThread, env: Any) -> None:  # noqa: ANN401  # settings
        self._thread, self.env = thread, env_config(env)
        self.actions: list[tuple[float, ...]] = []
        self.left = ""
        self.pace: float | None = None
        self._begun = self._start = 0.0

    def begin(self, start: Start) -> None:
        """Find the target's box, in shares of the picture's sides."""
        box, size = start.boxes()[0].tolist(), self.env.observation
        sides = (size.width, size.height) * 2
        self._box = [at / side for at, side in zip(box, sides, strict=True)] if any(box) else None
        self._words = None if start.told is None else start.told.words[0]

    def act(self, sight: PolicyInput) -> Decision:
        """Show the picture when its time has come, and do what is held then."""
        assert isinstance(sight.observation, np.ndarray)
        assert sight.clock is not None
        picture, thread = sight.observation[0], self._thread
        if sight.told is not None:
            self._words = sight.told.words[0]
        if not self.actions:
            self._count_down(picture)
        thread.hear(self._begun + sight.clock)
        late = time.monotonic() - self._begun - sight.clock
        self._begun += max(late, 0.0)  # a slow machine flies slower, not farther at a time
        passed = time.monotonic() - self._start
        self.pace = round(sight.clock / passed, 3) if passed > 1.0 else None
        thread.show(picture, stage="flying", time=round(sight.clock, 2), words=self._words)
        held = thread.held()
        numbers = (command_of(held)[0] * FourNumbers.UNITS).tolist()
        if self.env.actions.gimbal:
            numbers += [PHYSICS_RATE * turn for turn in camera_turn(held)]
        action = tuple(numbers)
        if why := thread.left():
            self.left = f"{why} after {sight.clock:.1f} s"
            return Decision([action], {0: Failure(self.left, None)})
        self.actions.append(action)
        return Decision([action])

    def _count_down(self, picture: Any) -> None:  # noqa: ANN401  # pixels
        end = time.monotonic() + COUNTDOWN
        while (left := end - time.monotonic()) > 0.0 and not self._thread.left():
            self._thread.show(
                picture, stage="countdown", left=round(left, 1), box=self._box, words=self._words
            )
            self._thread.hear(min(time.monotonic() + 0.2, end))
        self._begun = self._start = time.monotonic()
