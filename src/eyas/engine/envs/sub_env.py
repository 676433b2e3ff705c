"""One environment of N, as `call`, `get_attr` and `set_attr` of the vector environment see it."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.envs.choice import steps_per_action
from eyas.engine.settings.config import EyasConfig

if TYPE_CHECKING:
    from eyas.engine.envs.vector_env import EyasVectorEnv


class SubEnv:
    """One of N environments. It has the attributes that libraries ask for by name, and any that
    `set_attr` gives it.
    """

    def __init__(self, whole: "EyasVectorEnv", index: int) -> None:
        self._whole = whole
        self.index = index
        self.metadata, self.render_mode = whole.metadata, whole.render_mode
        self.observation_space = whole.single_observation_space
        self.action_space = whole.single_action_space

    @property
    def config(self) -> EyasConfig:
        """The settings of this environment."""
        return self._whole.config_of(self.index)

    @property
    def spec(self) -> Any:  # noqa: ANN401  # Gymnasium's
        """The specification, which `gymnasium.make_vec` adds later."""
        return self._whole.spec

    @property
    def _max_episode_steps(self) -> int:
        """Largest number of actions in an episode; LeRobot asks for it by this name."""
        return -(-self.config.done.total_steps // steps_per_action(self.config))

    @property
    def task(self) -> str:
        """The task in words; LeRobot's name."""
        return "track"

    @property
    def task_description(self) -> str:
        """The task in a sentence; LeRobot's name."""
        world = self.config.world
        target = self._whole.words_of(self.index)
        return (
            f"Keep the target, {target}, in view of the drone's camera "
            f"({world.map}, {world.weather})."
        )

    @property
    def unwrapped(self) -> "SubEnv":
        """This environment, which wraps none."""
        return self

    def render(self) -> NDArray[np.uint8] | None:
        """Return the camera's picture in its configured size, shape (H, W, 3)."""
        return self._whole.render_one(self.index)
