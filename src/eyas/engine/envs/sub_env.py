"""What `call`, `get_attr` and `set_attr` of the vector environment see of one environment."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.envs.choice import steps_per_action
from eyas.engine.settings.config import EyasConfig

if TYPE_CHECKING:
    from eyas.engine.envs.vector_env import EyasVectorEnv

__all__ = ["SubEnv"]


class SubEnv:
    """One of N environments. It has the attributes that libraries ask for by name, and any that
    `set_attr` gives it.
    """

    def __init__(self, whole: "EyasVectorEnv", index: int) -> None:
        self._whole = whole
        self.index = index

    @property
    def config(self) -> EyasConfig:
        """The settings of this environment."""
        return self._whole.config_of(self.index)

    @property
    def metadata(self) -> dict[str, Any]:
        """As Gymnasium has it."""
        return self._whole.metadata

    @property
    def render_mode(self) -> str | None:
        """As Gymnasium has it."""
        return self._whole.render_mode

    @property
    def spec(self) -> Any:  # noqa: ANN401  # Gymnasium's
        """As Gymnasium has it."""
        return self._whole.spec

    @property
    def observation_space(self) -> Any:  # noqa: ANN401  # Gymnasium's
        """Space of one observation."""
        return self._whole.single_observation_space

    @property
    def action_space(self) -> Any:  # noqa: ANN401  # Gymnasium's
        """Space of one action."""
        return self._whole.single_action_space

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
        """As Gymnasium has it."""
        return self

    def render(self) -> NDArray[np.uint8] | None:
        """Return the camera's picture in its configured size, shape (H, W, 3)."""
        return self._whole.render_one(self.index)
