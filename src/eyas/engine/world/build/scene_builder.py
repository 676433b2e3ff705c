"""Assembly of a scene: triangles, object ids, solid shapes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.mesh.assembly import concatenate
from eyas.engine.state.lighting import Horizon
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import ACTOR_OBJECT, Colliders, Fixtures, Lamps, ObjectClass, Scene
from eyas.engine.state.terrain import Terrain
from eyas.lanes import exact

Levels = tuple[Mesh, ...]  # A shape in levels of detail, the finest first


@dataclass(frozen=True, slots=True)
class Prototype:
    """A shape that is copied within a scene; made by `SceneBuilder.prototype`."""

    name: str
    number: int  # Index among the scene's fixtures
    trees: int = 0  # Number of trees in it


class SceneBuilder:
    """Collects the objects of a map; ids are given in the order in which objects are added."""

    def __init__(
        self,
        name: str,  # Name of the map
        seed: int,  # Seed of the map
        size: tuple[float, float],  # Extent of the floor, centred on the origin [m]
        terrain: Terrain,  # The ground
    ) -> None:
        self.terrain = terrain
        self._name, self._seed, self._size = name, seed, size
        self._prototypes: dict[str, tuple[Prototype, Callable[[], Levels]]] = {}
        self._classes: list[ObjectClass] = []
        self._meshes: list[Mesh] = []
        self._objects: list[int] = []
        self._prisms: list[tuple[NDArray[np.float64], float, float, int]] = []
        self._cylinders: list[tuple[tuple[float, float], float, float, float, int]] = []
        self._copies: list[tuple[Prototype, NDArray[np.float32], int]] = []

    def prototype(self, name: str, make: Callable[[], Levels], *, trees: int = 0) -> Prototype:
        """Return the prototype with a name; only the first call for a name uses its `make`.

        Args:
            name: Name of the prototype, for example `bench`.
            make: Returns the levels. `build` calls it after all copies have been placed, in the
                order of the first calls: so shapes and positions may share a random generator.
            trees: Number of trees in it; shrubs and hedges do not count.
        """
        if name not in self._prototypes:
            self._prototypes[name] = Prototype(name, len(self._prototypes), trees), make
        return self._prototypes[name][0]

    def add(self, kind: ObjectClass, *meshes: Mesh) -> int:
        """Add an object of static triangles; return its id."""
        owner = self._new_object(kind)
        self._meshes += meshes
        self._objects += [owner] * len(meshes)
        return owner

    def add_copy(
        self,
        kind: ObjectClass,
        prototype: Prototype,
        place: Sequence[float],
        turn: float,
        scale: float,
        owner: int | None = None,
    ) -> int:
        """Add a copy of a prototype; return the id of its object.

        Args:
            kind: Class of the object.
            prototype: Prototype of this builder.
            place: Position of its origin [m], 3 numbers.
            turn: Angle, counter-clockwise about z [rad].
            scale: Factor on its size.
            owner: Object that the copy is part of; None: a new object of class `kind`.
        """
        cosine, sine = scale * exact.cos(turn), scale * exact.sin(turn)
        pose = np.array(
            [
                [cosine, -sine, 0.0, place[0]],
                [sine, cosine, 0.0, place[1]],
                [0.0, 0.0, scale, place[2]],
            ],
            np.float32,
        )
        if owner is None:
            owner = self._new_object(kind)
        self._copies.append((prototype, pose, owner))
        return owner

    def add_prism(self, outline: ArrayLike, bottom: float, top: float, owner: int) -> None:
        """Add a solid with a counter-clockwise outline, shape (K, 2) [m]."""
        self._prisms.append((np.asarray(outline, np.float64), bottom, top, owner))

    def add_cylinder(
        self, centre: Sequence[float], radius: float, bottom: float, top: float, owner: int
    ) -> None:
        """Add an upright solid cylinder [m]."""
        place = (float(centre[0]), float(centre[1]))
        self._cylinders.append((place, radius, bottom, top, owner))

    def build(
        self,
        network: RoadNetwork,  # The roads
        lamps: Lamps | None = None,  # Street lamps; None: none
        horizon: Horizon | None = None,  # Hills beyond the map; None: those of most maps
    ) -> Scene:
        """Return the scene of everything that was added."""
        counts = [len(mesh.triangles) for mesh in self._meshes]
        poses = [pose for _, pose, _ in self._copies]
        return Scene(
            name=self._name,
            seed=self._seed,
            size=self._size,
            terrain=self.terrain,
            static=concatenate(self._meshes),
            static_object=np.repeat(np.array(self._objects, np.int32), counts),
            object_class=np.array(self._classes, np.int32),
            fixtures=Fixtures(
                levels=tuple(make() for _, make in self._prototypes.values()),
                prototype=np.array([one.number for one, _, _ in self._copies], np.int32),
                pose=np.array(poses, np.float32).reshape(-1, 3, 4),
                object_id=np.array([owner for _, _, owner in self._copies], np.int32),
                names=tuple(self._prototypes),
                trees=tuple(one.trees for one, _ in self._prototypes.values()),
            ),
            colliders=self._colliders(),
            network=network,
            lamps=lamps or Lamps.none(),
            horizon=horizon or Horizon(),
        )

    def _new_object(self, kind: ObjectClass) -> int:
        """Return the id of a new object."""
        if len(self._classes) >= ACTOR_OBJECT:
            raise ConfigError(
                f"world.map: '{self._name}' has more than {ACTOR_OBJECT:,} objects; merge some, "
                "as larger ids are reserved for moving objects"
            )
        self._classes.append(kind)
        return len(self._classes) - 1

    def _colliders(self) -> Colliders:
        outlines, bottoms, tops, owners = _columns(self._prisms, 4)
        centres, radii, lows, highs, holders = _columns(self._cylinders, 5)
        return Colliders(
            prism_points=np.concatenate([np.zeros((0, 2)), *outlines]),
            prism_first=np.cumsum([0, *map(len, outlines)]).astype(np.int32),
            prism_bottom=np.array(bottoms, np.float64),
            prism_top=np.array(tops, np.float64),
            prism_object=np.array(owners, np.int32),
            cylinder_centre=np.array(centres, np.float64).reshape(-1, 2),
            cylinder_radius=np.array(radii, np.float64),
            cylinder_bottom=np.array(lows, np.float64),
            cylinder_top=np.array(highs, np.float64),
            cylinder_object=np.array(holders, np.int32),
        )


def _columns(rows: Sequence[tuple], count: int) -> list[list]:  # type: ignore[type-arg]
    return [[row[column] for row in rows] for column in range(count)]
