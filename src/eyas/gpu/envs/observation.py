"""Observations of agents, made on a device."""

import sys
from collections.abc import Mapping
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import ColourLayout, Colours
from eyas.engine.core.errors import ConfigError
from eyas.engine.envs.observation import observation_space
from eyas.engine.render.outputs import MEASURES
from eyas.engine.sensors.stack import luma
from eyas.engine.settings.env import ObservationConfig, ObservationPart
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.packet_rows import SENSOR_COLUMNS, fill_basic
from eyas.engine.task.privileged import privileged_row
from eyas.gpu.sim.simulation import DeviceSimulation, MirroredArray
from eyas.gpu.sim.view import DeviceView
from eyas.lanes import kernel, parallel

Shared = Any  # An array of numpy, or a tensor of PyTorch that shares the memory of a device's array


def tensor_of(array: Any) -> Shared:  # noqa: ANN401  # a `DeviceArray`
    """Return an array on a device as users get it; its memory is shared."""
    if isinstance(array, np.ndarray):
        return array
    return torch_of(array)


def torch_of(array: Any) -> Shared:  # noqa: ANN401  # a `DeviceArray`
    """Return an array on a device as a tensor of PyTorch; its memory is shared."""
    from torch.utils.dlpack import from_dlpack

    return from_dlpack(array)


def is_tensor(actions: object) -> bool:
    """Return whether something is a tensor of PyTorch, which is imported then."""
    torch = sys.modules.get("torch")
    return torch is not None and isinstance(actions, torch.Tensor)


def as_bool(shared: Shared) -> Shared:
    """Return an array of bytes, 0 or 1, as one of truths; its memory is shared."""
    if isinstance(shared, np.ndarray):
        return shared.view(np.bool_)
    import torch

    return shared.view(torch.bool)


def copied(shared: Shared, out: Shared | None = None) -> Shared:
    """Return a copy, in `out` if that is given."""
    if out is None:
        return shared.copy() if isinstance(shared, np.ndarray) else shared.clone()
    if isinstance(out, np.ndarray):
        out[:] = shared
    else:
        out.copy_(shared)
    return out


_IMAGE, _SENSORS = ObservationPart.IMAGE, ObservationPart.SENSORS
_PARTS = (_IMAGE, _SENSORS, ObservationPart.PRIVILEGED)
_FIRST, _END = SENSOR_COLUMNS.start, SENSOR_COLUMNS.stop

Chosen = NDArray[np.int64]


class ObservedTrackers(NamedTuple):
    """Who is observed."""

    views: NDArray[np.int64]  # Number of trackers V, shape (1,)
    tracker: NDArray[np.int64]  # Which, in the first V of N elements
    begun: NDArray[np.uint8]  # 1: its episode has just begun, likewise


class Pictures(NamedTuple):
    """Pictures that become observations, see `eyas.engine.sensors.stack.FrameStack`."""

    rgb: NDArray[np.uint8]  # Of the V trackers, shape (N, H, W, 3)
    before: NDArray[np.uint8]
    """The stacks of all N trackers, shape (N, H, W, planes) or (N, planes, H, W)."""
    after: NDArray[np.uint8]  # Where they are written, for the V trackers; may be the same
    grey: int  # 1: one channel, the luma
    frames: int
    first: int  # 1: planes come before rows and columns


class Rows(NamedTuple):
    """Numbers that become observations; arrays of 0 rows are not wanted."""

    packet: NDArray[np.float64]  # Working memory: basic packets, shape (N, 22)
    sensors: NDArray[np.float32]  # Shape (N, 19)
    privileged: NDArray[np.float32]  # Shape (N, 16)


