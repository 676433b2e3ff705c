"""The Gymnasium environment: one drone, one target."""

import logging
import os
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import physics_steps
from eyas.core.config import validated
from eyas.core.errors import ConfigError
from eyas.envs.actions import ContinuousActions, DiscreteActions
from eyas.envs.config import EnvSpeeds
from eyas.settings.config import EyasConfig
from eyas.settings.file import load_settings
from eyas.settings.legacy.messages import originals_named
from eyas.settings.preset import preset_file
from eyas.settings.version_check import require_supported
from eyas.sim.build import build_simulation
from eyas.sim.worlds import each_alone
from eyas.state.draw import Picture
from eyas.targets.catalogue import MODELS
from eyas.task.done import DoneReason
from eyas.task.packets import BasicPacket, RewardPacket
from eyas.task.step_line import step_line

__all__ = ["TrackingEnv"]

Observation = NDArray[np.uint8]

_STEPS = logging.getLogger("eyas.steps")
"""Gets a line for each action if `verbose` is true."""
_STEPS.setLevel(logging.INFO)

_SENSORS = (
    *("position", "velocity", "felt_acceleration"),
    *("angular_velocity", "orientation", "euler"),
)
"""Fields of the basic packet in `info`; it has the others under names of its own."""
_REWARD = tuple(field.name for field in fields(RewardPacket))


class TrackingEnv(gymnasium.Env[Observation, Any]):
    """Keep a moving target in view.

    The observation is what the camera sees, RGB uint8, shape (84, 84, 3): the configured 4:3 view
    scaled to a square, as in the original. `info` holds by name: the sensors of the basic packet,
    which are `position` and `velocity` (GPS), `orientation` and `euler` (IMU), `angular_velocity`
    (gyroscope) and `felt_acceleration` (accelerometer); the reward packet (both:
    `eyas.task.packets`); the reason of the end (`done_reason`), the limit that the body violates in
    the original's words (`done_state`); the step count; and the values drawn from the `light`
    settings (factor on the sky, factor on the sun, one over the visibility range [1/m]).

    Args:
        config: Settings: an `EyasConfig`, nested dictionaries of native settings, the name of a
            preset (`dat-train`, `dat-eval`, `easy`), or the path of a JSON file (native or the
            original's `env_config.json`).
        map: Name of the map; overrides the configuration.
        weather: Name of the weather; overrides the configuration.
        continuous: True: four numbers in -1 to 1; False: the seven discrete actions.
        speeds: Speeds of the actions; overrides the configuration.
        observation_size: Width and height of the observation [pixels].
        render_mode: `rgb_array` or None.
        overlay: Whether `render` draws the overlay: the ground that the camera sees, the area in
            which the target is rewarded, and a marker over the target. Observations never show it.

    Raises:
        EyasError: A setting is wrong; the message is one line.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 125}  # noqa: RUF012  # Gymnasium's

    def __init__(  # noqa: PLR0913  # `gymnasium.make` takes them by name
        self,
        config: EyasConfig | Mapping[str, Any] | str | Path | None = None,
        *,
        map: str | None = None,  # the word that users know
        weather: str | None = None,
        continuous: bool = False,
        speeds: EnvSpeeds | None = None,
        observation_size: tuple[int, int] = (84, 84),
        render_mode: str | None = None,
        overlay: bool = False,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ConfigError(f"render_mode: '{render_mode}' is not allowed: 'rgb_array' or None")
        self.config = _settings(config, map, weather, speeds)
        self.render_mode = render_mode
        actions = ContinuousActions if continuous else DiscreteActions
        self._actions = actions(self.config.env.speeds)
        self.action_space = self._actions.space
        width, height = observation_size
        self.observation_space = gymnasium.spaces.Box(0, 255, (height, width, 3), np.uint8)
        self._steps_per_action = physics_steps(self.config.control.frequency)
        with originals_named(self.config):
            require_supported(self.config)
            self._simulation = build_simulation(self.config, each_alone(1))
        self._picture = Picture.create(1, height, width)
        self._render_picture: Picture | None = None
        self._overlay = overlay
        self._tracker = np.zeros(1, np.int32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start a new episode; the returned observation shows its target.

        Args:
            seed: Begin the sequence of episodes of this seed; None continues the current sequence,
                at first that of the configuration's seed.
            options: Unused.
        """
        super().reset(seed=seed)
        if seed is not None:
            self._simulation.reseed(seed)
        self._simulation.reset()
        return self._observe(), self._info()

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, dict[str, Any]]:  # noqa: ANN401  # as in Gymnasium
        """Hold an action as `control.frequency` says: for 4 physics steps of 2 ms at 125 Hz.

        Raises:
            ActionError: The action is not in the space of actions.
        """
        command = self._actions.command(action)
        result = self._simulation.advance(command, self._steps_per_action)
        done, reason = bool(result.done[0]), result.reason[0]
        truncated = done and reason == DoneReason.STEP_LIMIT
        if self.config.verbose:
            _STEPS.info("%s", step_line(self._simulation.snapshot, 0, "DRONE0"))
        info = self._info()
        info["reward_terms"] = {name: float(term[0]) for name, term in result.terms.items()}
        return self._observe(), float(result.reward[0]), done and not truncated, truncated, info

    def render(self) -> Observation | None:
        """Return the camera's picture in its configured size, shape (H, W, 3)."""
        if self.render_mode is None:
            return None
        if self._render_picture is None:
            camera = self.config.camera
            self._render_picture = Picture.create(1, camera.height, camera.width)
        self._simulation.draw(self._tracker, self._render_picture, overlay=self._overlay)
        return _copy(self._render_picture)

    def _observe(self) -> Observation:
        self._simulation.draw(self._tracker, self._picture)
        return _copy(self._picture)

    def _info(self) -> dict[str, Any]:
        snapshot = self._simulation.snapshot
        basic, reward = self._simulation.packets()
        model = MODELS[snapshot.targets.model[0]]
        return {
            **_named(BasicPacket.from_row(basic[0]), _SENSORS),
            **_named(RewardPacket.from_row(reward[0], model.typename), _REWARD),
            "step": int(snapshot.episodes.step_count[0]),
            "done_reason": DoneReason(int(snapshot.episodes.reason[0])).name.lower(),
            "done_state": DoneReason(int(snapshot.episodes.breach[0])).original,
            "light": snapshot.light[0].copy(),
        }


def _named(packet: BasicPacket | RewardPacket, names: tuple[str, ...]) -> dict[str, Any]:
    """Return fields of a packet; `dataclasses.asdict` takes ten times as long."""
    return {name: getattr(packet, name) for name in names}


def _copy(picture: Picture) -> Observation:
    assert picture.rgb is not None
    return np.array(picture.rgb[0])


def _settings(
    config: EyasConfig | Mapping[str, Any] | str | Path | None,
    map_name: str | None,
    weather: str | None,
    speeds: EnvSpeeds | None,
) -> EyasConfig:
    match config:
        case None:
            settings = EyasConfig()
        case EyasConfig():
            settings = config
        case Mapping():
            settings = validated(EyasConfig, dict(config))
        case str() if "." not in config and not os.path.exists(config):
            settings = load_settings(preset_file(config))
        case _:
            settings = load_settings(Path(config))
    world = {"map": map_name, "weather": weather}
    changed = {key: value for key, value in world.items() if value is not None}
    changes: dict[str, object] = {}
    if changed:
        changes["world"] = settings.world.model_copy(update=changed)
    if speeds is not None:
        changes["env"] = settings.env.model_copy(update={"speeds": speeds})
    return settings.model_copy(update=changes)
