"""Putting a scene together: triangles, object ids, solid shapes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.mesh.assembly import concatenate
from eyas.state.mesh import Mesh
from eyas.state.roads import RoadNetwork
from eyas.state.scene import Colliders, Fixtures, Lamps, ObjectClass, Scene

__all__ = ["SceneBuilder"]


class SceneBuilder:
    """Collects what stands in a map; ids are given in the order in which objects are added."""

    def __init__(self) -> None:
        self._classes: list[ObjectClass] = []
        self._meshes: list[Mesh] = []
        self._objects: list[int] = []
        self._prisms: list[tuple[NDArray[np.float64], float, float, int]] = []
        self._cylinders: list[tuple[tuple[float, float], float, float, float, int]] = []
        self._copies: list[tuple[int, NDArray[np.float32], int]] = []

    def add(self, kind: ObjectClass, *meshes: Mesh) -> int:
        """Add an object of static triangles; return its id."""
        self._classes.append(kind)
        self._meshes += meshes
        self._objects += [len(self._classes) - 1] * len(meshes)
        return len(self._classes) - 1

    def add_copy(
        self,
        kind: ObjectClass,
        prototype: int,
        place: Sequence[float],
        turn: float,
        scale: float,
        owner: int | None = None,
    ) -> int:
        """Add a copy of one of the fixtures that `build` is given; return its id.

        Args:
            kind: What it is.
            prototype: Which fixture.
            place: Where its origin stands [m], 3 numbers.
            turn: Counter-clockwise about z [rad].
            scale: Factor on its size.
            owner: The object that it is part of; None: it is one of its own, of class `kind`.
        """
        cosine, sine = scale * np.cos(turn), scale * np.sin(turn)
        pose = np.array(
            [
                [cosine, -sine, 0.0, place[0]],
                [sine, cosine, 0.0, place[1]],
                [0.0, 0.0, scale, place[2]],
            ],
            np.float32,
        )
        if owner is None:
            self._classes.append(kind)
            owner = len(self._classes) - 1
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
        name: str,
        seed: int,
        size: tuple[float, float],
        ground_height: float,
        levels: Sequence[tuple[Mesh, ...]],
        network: RoadNetwork,
        lamps: Lamps | None = None,
    ) -> Scene:
        """Return the scene of all that was added; for the arguments see `Scene` and `Fixtures`."""
        counts = [len(mesh.triangles) for mesh in self._meshes]
        poses = [pose for _, pose, _ in self._copies]
        return Scene(
            name=name,
            seed=seed,
            size=size,
            ground_height=ground_height,
            static=concatenate(self._meshes),
            static_object=np.repeat(np.array(self._objects, np.int32), counts),
            object_class=np.array(self._classes, np.int32),
            fixtures=Fixtures(
                levels=tuple(levels),
                prototype=np.array([kind for kind, _, _ in self._copies], np.int32),
                pose=np.array(poses, np.float32).reshape(-1, 3, 4),
                object_id=np.array([owner for _, _, owner in self._copies], np.int32),
            ),
            colliders=self._colliders(),
            network=network,
            lamps=lamps or Lamps.none(),
        )

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