class DeviceObserver:
    """Observes N trackers.

    Attributes:
        space: The space of one observation.
        visible: Share of each target that the latest picture shows, if it is measured, on the host,
            shape (N,).

    Raises:
        ConfigError: A part is not there on a device.
    """

    def __init__(
        self,
        config: ObservationConfig,  # What is observed
        simulation: DeviceSimulation,  # The trackers
        view: DeviceView,  # Draws what they see
        *,
        measures: bool = False,  # Whether targets are measured in the pictures, for teachers
    ) -> None:
        self.space = observation_space(config, simulation.config)
        for part in config.parts:
            if part not in _PARTS:
                raise ConfigError(
                    f"env.observation.parts: '{part}' is not there on a device; "
                    f"allowed: {', '.join(_PARTS)}"
                )
        self._config, self._simulation, self._view = config, simulation, view
        device, count = simulation.device, simulation.count
        self._device = device
        self._parts = tuple(dict.fromkeys(config.parts))
        self._latest, self._final = self._new(), self._new()
        self._told = [
            {part: tensor_of(array) for part, array in arrays.items()}
            for arrays in (self._latest, self._final)
        ]
        seen = ObservedTrackers(
            np.zeros(1, np.int64), np.zeros(count, np.int64), np.zeros(count, np.uint8)
        )
        self._seen = [MirroredArray(device, array) for array in seen]
        self._held_seen = device.held(ObservedTrackers(*(own.array for own in self._seen)))
        self._snapshot = device.held(simulation.snapshot)
        # Pictures that are observations as they are drawn.
        last, single = config.layout is ColourLayout.HWC, config.frames == 1
        self._plain = last and single and config.colours is Colours.RGB
        self.visible = np.zeros(count)
        self._subject = device.zeros((count, MEASURES), np.int32) if measures else None
        self._rgb = device.zeros((count, config.height, config.width, 3), np.uint8)
        self._stacking = {final: self._held_pictures(final=final) for final in (False, True)}
        self._rows = {final: device.held(self._rows_of(final=final)) for final in (False, True)}

    def look(self, trackers: Chosen, begun: NDArray[np.bool_], *, final: bool = False) -> None:
        """Observe some trackers.

        Args:
            trackers: The trackers, shape (V,).
            begun: Whether the episode of each has just begun, shape (V,).
            final: Whether these are the last observations of their episodes, which are kept apart.
        """
        device, count = self._device, len(trackers)
        for own, values in zip(self._seen, (np.array([count]), trackers, begun), strict=True):
            own.write(values)
        if _IMAGE in self._parts and self._plain and count == self._simulation.count and not final:
            self._view.draw(trackers, self._latest[_IMAGE], self._subject)
        elif _IMAGE in self._parts:
            self._view.draw(trackers, self._rgb, self._subject)
            pixels = self._config.height * self._config.width
            device.launch(_stack_pictures, count * pixels, self._held_seen, self._stacking[final])
        if _IMAGE in self._parts and self._subject is not None:
            seen, covered = device.read(self._subject)[:count, 4:6].T
            self.visible[trackers] = seen / np.maximum(covered, 1)
        if set(self._parts) != {_IMAGE}:
            held = self._snapshot, self._held_seen, self._rows[final]
            device.launch(_fill_rows, count, *held)

    def latest(self, out: Any = None, *, final: bool = False) -> Any:  # noqa: ANN401  # as users get it
        """Return the latest observation of each tracker as tensors, which later ones leave alone.

        Args:
            out: Tensors to write it into; they are returned.
            final: Whether to return the last observations of episodes in the place of these.
        """
        told = {}
        for part, shared in self._told[final].items():
            own = out[part] if isinstance(out, Mapping) else out
            told[str(part)] = copied(shared, own)
        return told if len(told) > 1 else next(iter(told.values()))

    def _new(self) -> dict[str, Any]:
        """Return an array on the device for each part."""
        space, count = self.space, self._simulation.count
        boxes = space.spaces if isinstance(space, gymnasium.spaces.Dict) else {}
        arrays = {}
        for part in self._parts:
            box = boxes.get(str(part), space)
            assert box.shape is not None
            assert box.dtype is not None
            arrays[part] = self._device.zeros((count, *box.shape), box.dtype)
        return arrays

    def _held_pictures(self, *, final: bool) -> Any:  # noqa: ANN401  # what the device makes of it
        """Return the `Pictures`, held; None if none are wanted."""
        if _IMAGE not in self._parts:
            return None
        config, before = self._config, self._latest[_IMAGE]
        return self._device.held(
            Pictures(
                self._rgb,
                before,
                self._final[_IMAGE] if final else before,
                int(config.colours is Colours.GREY),
                config.frames,
                int(config.layout is ColourLayout.CHW),
            )
        )

    def _rows_of(self, *, final: bool) -> Rows:
        device, arrays = self._device, self._final if final else self._latest
        nothing = device.zeros((0, 1), np.float32)
        packets = device.zeros((self._simulation.count, 22), np.float64)
        return Rows(packets, *(arrays.get(part, nothing) for part in _PARTS[1:]))


@parallel
def _stack_pictures(worker: int, workers: int, seen: ObservedTrackers, pictures: Pictures) -> None:
    """Put the pixels of new pictures behind the older ones."""
    height, width = pictures.rgb.shape[1], pictures.rgb.shape[2]
    channels = 1 if pictures.grey == 1 else 3
    newest = channels * (pictures.frames - 1)
    for index in range(worker, seen.views[0] * height * width, workers):
        v, at = index // (height * width), index % (height * width)
        row, column, n = at // width, at % width, seen.tracker[v]
        colour = pictures.rgb[v, row, column]
        for plane in range(newest + channels):
            if plane < newest and seen.begun[v] == 0:
                value = _plane_at(pictures, n, row, column, plane + channels)
            elif pictures.grey == 1:
                value = luma(colour[0], colour[1], colour[2])
            else:
                value = int(colour[plane % channels])
            if pictures.first == 1:
                pictures.after[n, plane, row, column] = value
            else:
                pictures.after[n, row, column, plane] = value


@kernel(inline=True)
def _plane_at(pictures: Pictures, n: int, row: int, column: int, plane: int) -> int:
    """Return a pixel of a plane of an older stack."""
    if pictures.first == 1:
        return int(pictures.before[n, plane, row, column])
    return int(pictures.before[n, row, column, plane])


@parallel
def _fill_rows(
    worker: int, workers: int, snapshot: Snapshot, seen: ObservedTrackers, rows: Rows
) -> None:
    """Write the numbers that trackers observe."""
    for v in range(worker, seen.views[0], workers):
        n = seen.tracker[v]
        if rows.sensors.shape[0] > 0:
            packet = rows.packet[n]
            fill_basic(snapshot.trackers, snapshot.episodes, n, packet)
            for column in range(_FIRST, _END):
                rows.sensors[n, column - _FIRST] = packet[column]
        if rows.privileged.shape[0] > 0:
            privileged_row(snapshot, n, rows.privileged[n])
