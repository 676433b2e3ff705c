"""Policies that stable-baselines3 has saved."""

import json
import logging
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eyas.engine.core.config import shown
from eyas.engine.core.errors import DataFileError, MissingExtraError
from eyas.engine.envs.trained_with import ELSEWHERE, trained_with
from eyas.engine.policies.policy import Decision, PolicyInput, Start, env_config

_LOG = logging.getLogger("eyas")

_SIGNS = {
    "clip_range": "PPO",
    "policy_delay": "TD3",
    "target_entropy": "SAC",
    "exploration_rate": "DQN",
    "use_sde": "A2C",
}
"""Settings that tell the algorithm of a file, the most telling first."""


class Sb3Policy:
    """A model of stable-baselines3: PPO, A2C, DQN, SAC or TD3.

    Size, colours and layout of its pictures follow from its observation space, and the kind of its
    actions from its action space, on which environments of Eyas write all other settings of `env`.

    Args:
        path: The `.zip`. It holds pickles, which run code: load only files that you trust.
        sampled: Whether actions are sampled; not repeatable, as the library seeds no single ones.

    Raises:
        DataFileError: The file is not such a model.
        MissingExtraError: stable-baselines3 is not installed.
    """

    told: frozenset[str] = frozenset()

    def __init__(self, path: Path, changes: Mapping[str, Any], *, sampled: bool) -> None:
        self._model = _loaded(path)
        shape = self._model.observation_space.shape
        if shape is None or len(shape) != 3:
            raise DataFileError(f"{path}: its observations are not pictures")
        first = shape[0] < shape[2]
        planes, height, width = shape if first else (shape[2], shape[0], shape[1])
        grey = planes % 3 != 0
        image = {
            "width": width,
            "height": height,
            "layout": "chw" if first else "hwc",
            "colours": "grey" if grey else "rgb",
            "frames": planes if grey else planes // 3,
        }
        discrete = hasattr(self._model.action_space, "n")
        space = self._model.action_space
        actions = "discrete" if discrete else "shares"
        if space.n == 11 if discrete else space.shape == (6,):
            actions += "+gimbal"
        trained = trained_with(space)
        own = _part(trained, "env")
        if own:
            actions = own.get("actions", actions)
            seen = _part(own, "observation")
            colours, frames = seen.get("colours"), seen.get("frames")
            # No wrapper has changed them.
            if isinstance(frames, int) and planes == (1 if colours == "grey" else 3) * frames:
                image |= {"colours": colours, "frames": frames}
        elif "action_repeat" not in changes:
            _LOG.warning(
                "%s: does not say with which env.action_repeat it was trained; 1 is taken: "
                "--set env.action_repeat=4 changes it",
                path,
            )
        self.env = env_config({**own, "observation": image, "actions": actions}, changes)
        _tell_others(path, trained)
        self.sampled = sampled

    def begin(self, start: Start) -> None:
        """Seed the drawing of actions."""
        self._model.set_random_seed(int(start.seeds[0]) % 2**32)

    def act(self, sight: PolicyInput) -> Decision:
        """Predict."""
        actions, _ = self._model.predict(sight.observation, deterministic=not self.sampled)
        return Decision(actions)


def _part(values: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """Return a group of a description; none if it is not there."""
    part = values.get(name)
    return part if isinstance(part, Mapping) else {}


def _tell_others(path: Path, trained: Mapping[str, Any]) -> None:
    """Name the settings that a model was trained with and that only --set gives it in a protocol.

    Of the start that is its velocity: where flights begin is the protocol's matter.
    """
    others = [
        f"{group}.{name}={shown(value)}"
        for group in ELSEWHERE
        for name, value in _part(trained, group).items()
        if group != "start" or name == "velocity"
    ]
    if others:
        _LOG.warning(
            "%s: was trained with %s; flown with those of the protocol unless --set names them",
            path,
            ", ".join(others),
        )


def _loaded(path: Path) -> Any:  # noqa: ANN401  # a model of any class
    try:
        import stable_baselines3
        import torch
    except ImportError as error:
        raise MissingExtraError("a policy of stable-baselines3", "train") from error
    torch.set_num_threads(1)
    try:
        with zipfile.ZipFile(path) as file:
            settings = json.loads(file.read("data"))
        name = next(_SIGNS[sign] for sign in _SIGNS if sign in settings)
        return getattr(stable_baselines3, name).load(path, device="cpu")
    except Exception as error:  # unpickling can raise anything
        line = " ".join(str(error).split())[:200]
        raise DataFileError(f"{path}: not a model of stable-baselines3: {line}") from error
