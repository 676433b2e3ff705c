"""The static world, as plain arrays."""

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.lighting import Horizon
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.terrain import Terrain

SKY_OBJECT = -1  # Object id of a pixel that shows the sky; kernels read it
ACTOR_OBJECT = 1 << 16
"""Object id of actor 0; actor a has `ACTOR_OBJECT + a`. Smaller ids are objects of the scene."""

LAST_PARKED = ACTOR_OBJECT - (1 << 14) - 1
"""Largest id of an object of the scene that labels list: masks, of 16 bits, have room for 16,384
actors besides."""


class ObjectClass(IntEnum):
    """Class of an object; the values of `Picture.class_id`."""

    GROUND = 0
    ROAD = 1
    MARKING = 2
    PAVEMENT = 3
    BUILDING = 4
    TREE = 5
    STRUCTURE = 6
    POLE = 7
    WATER = 8
    CAR = 9
    """This and the other classes of `LABELLED` are those of actors, and of what is parked."""
    SKY = 10
    """No object."""
    TRUCK = 11
    """A truck, including its trailer."""
    BUS = 12
    MOTORCYCLE = 13
    """A motorcycle, including its rider."""
    PERSON = 14
    ROBOT = 15
    BICYCLE = 16
    """A bicycle, including its rider; a rack with bicycles."""
    BOAT = 17
    TRAIN = 18
    """A whole train."""


LABELLED = frozenset(
    {
        ObjectClass.CAR,
        ObjectClass.TRUCK,
        ObjectClass.BUS,
        ObjectClass.MOTORCYCLE,
        ObjectClass.PERSON,
        ObjectClass.ROBOT,
        ObjectClass.BICYCLE,
        ObjectClass.BOAT,
        ObjectClass.TRAIN,
    }
)
"""Classes of what labels list: whatever moves, and what of the same looks stands still."""

DRONE_CLASS = max(ObjectClass) + 1
"""Stands for the body of a tracker where contacts are told; pictures show it as a robot."""


@dataclass(slots=True)
class Fixtures:
    """Copies of a few meshes that stand in the world (trees, poles). F copies."""

    levels: tuple[tuple[Mesh, ...], ...]  # Meshes of each prototype, the finest first
    prototype: NDArray[np.int32]  # Prototype of each copy, shape (F,)
    pose: NDArray[np.float32]  # Rotation times scale, and translation [m], shape (F, 3, 4)
    object_id: NDArray[np.int32]  # Object of the scene, shape (F,)
    names: tuple[str, ...] = ()
    """Name of each prototype, for people and tests; drawing does not use it."""
    trees: tuple[int, ...] = ()
    """Number of trees in each prototype: 0 for shrubs and all else, several for a stand."""


@dataclass(slots=True)
class Colliders:
    """Solid shapes for rays and collisions. B prisms with K corners in all, C capped cylinders."""

    prism_points: NDArray[np.float64]  # Corners, counter-clockwise [m], shape (K, 2)
    prism_first: NDArray[np.int32]  # Start of each prism's corners, shape (B + 1,)
    prism_bottom: NDArray[np.float64]  # z [m], shape (B,)
    prism_top: NDArray[np.float64]  # z [m], shape (B,)
    prism_object: NDArray[np.int32]  # Object of the scene, shape (B,)
    cylinder_centre: NDArray[np.float64]  # [m], shape (C, 2)
    cylinder_radius: NDArray[np.float64]  # [m], shape (C,)
    cylinder_bottom: NDArray[np.float64]  # z [m], shape (C,)
    cylinder_top: NDArray[np.float64]  # z [m], shape (C,)
    cylinder_object: NDArray[np.int32]  # Object of the scene, shape (C,)


@dataclass(slots=True)
class Lamps:
    """Street lamps: spotlights that shine when the weather has them on. L lamps."""

    position: NDArray[np.float32]  # Position of the light [m], shape (L, 3)
    axis: NDArray[np.float32]  # Unit vectors along the middle of the beams, shape (L, 3)
    intensity: float = 30.0
    """Intensity in the original's unit (its sun has 2.7), per squared distance in metres."""
    cut_off: float = 1.4  # Angle from the axis at which a beam ends [rad]

    @classmethod
    def none(cls) -> "Lamps":
        """Return an empty set of lamps."""
        return cls(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.float32))


@dataclass(slots=True)
class Footways:
    """Ways of people in plan view: beside R kerbs, over C crossings."""

    kerb_points: NDArray[np.float64]
    """Outlines of the asphalt, which lies on their left [m], shape (K, 2); the first point of each
    is also its last. None where pavements lie along the network."""
    kerb_first: NDArray[np.int32]  # Start of each outline's points, shape (R + 1,)
    crossings: NDArray[np.float64]  # Ends of each, at the kerbs [m], shape (C, 2, 2)
    lights: tuple[str, ...]
    """Names of the crossings' lights in the network, C; empty where there are none."""

    @property
    def told(self) -> bool:
        """Whether the map tells its kerbs."""
        return len(self.kerb_first) > 1

    @classmethod
    def none(cls) -> "Footways":
        """Return those of a map without crossings, whose pavements lie along its network."""
        return cls(np.zeros((0, 2)), np.zeros(1, np.int32), np.zeros((0, 2, 2)), ())


@dataclass(slots=True)
class Scene:
    """Everything static on a map. T static triangles, O objects."""

    name: str
    """Name of the map."""
    seed: int
    """Seed of the map."""
    size: tuple[float, float]
    """Extent of the floor, centred on the origin [m]."""
    terrain: Terrain
    """Height of the ground; roads and buildings follow it."""
    static: Mesh
    """World-space triangles."""
    static_object: NDArray[np.int32]
    """Object of each static triangle, shape (T,)."""
    object_class: NDArray[np.int32]
    """`ObjectClass` of each object, shape (O,); the index is the object's id."""
    fixtures: Fixtures
    """Trees and other repeated things."""
    colliders: Colliders
    """Solid shapes."""
    network: RoadNetwork
    """The roads traffic drives on."""
    lamps: Lamps = field(default_factory=Lamps.none)
    """Street lamps."""
    horizon: Horizon = field(default_factory=Horizon)
    """Hills all around the map, far beyond its edge."""
    footways: Footways = field(default_factory=Footways.none)
    """Ways of people."""

    @classmethod
    def empty(cls) -> "Scene":
        """Return a scene without objects; its floor is 100 m wide, at z = 0."""
        none, flat, ids = np.zeros(0), np.zeros((0, 2)), np.zeros(0, np.int32)
        first = np.zeros(1, np.int32)
        return cls(
            name="empty",
            seed=0,
            size=(100.0, 100.0),
            terrain=Terrain.flat(0.0),
            static=Mesh.none(),
            static_object=ids,
            object_class=ids,
            fixtures=Fixtures((), ids, np.zeros((0, 3, 4), np.float32), ids),
            colliders=Colliders(flat, first, none, none, ids, flat, none, none, none, ids),
            network=RoadNetwork(
                "", "", flat, first, none, none, ids, ids, (), (), (), flat, first, ()
            ),
        )
