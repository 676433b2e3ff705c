"""The rig of people and robots."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.shell import Shape, levels_of
from eyas.engine.state.mesh import Mesh
from eyas.engine.targets.jointed.cycle import frames_of, shapes_of, skeleton_of, table_of
from eyas.engine.targets.jointed.model import JointedModel
from eyas.engine.targets.jointed.pose import BODY, PART, CycleTable, pose_figure
from eyas.engine.targets.posing import PoseCall
from eyas.lanes import exact

_INTERVALS = 32  # Intervals of a cycle; within one, parts move along straight lines

_SHEARED = 1.25  # Factor by which what stays upright on a slope may be farther from its origin


class Layout(NamedTuple):
    """The parts of the models of one kind, and where they are; made once for all rigs of it."""

    place: dict[Shape, int]  # The shapes, numbered
    table: CycleTable


def layout_of(models: Sequence[JointedModel]) -> Layout:
    """Return the layout of all models of a kind."""
    drawn = [shapes_of(model.figure) for model in models]
    shapes = dict.fromkeys(shape for shapes in drawn for shape in shapes)
    place = {shape: number for number, shape in enumerate(shapes)}
    return Layout(place, _tabulate(models, drawn, place, max(map(len, drawn))))


class JointedRig:
    """The rig of the models of one kind.

    Attributes:
        slots: As in `Rig`.
        pose: As in `Rig`.

    Args:
        models: All models of a kind.
        layout: Their `layout_of`, if it has been made.
    """

    slots: int

    def __init__(self, models: Sequence[JointedModel], layout: Layout | None = None) -> None:
        self._models = models
        self._place, table = layout or layout_of(models)
        self.slots = table.slot.shape[1]
        self._far = _farthest(table)
        self._scale = np.linalg.norm(table.rest[:, :, 0].astype(np.float64), axis=-1)
        self._parts = table.slot["part"]
        self.pose = PoseCall(table, pose_figure)

    @property
    def part_count(self) -> int:
        """Total number of parts of all models."""
        return len(self._place)

    def part_levels(self) -> list[tuple[Mesh, ...]]:
        """Return the meshes of each part, the finest first.

        Raises:
            ValueError: A model is not of the size that it says.
        """
        levels = [levels_of(shape) for shape in self._place]
        for model in self._models:
            frames = frames_of(model.figure, np.zeros(1), moving=False)[0]
            placed = [
                exact.product(levels[self._place[shape]][0].positions, frame[:, :3].T) + frame[:, 3]
                for shape, frame in zip(shapes_of(model.figure), frames, strict=True)
            ]
            model.check_meshes(np.concatenate(placed), 0.1, antennas=True)
        return levels

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point of an actor may be from its reference point, see `Rig` [m]."""
        away = self._far + self._scale * parts[self._parts]
        return float(away[self._parts >= 0].max())


def _tabulate(
    models: Sequence[JointedModel],
    drawn: Sequence[list[Shape]],
    place: dict[Shape, int],
    slots: int,
) -> CycleTable:
    count = len(models)
    table = CycleTable(
        slot=np.zeros((count, slots), PART),
        body=np.zeros(count, BODY),
        rest=np.zeros((count, slots, 4, 3), np.float32),
        cycle=np.zeros((count, _INTERVALS + 1, slots, 4, 3), np.float32),
    )
    table.slot["part"] = -1
    for m, (model, own) in enumerate(zip(models, drawn, strict=True)):
        figure, count = model.figure, len(own)
        gait, scale = figure.gait, figure.scale
        table.slot["part"][m, :count] = [place[shape] for shape in own]
        for k, colour in enumerate(model.part_colours):
            if colour is not None:
                table.slot["own"][m, k] = True
                table.slot["red"][m, k], table.slot["green"][m, k], table.slot["blue"][m, k] = (
                    colour
                )
        joints = [joint for joint in figure.joints if joint.shape is not None]
        table.slot["spins"][m, : len(joints)] = [joint.spins for joint in joints]
        table.slot["steers"][m, : len(joints)] = [joint.steers for joint in joints]
        table.body[m] = (
            1.0 / (scale * gait.stride), gait.slowest, scale * figure.wheel_radius, figure.upright,
        )  # fmt: skip
        skeleton, shown = skeleton_of(figure)
        still, moving = table_of(skeleton, _INTERVALS)
        table.rest[m, :count] = scale * still[0, shown].swapaxes(-1, -2)
        table.cycle[m, :, :count] = scale * moving[:, shown].swapaxes(-1, -2)
    return table


def _farthest(table: CycleTable) -> NDArray[np.float64]:
    """Return how far the origins of parts are from the actor's, at most [m], shape (M, S)."""
    away = np.linalg.norm(table.cycle[..., 3, :].astype(np.float64), axis=-1).max(axis=1)
    still = np.linalg.norm(table.rest[..., 3, :].astype(np.float64), axis=-1)
    return np.asarray(_SHEARED * np.maximum(away, still), np.float64)
