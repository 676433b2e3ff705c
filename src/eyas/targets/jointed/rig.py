"""The rig of people and robots."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.mesh.shell import Shape, levels_of
from eyas.state.mesh import Mesh
from eyas.targets.jointed.cycle import frames_of, shapes_of
from eyas.targets.jointed.figure import Figure
from eyas.targets.jointed.model import JointedModel
from eyas.targets.jointed.pose import BODY, PART, CycleTable, pose_jointed
from eyas.targets.posing import PoseCall

__all__ = ["JointedRig"]

_INTERVALS = 32
"""Intervals of a cycle; within one, parts move along straight lines."""

_SHEARED = 1.25
"""Factor by which what stays upright on a slope may be farther from its origin."""


class JointedRig:
    """The rig of the models of one kind.

    Attributes:
        slots: As in `Rig`.
        pose: As in `Rig`.

    Args:
        models: All models of a kind.
    """

    slots: int

    def __init__(self, models: Sequence[JointedModel]) -> None:
        self._models, self._shapes = models, list[Shape]()
        figures = [model.figure for model in models]
        drawn = [shapes_of(figure) for figure in figures]
        for shape in (shape for shapes in drawn for shape in shapes):
            if shape not in self._shapes:
                self._shapes.append(shape)
        self.slots = max(map(len, drawn))
        table = _tabulate(figures, drawn, self._shapes, self.slots)
        self._far = _farthest(table)
        self._parts = table.part["part"]
        self.pose = PoseCall(pose_jointed, table)

    @property
    def part_count(self) -> int:
        """Total number of parts of all models."""
        return len(self._shapes)

    def part_levels(self) -> list[tuple[Mesh, ...]]:
        """Return the meshes of each part, the finest first.

        Raises:
            ValueError: A model is not of the size that it says.
        """
        levels = [levels_of(shape) for shape in self._shapes]
        for model in self._models:
            frames = frames_of(model.figure, np.zeros(1), moving=False)[0]
            placed = [
                exact.product(levels[self._shapes.index(shape)][0].positions, frame[:, :3].T)
                + frame[:, 3]
                for shape, frame in zip(shapes_of(model.figure), frames, strict=True)
            ]
            model.check_meshes(np.concatenate(placed), 0.1, antennas=True)
        return levels

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point of an actor may be from its reference point, see `Rig` [m]."""
        return float((self._far + parts[self._parts])[self._parts >= 0].max())


def _tabulate(
    figures: Sequence[Figure], drawn: Sequence[list[Shape]], shapes: list[Shape], slots: int
) -> CycleTable:
    models = len(figures)
    table = CycleTable(
        part=np.zeros((models, slots), PART),
        body=np.zeros(models, BODY),
        rest=np.zeros((models, slots, 4, 3), np.float32),
        cycle=np.zeros((models, _INTERVALS + 1, slots, 4, 3), np.float32),
    )
    table.part["part"] = -1
    cycle = np.linspace(0.0, 1.0, _INTERVALS + 1)
    for m, (figure, own) in enumerate(zip(figures, drawn, strict=True)):
        count, gait = len(own), figure.gait
        table.part["part"][m, :count] = [shapes.index(shape) for shape in own]
        joints = [joint for joint in figure.joints if joint.shape is not None]
        table.part["spins"][m, : len(joints)] = [joint.spins for joint in joints]
        table.part["steers"][m, : len(joints)] = [joint.steers for joint in joints]
        table.body[m] = (1.0 / gait.stride, gait.slowest, figure.wheel_radius, figure.upright)
        still = frames_of(figure, np.zeros(1), moving=False)[0]
        table.rest[m, :count] = still.swapaxes(-1, -2)
        moving = frames_of(figure, cycle, moving=True)
        table.cycle[m, :, :count] = moving.swapaxes(-1, -2)
    return table


def _farthest(table: CycleTable) -> NDArray[np.float64]:
    """Return how far the origins of parts are from the actor's, at most [m], shape (M, S)."""
    away = np.linalg.norm(table.cycle[..., 3, :].astype(np.float64), axis=-1).max(axis=1)
    still = np.linalg.norm(table.rest[..., 3, :].astype(np.float64), axis=-1)
    return np.asarray(_SHEARED * np.maximum(away, still), np.float64)
