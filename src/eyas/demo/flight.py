"""The flight of the demo: one drone whose episode never ends by itself."""

import numpy as np
from numpy.typing import NDArray

from eyas.demo.controls import CAMERA_PITCH, CAMERA_YAW, Control, Held, camera_turn
from eyas.demo.messages import RewardMessage
from eyas.demo.world import build_world
from eyas.engine.core.config import updated
from eyas.engine.settings.config import EyasConfig
from eyas.engine.task.rules import lenient, make_rules

__all__ = ["DemoFlight"]

_FAR = 30.0  # Distance from which on a pilot does not fly to a target, but appears there [m]
_WARNING = 1000  # Physics steps before the end of the traffic at which it begins anew


class DemoFlight:
    """A drone, its target and its world.

    Attributes:
        config: The settings; those of the reward change while it flies.
        world: Simulation and map.

    Args:
        vehicles: Largest number of vehicles that drive.

    Raises:
        EyasError: The world cannot be built.
    """

    def __init__(self, config: EyasConfig, vehicles: int) -> None:
        self.config, self.vehicles = config, vehicles
        self.world = build_world(config, vehicles)
        self.simulation = self.world.simulation
        self._start_pitch = 0.0
        self.simulation.reset()
        self._begin(self.world.parked)

    @property
    def target(self) -> int:
        """The actor that is followed."""
        return int(self.simulation.snapshot.targets.actor[0])

    def reset(self, seed: int | None = None) -> None:
        """Put the drone back over its target, or begin the one episode of a seed."""
        target = self.target
        if seed is not None:
            self.simulation.reseed(seed)
            self.simulation.rewind()
        self.simulation.reset()
        if seed is None:
            self._begin(target)
        elif self.target == self.world.parked:
            self.follow_next()
            self._begin(self.target)

    def _begin(self, target: int) -> None:
        """Begin over a target."""
        if target >= 0:
            self.simulation.follow(0, target)
        # In one step it comes to its place, in the next it has no speed.
        self.simulation.carry(2)
        self.simulation.restart_count(0)
        self._start_pitch = float(self.simulation.snapshot.trackers.commanded_gimbal[0, 0])

    def fly(self, command: NDArray[np.float64], steps: int, held: Held) -> None:
        """Hold a command, see `Simulation.advance`, and turn the camera by the held controls."""
        self._aim(held, steps)
        self.simulation.advance(command, steps)
        if self.simulation.steps_left < _WARNING:
            self.simulation.rewind()
            self.reset()

    def _aim(self, held: Held, steps: int) -> None:
        angles = self.simulation.snapshot.trackers.commanded_gimbal.copy()
        if Control.CAMERA_CENTRE in held:
            angles[0] = self._start_pitch, 0.0
        pitch, yaw = camera_turn(held)
        if pitch:
            angles[0, 0] = np.clip(angles[0, 0] + steps * pitch, *CAMERA_PITCH)
        if yaw:
            angles[0, 1] = np.clip(angles[0, 1] + steps * yaw, *CAMERA_YAW)
        self.simulation.command_gimbal(angles)

    def follow(self, actor: int) -> None:
        """Make an actor the target.

        Raises:
            SpawnError: There is no such actor.
        """
        self.simulation.follow(0, actor)

    def appear(self) -> bool:
        """Put the drone over its target if that is far away; return whether it was.

        A pilot that flies straight to it would come through houses.
        """
        actors, _ = self.simulation.actors_around(0)
        drone = self.simulation.snapshot.trackers.position[0]
        apart = actors.position[0, self.target, :2] - drone[:2]
        if np.hypot(*apart) <= _FAR:
            return False
        self.reset()
        return True

    def follow_next(self) -> None:
        """Make the next actor that is in the world the target."""
        state, _ = self.simulation.actors_around(0)
        here = np.flatnonzero(state.present[0])
        later = here[here > self.target]
        if len(here):
            self.follow(int(later[0] if len(later) else here[0]))

    def change_reward(self, said: RewardMessage) -> None:
        """Change settings of the reward, from the next step on."""
        self.config = updated(self.config, {"reward": said.model_dump(exclude_none=True)})
        self._obey()

    def adopt_reward(self, other: "DemoFlight") -> None:
        """Take the settings of the reward that sliders have changed in another flight."""
        self.config = self.config.model_copy(update={"reward": other.config.reward})
        self._obey()

    def _obey(self) -> None:
        config = self.config
        rules = make_rules(config.reward, config.done, config.camera)
        self.simulation.rules = rules if self.simulation.judged else lenient(rules)
