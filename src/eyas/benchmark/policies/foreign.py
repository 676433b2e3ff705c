"""Networks in ONNX files that others have exported: pictures in, actions out, by their shapes.

Where a file does not say more, its picture is the only input with three axes beside the batch: NCHW
or NHWC, 1, 3, or several times so many channels (the newest last), uint8 from 0 to 255, other
numbers from 0 to 1. Seven outputs are the scores of the seven actions, four are shares of the
speeds; eleven and six the same with the camera's; whole numbers without an axis beside the batch
are actions already. The metadata under the key `ADAPTER` say otherwise (`eyas policies adapt`),
those under `eyas` are the settings of `env` as always.
"""

import json
import logging
import multiprocessing
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from eyas.benchmark.policies.action_choice import Chooser
from eyas.benchmark.policies.tracker.detector import Session
from eyas.benchmark.policies.tracker.metadata import METADATA, metadata
from eyas.engine.core.config import Config, validated
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import atomic_path, read_limited
from eyas.engine.policies.policy import Decision, PolicyInput, Start, env_config, settings_in

ADAPTER = "eyas.adapter"
"""Key of the metadata that say how a network is fed."""

_LARGEST = 1 << 31  # Largest file that is adapted [bytes]
_SIDE = 84  # Where a network leaves its size open [pixels]
_SIDES = range(8, 8193)
_TYPES = {
    **{"tensor(uint8)": np.uint8, "tensor(float16)": np.float16, "tensor(float)": np.float32},
    "tensor(double)": np.float64,
}
_ACTIONS = {7: "discrete", 4: "shares", 11: "discrete+gimbal", 6: "shares+gimbal"}
"""Kinds of actions by the number of outputs."""

_IMAGENET = np.array([[0.485, 0.456, 0.406], [0.229, 0.224, 0.225]])
"""Mean and standard deviation of the red, green and blue of its pictures, from 0 to 1."""

_log = logging.getLogger(__name__)


class Scale(StrEnum):
    """Numbers of a picture."""

    BYTES = "bytes"  # 0 to 255
    UNIT = "unit"  # 0 to 1
    SIGNED = "signed"  # -1 to 1
    IMAGENET = "imagenet"  # From 0 to 1, less ImageNet's mean, over its standard deviation


class Adapter(Config):
    """How a network is fed, where its shapes do not say it."""

    input: str | None = None
    """Name of the input that is the picture; None: the only one with the shape of one."""
    output: str | None = None
    """Name of the output that is the action; None: the first."""
    scale: Scale | None = None
    """Numbers of the picture; None: bytes for uint8, else from 0 to 1."""
    swapped: bool = Field(default=False)
    """Whether blue comes first, as OpenCV reads pictures."""


class _Picture(NamedTuple):
    """An input that is a picture."""

    name: str
    first: bool  # Whether channels come first
    channels: int
    height: int
    width: int
    batch: int | None  # None: any number
    kind: Any  # Of numpy
    scale: Scale

    @property
    def words(self) -> str:
        order = "channels first" if self.first else "channels last"
        return (
            f"input '{self.name}' as pictures of {self.width} x {self.height} pixels, "
            f"{self.channels} channels, {order}, {np.dtype(self.kind).name}, scale {self.scale}"
        )


class ForeignPolicy:
    """A network that was not exported for Eyas.

    Raises:
        DataFileError: It has no input that is a picture, or no output that is an action.
    """

    told: frozenset[str] = frozenset()

    def __init__(
        self, path: Path, session: Session, changes: Mapping[str, Any], *, sampled: bool
    ) -> None:
        adapter = validated(Adapter, metadata(path, session, ADAPTER), f"{path}: {ADAPTER}")
        own = settings_in(path, f"metadata '{METADATA}'", metadata(path, session, METADATA))
        self._session, self._adapter = session, adapter
        self._picture = _picture(path, session, adapter)
        self._output, count = _output(path, session, adapter)
        grey = self._picture.channels % 3 != 0
        observation = {
            "layout": "chw" if self._picture.first else "hwc",
            "width": self._picture.width,
            "height": self._picture.height,
            "colours": "grey" if grey else "rgb",
            "frames": self._picture.channels // (1 if grey else 3),
        }
        kind = {} if count is None else {"actions": _ACTIONS[count]}
        self.env = env_config({"observation": observation, **kind, **own}, changes)
        self.sampled = sampled
        self._chosen = count is None
        self._chooser = Chooser(sampled=sampled)
        described = {ADAPTER, METADATA} & session.get_modelmeta().custom_metadata_map.keys()
        if not described and multiprocessing.parent_process() is None:  # once, not for each batch
            _log.warning("%s: %s; eyas policies adapt says otherwise", path, self.assumed)

    @property
    def assumed(self) -> str:
        """What is taken for granted, in a line."""
        kind = "numbers of actions" if self._chosen else f"actions '{self.env.actions}'"
        return f"takes {self._picture.words}; output '{self._output}' as {kind}"

    def begin(self, start: Start) -> None:
        """Begin the random numbers."""
        self._chooser.begin(start.seeds)

    def act(self, sight: PolicyInput) -> Decision:
        """Run the network for all, in batches of its size."""
        seen: Any = sight.observation
        fed = self._fed(np.asarray(seen))
        size = self._picture.batch or len(fed)
        answers = []
        for first in range(0, len(fed), size):
            part = fed[first : first + size]
            full = np.concatenate([part, np.repeat(part[-1:], size - len(part), axis=0)])
            (answer,) = self._session.run([self._output], {self._picture.name: full})
            answers.append(np.asarray(answer).reshape(size, -1)[: len(part)])
        answer = np.concatenate(answers).astype(np.float32)
        if self._chosen:
            return Decision(answer[:, 0].astype(np.int64))
        if not self.env.actions.numbered:
            return Decision(answer)
        return Decision(self._chooser.of(answer, sight.deciding))

    def _fed(self, observation: NDArray[np.uint8]) -> NDArray[Any]:
        """Return observations as the network wants them."""
        picture = self._picture
        if observation.ndim == 3:  # grey, without an axis of channels
            observation = observation[:, None] if picture.first else observation[..., None]
        axis = 1 if picture.first else 3
        if self._adapter.swapped and picture.channels % 3 == 0:
            order = np.arange(picture.channels).reshape(-1, 3)[:, ::-1].ravel()
            observation = np.take(observation, order, axis=axis)
        if picture.scale is Scale.BYTES:
            return np.ascontiguousarray(observation).astype(picture.kind)
        unit = observation.astype(np.float32) / np.float32(255.0)
        if picture.scale is Scale.SIGNED:
            unit = unit * np.float32(2.0) - np.float32(1.0)
        elif picture.scale is Scale.IMAGENET:
            constants = np.resize(_IMAGENET, (2, picture.channels)).astype(np.float32)
            if self._adapter.swapped:
                constants = constants.reshape(2, -1, 3)[..., ::-1].reshape(2, -1)
            shape = (-1, 1, 1) if picture.first else (-1,)
            unit = (unit - constants[0].reshape(shape)) / constants[1].reshape(shape)
        return unit.astype(picture.kind)


