"""Networks in ONNX files, run by onnxruntime.

Inputs and outputs, by name, all with a leading axis of N episodes:

- `image`, uint8, (N, C, H, W) with the layout `chw`: the observation;
- `last_action`, float32, optional: (N, 7) with a 1 at the last action (hover at the start), or the
  last four numbers; with a gimbal (N, 11), or the last six;
- `attributes`, float32, (N, A), optional: what the target is told to be, see docs/words.md; 0 where
  nothing is told;
- any number of memories `x`, float32, (N, ...), with an output `next_x` each; 0 at the start;
- the first output: `logits`, float, (N, 7), or `action`, float, (N, 4); with a gimbal (N, 11) or
  (N, 6).

The metadata `eyas` holds JSON: changes of the defaults of `env`, such as `{"observation": {"width":
48, "height": 48, "layout": "chw", "frames": 1}, "actions": "discrete", "action_repeat": 4}`.

A network with the input `expected` is that of a tracker, see `eyas.benchmark.policies.tracker`;
one with the output `vehicles` that of a listener, see `eyas.benchmark.policies.listener`; one
without the input `image` that of somebody else, see `eyas.benchmark.policies.foreign`.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.action_choice import Chooser
from eyas.benchmark.policies.detections import is_detector
from eyas.benchmark.policies.foreign import ADAPTER, ForeignPolicy
from eyas.benchmark.policies.listener.detector import VehicleDetector
from eyas.benchmark.policies.listener.listener import Listener
from eyas.benchmark.policies.own_policy import pilot
from eyas.benchmark.policies.simple import HOVER
from eyas.benchmark.policies.tracker.detector import Detector, Session
from eyas.benchmark.policies.tracker.metadata import METADATA, TRACKER, metadata
from eyas.benchmark.policies.tracker.tracker import Tracker
from eyas.engine.core.errors import ConfigError, DataFileError, MissingExtraError
from eyas.engine.core.files import refuse_pointer
from eyas.engine.policies.policy import (
    Decision,
    Policy,
    PolicyInput,
    Start,
    env_config,
    settings_in,
)
from eyas.engine.targets.grammar.attributes import ATTRIBUTES

__all__ = ["METADATA", "OnnxPolicy", "load_onnx"]

_IMAGE, _LAST, _TOLD, _NEXT = "image", "last_action", "attributes", "next_"


class OnnxPolicy:
    """A network.

    Raises:
        DataFileError: The file does not hold such a network.
    """

    def __init__(
        self, path: Path, session: Session, changes: Mapping[str, Any], *, sampled: bool
    ) -> None:
        self._session = session
        settings = settings_in(path, f"metadata '{METADATA}'", metadata(path, session, METADATA))
        self.env = env_config({"observation": {"layout": "chw"}, **settings}, changes)
        self.sampled = sampled
        self._chooser = Chooser(sampled=sampled)
        self._discrete = self.env.actions.numbered
        inputs = {each.name: each.shape for each in self._session.get_inputs()}
        outputs = [each.name for each in self._session.get_outputs()]
        memories = [name for name in inputs if name not in (_IMAGE, _LAST, _TOLD)]
        if _IMAGE not in inputs or any(_NEXT + name not in outputs for name in memories):
            raise DataFileError(
                f"{path}: not a policy: it needs the input 'image', and for each memory 'x' the "
                f"output 'next_x'; it has {', '.join(inputs)} and {', '.join(outputs)}"
            )
        self._remembers_action, self._is_told = _LAST in inputs, _TOLD in inputs
        self.told = frozenset({_TOLD}) if self._is_told else frozenset()
        self._shapes = {name: inputs[name][1:] for name in memories}
        self._outputs = [outputs[0], *(_NEXT + name for name in memories)]

    def begin(self, start: Start) -> None:
        """Clear the memories."""
        count = len(start.seeds)
        self._chooser.begin(start.seeds)
        self._memory: dict[str, NDArray[np.float32]] = {
            name: np.zeros((count, *shape), np.float32) for name, shape in self._shapes.items()
        }
        nothing = np.zeros((count, len(ATTRIBUTES)), np.float32)
        self._told = nothing if start.told is None else start.told.attributes
        self._last = np.zeros((count, self.env.actions.size), np.float32)
        if self._discrete:
            self._last[:, HOVER] = 1.0

    def act(self, sight: PolicyInput) -> Decision:
        """Run the network for all; those who do not decide remember nothing new."""
        seen: Any = sight.observation
        image = seen[_IMAGE] if isinstance(seen, dict) else seen
        feed: dict[str, Any] = {_IMAGE: image, **self._memory}
        if self._is_told:
            feed[_TOLD] = self._told
        if self._remembers_action:
            feed[_LAST] = self._last
        answer, *memories = self._session.run(self._outputs, feed)
        mask = sight.deciding
        for (name, old), new in zip(list(self._memory.items()), memories, strict=True):
            self._memory[name] = np.where(mask.reshape(-1, *[1] * (old.ndim - 1)), new, old)
        if not self._discrete:
            self._last[mask] = answer[mask]
            return Decision(answer)
        actions = self._chooser.of(answer, mask)
        self._last[mask] = np.eye(self.env.actions.size, dtype=np.float32)[actions[mask]]
        return Decision(actions)


def load_onnx(path: Path, changes: Mapping[str, Any], *, sampled: bool) -> Policy:
    """Return the policy in a file, see `OnnxPolicy`, `ForeignPolicy`, `Tracker` and `Listener`; a
    detector becomes a box tracker with a controller.

    Raises:
        EyasError: The file does not hold one, or changes do not fit it.
    """
    session = open_session(path)
    make = Tracker if Detector.fits(session) else Listener
    if make is Listener and not VehicleDetector.fits(session):
        if is_detector(session) and not sampled:
            return pilot(str(path), changes)
        ours = _is_ours(session)
        return (OnnxPolicy if ours else ForeignPolicy)(path, session, changes, sampled=sampled)
    if sampled:
        raise ConfigError(f"--sample: not allowed for '{path.stem}': it has no scores of actions")
    said, own = (metadata(path, session, name) for name in (METADATA, TRACKER))
    return make(path, session, settings_in(path, f"metadata '{METADATA}'", said), own, changes)


def _is_ours(session: Session) -> bool:
    """Return whether a network has the inputs of `OnnxPolicy`."""
    described = session.get_modelmeta().custom_metadata_map
    image = [each for each in session.get_inputs() if each.name == _IMAGE]
    if ADAPTER in described or not image:
        return False
    return METADATA in described or image[0].type == "tensor(uint8)"


def open_session(path: Path) -> Any:  # noqa: ANN401  # onnxruntime has no types
    """Return a network, ready to run.

    Raises:
        EyasError: It is none, or onnxruntime is not installed.
    """
    try:
        import onnxruntime
    except ImportError as error:
        raise MissingExtraError("a policy in an ONNX file", "policies") from error
    refuse_pointer(path)
    options = onnxruntime.SessionOptions()
    # One thread: the order of additions, and with it each bit, is then always the same.
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime has errors of its own, without a common base
        line = " ".join(str(error).split())[:200]
        raise DataFileError(f"{path}: not a network in ONNX: {line}") from error
