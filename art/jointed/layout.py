"""The parts of people and robots, and where each is through a cycle of their motion."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from art.jointed.cycle import frames_of, shapes_of, skeleton_of, table_of
from art.jointed.extent import INTERVALS, extents_of
from art.jointed.model import JointedModel
from art.packing import columns_of
from art.parts import levels_of
from eyas.engine.state.mesh import Mesh
from eyas.engine.targets.jointed.rig import BODY, PART, Extents, JointedArrays
from eyas.lanes import exact


class JointedLayout:
    """The parts of the models of one kind.

    Args:
        models: All models of a kind.
    """

    def __init__(self, models: Sequence[JointedModel]) -> None:
        self._models = models
        self._drawn = [shapes_of(model.figure) for model in models]
        shapes = dict.fromkeys(shape for shapes in self._drawn for shape in shapes)
        self._place = {shape: number for number, shape in enumerate(shapes)}

    def part_levels(self) -> list[tuple[Mesh, ...]]:
        """Return the meshes of each part, the finest first.

        Raises:
            ConfigError: A model is not of the size that it says.
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

    def extents(self) -> dict[str, Extents]:
        """Return the boxes of each model, by its name."""
        return {model.name: extents_of(model.figure) for model in self._models}

    @property
    def arrays(self) -> JointedArrays:
        """What poses the parts."""
        shape = len(self._models), max(map(len, self._drawn))
        slot, body = np.zeros(shape, PART), np.zeros(shape[0], BODY)
        slot["part"] = -1
        track = np.full(shape, -1, np.int32)
        tracks: dict[bytes, NDArray[np.float64]] = {}
        for m, (model, own) in enumerate(zip(self._models, self._drawn, strict=True)):
            figure, count = model.figure, len(own)
            gait, scale = figure.gait, figure.scale
            slot["part"][m, :count] = [self._place[shape] for shape in own]
            for k, colour in enumerate(model.part_colours):
                if colour is not None:
                    slot["own"][m, k] = True
                    slot["red"][m, k], slot["green"][m, k], slot["blue"][m, k] = colour
            joints = [joint for joint in figure.joints if joint.shape is not None]
            slot["spins"][m, : len(joints)] = [joint.spins for joint in joints]
            slot["steers"][m, : len(joints)] = [joint.steers for joint in joints]
            body[m] = (
                1.0 / (scale * gait.stride), gait.slowest, scale * figure.wheel_radius,
                figure.upright,
            )  # fmt: skip
            skeleton, shown = skeleton_of(figure)
            still, moving = table_of(skeleton, INTERVALS)
            for k, part in enumerate(shown):
                frames = np.concatenate([still[:, part], moving[:, part]]).swapaxes(-1, -2)
                tracks.setdefault(frames.tobytes(), frames)
                track[m, k] = list(tracks).index(frames.tobytes())
        return JointedArrays(
            slot=columns_of(slot),
            body=columns_of(body),
            scale=np.array([model.figure.scale for model in self._models]),
            track=track,
            tracks=np.stack(list(tracks.values())),
        )