def _described(values: Any) -> str:  # noqa: ANN401  # onnxruntime has no types
    return ", ".join(f"{each.name} {each.type} {list(each.shape)}" for each in values)


def _picture(path: Path, session: Session, adapter: Adapter) -> _Picture:
    """Return the input that is a picture; all others make it another kind of network."""
    inputs = session.get_inputs()
    fitting = [
        picture
        for each in inputs
        if adapter.input in (None, each.name) and (picture := _as_picture(each, adapter.scale))
    ]
    if len(fitting) == 1 and len(inputs) == 1:
        return fitting[0]
    why = (
        "none has the shape of pictures"
        if not fitting
        else "several have the shape of pictures"
        if len(fitting) > 1
        else "what the others are is not known: a memory 'x' has an output 'next_x'"
    )
    raise DataFileError(
        f"{path}: not a policy: inputs {_described(inputs)}: {why}; docs/evaluation.md, 'Networks "
        "of others', says what is read"
    )


def _as_picture(value: Any, scale: Scale | None) -> _Picture | None:  # noqa: ANN401
    """Return an input of a network as a picture; None if its shape is another."""
    shape = [each if isinstance(each, int) and each > 0 else None for each in value.shape]
    if value.type not in _TYPES or len(shape) != 4:
        return None
    for first in (True, False):
        channels = shape[1] if first else shape[3]
        height, width = shape[2:] if first else shape[1:3]
        height, width = height or _SIDE, width or _SIDE
        if channels is None or channels > 192 or not {height, width} <= set(_SIDES):
            continue
        if channels <= 4 or channels % 3 == 0 or channels < min(height, width):
            kind = _TYPES[value.type]
            usual = Scale.BYTES if kind is np.uint8 else Scale.UNIT
            return _Picture(
                value.name, first, channels, height, width, shape[0], kind, scale or usual
            )
    return None


def _output(path: Path, session: Session, adapter: Adapter) -> tuple[str, int | None]:
    """Return the name of the output that is the action, and its numbers; None: it is chosen."""
    outputs = session.get_outputs()
    for each in outputs:
        if adapter.output not in (None, each.name):
            continue
        last = each.shape[-1] if each.shape else None
        if "int" in each.type and (len(each.shape) <= 1 or last == 1):
            return each.name, None
        if "float" in each.type or "double" in each.type:
            if len(each.shape) >= 2 and last in _ACTIONS:
                return each.name, int(last)
        break
    raise DataFileError(
        f"{path}: not a policy: outputs {_described(outputs)}: the first is no action: 7 scores "
        "or 4 numbers (11 or 6 with the camera's), or the number of an action"
    )


def adapt(path: Path, out: Path, adapter: Mapping[str, Any], env: Mapping[str, Any]) -> str:
    """Write a network with how it is fed beside it; return that in a line.

    Raises:
        EyasError: It is no policy when fed so, or a file cannot be read or written.
    """
    from eyas.benchmark.policies.onnx import load_onnx

    validated(Adapter, adapter, "eyas policies adapt")
    env_config(env)
    with atomic_path(out) as written:
        # Protobuf messages that follow each other are one message with the fields of all: nothing
        # of the network is read or changed.
        content = read_limited(path, _LARGEST)
        content += _property(ADAPTER, json.dumps(adapter))
        if env:
            content += _property(METADATA, json.dumps(env))
        written.write_bytes(content)
        policy = load_onnx(written, {}, sampled=False)
        if not isinstance(policy, ForeignPolicy):
            raise DataFileError(f"{path}: needs no adapter: it is a network of Eyas")
    return policy.assumed


def _property(key: str, value: str) -> bytes:
    """Return a `ModelProto` that has one pair of `metadata_props`, field 14 of onnx.proto."""

    def field(number: int, content: bytes) -> bytes:
        return _varint(number << 3 | 2) + _varint(len(content)) + content

    return field(14, field(1, key.encode()) + field(2, value.encode()))


def _varint(number: int) -> bytes:
    digits = []
    while number > 127:
        digits.append(number & 127 | 128)
        number >>= 7
    return bytes([*digits, number])
