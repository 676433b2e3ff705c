"""A stage: targets of one kind alone on a street, seen from any side."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eyas.render.renderer import build_renderer
from eyas.sim.scenes import load_geometry, load_scene
from eyas.state.draw import Picture, Views
from eyas.state.motion import ActorState
from eyas.state.scene import ACTOR_OBJECT
from eyas.targets.catalogue import MODELS, kind_index
from eyas.targets.kind import Colour, Looks
from eyas.targets.rig import Rigs
from eyas.world.maps import MAPS
from eyas.world.weather import DAY

__all__ = ["Camera", "Pose", "Stage"]

_MAP = "simpleway-lake"


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """How the target is at an instant; it heads east."""

    travelled: float = 0.0
    """[m]"""
    speed: float = 0.0
    """[m/s]"""
    yaw_rate: float = 0.0
    """[rad/s]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """A camera that looks at the target's middle."""

    bearing: float
    """Direction from the target to the camera, counter-clockwise from straight ahead [rad]."""
    elevation: float
    """Angle of that direction above the horizon [rad]."""
    distance: float
    """[m]"""
    field_of_view: float
    """Horizontal, and vertical if the picture is square [rad]."""


class Stage:
    """Draws the models of one kind.

    Args:
        kind: Name of the kind.
    """

    def __init__(self, kind: str) -> None:
        recipe, self._kind = MAPS.get(_MAP), kind_index(kind)
        season = recipe.season(DAY.name)
        self._scene = load_scene(_MAP, 0, season)
        geometry = load_geometry(_MAP, 0, season, (self._kind,))
        self._renderer = build_renderer(self._scene, geometry, recipe.light(DAY.name))

    @cached_property
    def _spot(self) -> NDArray[np.float64]:
        """The middle of a lane, far from its ends [m], shape (3,)."""
        points = self._scene.network.lane_points[: self._scene.network.lane_first[1]]
        return np.array([*points.mean(axis=0), 0.0])

    def draw(
        self,
        model: int,
        colour: Colour,
        shots: Sequence[tuple[Pose, Camera]],
        size: tuple[int, int],
        samples: int = 4,
    ) -> NDArray[np.uint8]:
        """Return a picture of each shot, sRGB, shape (V, *size, 3).

        Args:
            model: Index into `MODELS`.
            colour: The target's colour.
            shots: How it is, and from where it is seen.
            size: Height and width of the pictures [pixels].
            samples: Samples for each pixel, 1 or 4.
        """
        count = len(shots)
        rigs = Rigs(np.array([self._kind], np.int32))
        actors, movers = ActorState.create(count, 1), rigs.draw_list(count)
        actors.position[:] = self._spot
        actors.present[:] = True
        for v, (pose, _) in enumerate(shots):
            actors.travelled[v], actors.speed[v] = pose.travelled, pose.speed
            actors.yaw_rate[v] = pose.yaw_rate
        looks = Looks(
            np.full((count, 1), model, np.int32),
            np.tile(np.array(colour, np.float32), (count, 1, 1)),
        )
        rigs.pose(actors, looks, movers)
        picture = Picture.create(count, *size)
        self._renderer.draw(
            self._views(MODELS[model].size[2], [camera for _, camera in shots]),
            movers, picture, samples,
        )  # fmt: skip
        assert picture.rgb is not None  # asked for
        return picture.rgb

    def _views(self, height: float, cameras: Sequence[Camera]) -> Views:
        looks = [_rotation(camera) for camera in cameras]
        middle = self._spot + np.array([0.0, 0.0, height / 2])
        away = [-look[:, 0] * camera.distance for look, camera in zip(looks, cameras, strict=True)]
        fields = np.array([camera.field_of_view for camera in cameras])
        return Views(
            position=middle + np.array(away),
            rotation=np.array(looks),
            world=np.arange(len(cameras), dtype=np.int32),
            subject=np.full(len(cameras), ACTOR_OBJECT, np.int32),
            field_of_view=fields,
            instant=np.zeros(len(cameras)),
        )


def _rotation(camera: Camera) -> NDArray[np.float64]:
    """Return camera to world; columns are forward, left, up."""
    level = np.cos(camera.elevation)
    forward = -np.array([
        np.cos(camera.bearing) * level, np.sin(camera.bearing) * level, np.sin(camera.elevation),
    ])  # fmt: skip
    left = np.array([np.sin(camera.bearing), -np.cos(camera.bearing), 0.0])
    return np.stack([forward, left, np.cross(forward, left)], axis=1)
