"""Networks in PyTorch files."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from eyas.benchmark.policies.action_choice import Chooser
from eyas.engine.core.errors import DataFileError, MissingExtraError
from eyas.engine.policies.policy import Decision, PolicyInput, Start, env_config, settings_in

_EXPORTED = ".pt2"


class TorchPolicy:
    """A module without memory: from observations (N, ...), uint8, to scores (N, 7) or
    actions (N, 4); with a gimbal (N, 11) or (N, 6).

    Its attribute `env_settings`, or the extra file `eyas.json` of an exported program, holds
    changes of the defaults of `env`.

    Args:
        path: A program of `torch.export.save`, `.pt2`; or a whole module of `torch.save`. The
            latter is a pickle, which runs code: load only files that you trust.

    Raises:
        DataFileError: The file is neither.
        MissingExtraError: torch is not installed.
    """

    told: frozenset[str] = frozenset()

    def __init__(self, path: Path, changes: Mapping[str, Any], *, sampled: bool) -> None:
        self._torch = _torch()
        self._module, said = self._loaded(path)
        settings = settings_in(path, "its settings", said)
        self.env = env_config({"observation": {"layout": "chw"}, **settings}, changes)
        self.sampled = sampled
        self._chooser = Chooser(sampled=sampled)

    def begin(self, start: Start) -> None:
        """Begin the random numbers."""
        self._chooser.begin(start.seeds)

    def act(self, sight: PolicyInput) -> Decision:
        """Run the module."""
        observation: Any = sight.observation
        with self._torch.inference_mode():
            answer = self._module(self._torch.from_numpy(observation)).numpy()
        if not self.env.actions.numbered:
            return Decision(answer)
        return Decision(self._chooser.of(np.asarray(answer), sight.deciding))

    def _loaded(self, path: Path) -> tuple[Any, object]:
        torch, extra = self._torch, {"eyas.json": ""}
        try:
            if path.suffix == _EXPORTED:
                module = torch.export.load(str(path), extra_files=extra).module()
                return module, json.loads(extra["eyas.json"] or "{}")
            module = torch.load(path, map_location="cpu", weights_only=False)
            if not isinstance(module, torch.nn.Module):
                raise TypeError(f"it holds a {type(module).__name__}, not a whole module")
            return module.eval(), getattr(module, "env_settings", {})
        except Exception as error:  # unpickling can raise anything
            line = " ".join(str(error).split())[:200]
            raise DataFileError(f"{path}: not a PyTorch policy: {line}") from error


def _torch() -> Any:  # noqa: ANN401  # a module
    try:
        import torch
    except ImportError as error:
        raise MissingExtraError("a policy in a PyTorch file", "train") from error
    torch.set_num_threads(1)  # many threads are slower for small networks, and add in any order
    return torch
