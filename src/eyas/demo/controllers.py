"""Who flies in the place of the keys: a policy, or a tracker of boxes; and duels of both."""

import math
import time
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.table import open_policy
from eyas.demo.flight import DemoFlight
from eyas.engine.core.clock import PHYSICS_RATE, physics_steps
from eyas.engine.core.errors import ConfigError
from eyas.engine.envs.actions import make_actions
from eyas.engine.envs.observation import Observer
from eyas.engine.policies.policy import PolicyInput, Start
from eyas.engine.policies.sight import subjects, visible_shares

SEED = 7  # Seed of the episode that is flown, so that results of different days compare
SECONDS = 60
READY = 3.0  # Seconds before each flight in which everything stands still


class Duel:
    """The two flights, by a person and a policy. A score is the mean reward, 0 to 100."""

    def __init__(self, policy: str, now: float) -> None:
        self.policy, self.stage = policy, "you"
        self._sums = {"you": 0.0, "policy": 0.0}
        self._steps = {"you": 0, "policy": 0}
        self._from = now + READY

    def waits(self, now: float) -> bool:
        """Return whether the next flight has not begun."""
        return now < self._from

    def count(self, reward: float, steps: int, now: float) -> bool:
        """Count steps with a reward; return whether a flight has ended with them."""
        if self.stage == "over":
            return False
        self._sums[self.stage] += reward * steps
        self._steps[self.stage] += steps
        if self._steps[self.stage] < SECONDS * PHYSICS_RATE:
            return False
        self.stage = "policy" if self.stage == "you" else "over"
        self._from = now + READY
        return True

    def state(self, now: float) -> dict[str, Any]:
        """Return stage, scores and seconds left."""
        steps = self._steps.get(self.stage, 0)
        return {
            "policy": self.policy,
            "stage": self.stage,
            "ready": round(max(self._from - now, 0.0), 1) if self.stage != "over" else 0.0,
            "left": round(SECONDS - steps / PHYSICS_RATE, 1),
            "scores": {
                who: round(100.0 * total / max(self._steps[who], 1), 1)
                for who, total in self._sums.items()
            },
        }


Commands = NDArray[np.float64]


class Controller(Protocol):
    """Flies the drone."""

    def decide(self) -> tuple[Commands, int]:
        """Return a command, see `Simulation.advance`, and for how many physics steps it holds."""
        ...


class PolicyController:
    """Lets a policy fly, from now on.

    Args:
        name: Name of the policy.
        flight: What it flies; it ends with this flight's world.

    Raises:
        EyasError: There is no such policy, or what it needs is not installed.
    """

    def __init__(self, name: str, flight: DemoFlight) -> None:
        self._name = name
        self._policy = open_policy(name, {})
        env = self._policy.env
        self._simulation = flight.simulation
        self._observer = Observer(env.observation, flight.simulation)
        self._actions = make_actions(env)
        self._steps = physics_steps(flight.config.control.frequency) * env.action_repeat
        self._size = env.observation.height, env.observation.width
        self._begun = np.ones(1, np.bool_)
        seeds = np.array([flight.seed])
        roads = self._simulation.scene.network
        self._policy.begin(Start(seeds, self._boxes, roads=lambda: [roads]))

    def decide(self) -> tuple[Commands, int]:
        """Ask the policy.

        Raises:
            EyasError: It fails, or its action is not allowed.
        """
        self._observer.look(np.zeros(1, np.int32), self._begun)
        self._begun = np.zeros(1, np.bool_)
        observation = self._observer.one(0)
        batch = (
            {name: part[None] for name, part in observation.items()}
            if isinstance(observation, dict)
            else observation[None]
        )
        sim = self._simulation
        sight = PolicyInput(
            observation=batch,
            deciding=np.ones(1, np.bool_),
            snapshot=lambda: sim.snapshot,
            visible=self._visible,
            covered=np.zeros(1, np.bool_),
        )
        try:
            decision = self._policy.act(sight)
        except Exception as error:  # whatever a user's code raises; the demo goes on
            said = " ".join(f"{type(error).__name__}: {error}".split())[:300]
            raise ConfigError(f"policy '{self._name}': failed: {said}") from error
        if decision.failed:
            raise ConfigError(f"policy '{self._name}': failed: {decision.failed[0]}")
        return self._actions.commands(decision.actions), self._steps

    def _boxes(self) -> NDArray[np.int32]:
        return subjects(self._simulation, np.zeros(1, np.int32), self._size)[1]

    def _visible(self) -> NDArray[np.float64]:
        return visible_shares(subjects(self._simulation, np.zeros(1, np.int32))[0])


class BoxController:
    """Flies by the boxes that a tracker outside sees in the pictures of the drone's camera.

    The middle of the box is taken for a point of the ground under a camera that looks down, and
    the drone flies to it with a speed in proportion to its distance, as the original's does.

    Args:
        flight: What it flies.
    """

    GAIN, FASTEST = 1.5, 12.0
    """Speed for each metre [1/s]; largest speed [m/s], the original's."""
    PATIENCE = 0.5
    """Longest time that a box holds [s]."""
    STEPS = 4

    def __init__(self, flight: DemoFlight) -> None:
        self._flight = flight
        self._offset = np.zeros(2)
        self._until = 0.0

    def see(self, box: tuple[float, float, float, float] | None, size: tuple[int, int]) -> None:
        """Take a box in shares of the sides of a picture of a size: width, height [pixels]."""
        self._until = time.monotonic() + self.PATIENCE
        self._offset[:] = 0.0
        if box is None:
            return
        snapshot = self._flight.simulation.snapshot
        across = 0.5 - 0.5 * (box[0] + box[2])
        up = (0.5 - 0.5 * (box[1] + box[3])) * size[1] / size[0]
        camera = self._flight.config.camera
        wider = max(1.0, size[0] / size[1] * camera.height / camera.width)
        high = float(snapshot.cameras.position[0, 2] - snapshot.targets.position[0, 2])
        wide = 2.0 * high * wider * math.tan(0.5 * float(snapshot.cameras.field_of_view[0]))
        self._offset[:] = up * wide, across * wide

    def decide(self) -> tuple[Commands, int]:
        """Fly to the box; hover without one."""
        offset = self._offset if time.monotonic() < self._until else np.zeros(2)
        speed = np.clip(self.GAIN * offset, -self.FASTEST, self.FASTEST)
        return np.array([[speed[0], speed[1], 0.0, 0.0]]), self.STEPS
