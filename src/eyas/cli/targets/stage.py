"""A stage: a target alone on a street, seen from any side."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.renderer import build_renderer
from eyas.engine.sim.scenes import load_geometry, load_scene
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index, kind_of
from eyas.engine.targets.kind import Colour, Looks
from eyas.engine.targets.rig import Rigs
from eyas.engine.world.maps import MAPS
from eyas.engine.world.weather import DAY

_MAP = "simpleway-lake"


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetPose:
    """How the target is at an instant; it heads along the street."""

    travelled: float = 0.0  # [m]
    speed: float = 0.0  # [m/s]
    yaw_rate: float = 0.0  # [rad/s]
    individual: int = 0  # Which of the vehicles of its model: they differ in details


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """A camera that looks at the target's middle."""

    bearing: float
    """Direction from the target to the camera, counter-clockwise from straight ahead [rad]."""
    elevation: float  # Angle of that direction above the horizon [rad]
    distance: float  # [m]
    field_of_view: float  # Horizontal, and vertical if the picture is square [rad]


class TargetStage:
    """Draws targets, one at a time."""

    def __init__(self, kinds: Sequence[str]) -> None:
        recipe = MAPS.get(_MAP)
        self._kinds = sorted(kind_index(kind) for kind in kinds)
        season = recipe.season(DAY.name)
        scene = load_scene(_MAP, 0, season)
        geometry = load_geometry(_MAP, 0, season, tuple(self._kinds))
        self._renderer = build_renderer(scene, geometry, recipe.light(DAY.name))
        self._rigs = Rigs(np.array(self._kinds, np.int32))
        lane = scene.network.lane_points[: scene.network.lane_first[1]]
        self._spot = np.array([*lane.mean(axis=0), 0.0])
        """The middle of a lane, far from its ends [m]."""
        self._ahead = np.array([*(lane[-1] - lane[0]), 0.0])
        self._ahead /= np.linalg.norm(self._ahead)

    def draw(
        self,
        model: int,
        colour: Colour,
        shots: Sequence[tuple[TargetPose, Camera]],
        size: tuple[int, int],
        samples: int = 4,
    ) -> NDArray[np.uint8]:
        """Return a picture of each shot, sRGB, shape (V, *size, 3).

        Args:
            size: Height and width of the pictures [pixels].
        """
        count, kinds = len(shots), len(self._kinds)
        actor = self._kinds.index(kind_index(MODELS[model].kind))
        actors, movers = ActorState.create(count, kinds), self._rigs.draw_list(count)
        actors.yaw[:] = np.arctan2(self._ahead[1], self._ahead[0])
        actors.present[:, actor] = True
        for v, (pose, _) in enumerate(shots):
            actors.position[v] = self._spot + pose.travelled * self._ahead
            actors.travelled[v], actors.speed[v] = pose.travelled, pose.speed
            actors.yaw_rate[v] = pose.yaw_rate
            movers.object_id[v] += pose.individual
        models = np.array([MODELS.index(KINDS[kind].models[0]) for kind in self._kinds], np.int32)
        models[actor] = model
        colours = np.tile(np.array(colour, np.float32), (count, kinds, 1))
        self._rigs.pose(actors, Looks(np.tile(models, (count, 1)), colours), movers)
        movers.object_id[:] = self._rigs.draw_list(1).object_id
        picture = Picture.create(count, *size)
        middles = actors.position[:, actor] + kind_of(model).ahead * self._ahead
        middles[:, 2] += MODELS[model].size[2] / 2
        views = self._views(middles, actor, [camera for _, camera in shots])
        self._renderer.draw(views, movers, picture, samples)
        assert picture.rgb is not None  # asked for
        return picture.rgb

    def _views(self, middles: NDArray[np.float64], actor: int, cameras: Sequence[Camera]) -> Views:
        yaw = float(np.arctan2(self._ahead[1], self._ahead[0]))
        looks = np.array([_rotation(camera, yaw) for camera in cameras])
        away = np.array([camera.distance for camera in cameras])
        return Views(
            position=middles - away[:, None] * looks[:, :, 0],
            rotation=looks,
            world=np.arange(len(cameras), dtype=np.int32),
            subject=np.full(len(cameras), ACTOR_OBJECT + actor, np.int32),
            field_of_view=np.array([camera.field_of_view for camera in cameras]),
            instant=np.zeros(len(cameras)),
        )


def _rotation(camera: Camera, yaw: float) -> NDArray[np.float64]:
    """Return camera to world for a target with this heading; columns are forward, left, up."""
    level, bearing = np.cos(camera.elevation), camera.bearing + yaw
    forward = -np.array([
        np.cos(bearing) * level, np.sin(bearing) * level, np.sin(camera.elevation),
    ])  # fmt: skip
    left = np.array([np.sin(bearing), -np.cos(bearing), 0.0])
    return np.stack([forward, left, np.cross(forward, left)], axis=1)
