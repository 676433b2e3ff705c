"""The world file: ground, roads, buildings, plants as triangles, in the light of a weather."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from eyas.dat.webots.vrml import Is, Node, Use, Value, floats, indices, label
from eyas.engine.state.lighting import Lighting
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.scene import Lamps, ObjectClass, Scene
from eyas.engine.state.terrain import Terrain
from eyas.lanes import exact
from eyas.maps.formats.gltf.file import PLAIN
from eyas.maps.formats.meshes import (
    Indexed,
    MeshPart,
    copies_of,
    parts_of,
    prism,
    prototypes_of,
    subset,
    welded,
)

_ROUGH = {Surface.WATER: 0.1, Surface.GLASS: 0.1, Surface.PAINT: 0.35}
_FLAT = 0.9999  # Cosine of the largest angle between the normals of a face's corners and its own
_STEP = 1e-4  # Resolution of positions, normals and texture coordinates, as they are written

Floats = NDArray[np.float64]


class VrmlShapes:
    """Makes the shapes of one file; each material is told once.

    Attributes:
        textures: Names of the textures that they show.

    Args:
        folder: Folder of the textures, relative to the file.
        paint: Field of a PROTO that colours what is painted; empty: it is white.
        lit: Whether lamps shine.
    """

    def __init__(self, folder: str, paint: str = "", *, lit: bool = False) -> None:
        self.textures: set[str] = set()
        self._folder, self._paint = folder, paint
        self._names: dict[Material, str] = {}
        self._shining = {Surface.SIGNAL, Surface.LAMP} if lit else {Surface.SIGNAL}

    def of(self, mesh: Mesh) -> list[Node]:
        """Return a mesh as shapes, one for each material; none without triangles that have an
        area.
        """
        shapes = []
        for index in np.unique(mesh.materials).tolist():
            material = mesh.palette[index]
            part = subset(mesh, np.flatnonzero(mesh.materials == index))
            geometry = _geometry(part, textured=material.texture != PLAIN)
            if geometry is not None:
                shown: dict[str, Value] = {"appearance": self._look(material), "geometry": geometry}
                if material.surface is Surface.CROWN:
                    shown["castShadows"] = False
                shapes.append(Node("Shape", shown))
        return shapes

    def _look(self, material: Material) -> Node | Use:
        if material in self._names:
            return Use(self._names[material])
        name = label(f"{material.texture}_{len(self._names)}")
        self._names[material] = name
        painted = self._paint and material.surface is Surface.PAINT and min(material.tint) > 0.9
        tint = tuple(min(round(part, 4), 1.0) for part in material.tint)
        look: dict[str, Value] = {
            "baseColor": Is(self._paint) if painted else tint,
            "roughness": _ROUGH.get(material.surface, 1.0),
            "metalness": 0.0,
        }
        if material.texture != PLAIN:
            self.textures.add(material.texture)
            url = f"{self._folder}/{material.texture}.png"
            look["baseColorMap"] = Node("ImageTexture", {"url": [url]})
        if material.surface in self._shining:
            look["emissiveColor"] = tint
        return Node("PBRAppearance", look, name)


def _geometry(mesh: Mesh, *, textured: bool) -> Node | None:
    shape = welded(mesh, _STEP)
    if not len(shape.materials):
        return None
    fields = _indexed("coord", "Coordinate", "point", shape.points)
    turned = (shape.normals.values[shape.normals.corners] * shape.across[:, None, :]).sum(axis=2)
    if (turned < _FLAT).any():
        fields |= _indexed("normal", "Normal", "vector", shape.normals)
    if textured:
        fields |= _indexed("texCoord", "TextureCoordinate", "point", shape.uvs)
    return Node("IndexedFaceSet", fields)


def _indexed(name: str, kind: str, inner: str, told: Indexed) -> dict[str, Value]:
    """Return a field of vectors, and that of their indices."""
    vectors = Node(kind, {inner: floats(told.values)})
    return {name: vectors, f"{name}Index": indices(told.corners)}


def face_set(points: Floats, triangles: NDArray[np.integer]) -> Node:
    """Return triangles without looks, for what is solid."""
    coordinates = Node("Coordinate", {"point": floats(points)})
    return Node("IndexedFaceSet", {"coord": coordinates, "coordIndex": indices(triangles)})


BASIC_STEP = 2  # Step of the physics, as in the original [ms]

_SUN = 1.77  # Intensity of the original's sun, which by a clear day has the colour 1

_GROUND = {ObjectClass.GROUND, ObjectClass.WATER}  # What is drawn by the node `land`


def sky_nodes(
    title: str,  # Name of the world
    light: Lighting,  # Light and air
    notice: str,  # Whose data the map is made of
) -> list[Node]:
    """Return the nodes about the world as a whole: settings, view, sky, sun and fog."""
    sky = [0.5 * (a + b) for a, b in zip(light.zenith_colour, light.horizon_colour, strict=True)]
    told = ["Made by Eyas for Webots R2023b, where its authors have not seen it run.", *[notice]]
    nodes = [
        Node(
            "WorldInfo",
            {
                "title": title, "info": [line for line in told if line],
                "basicTimeStep": BASIC_STEP, "FPS": 30, "coordinateSystem": "ENU",
            },
        ),
        Node(
            "Viewpoint",
            {"orientation": (0.0, 1.0, 0.0, 0.9), "position": (-60.0, 0.0, 70.0), "near": 3.0},
        ),
        Node("Background", {"skyColor": [_shown(sky)], "luminosity": light.luminosity}, "tbg"),
        _sun(light),
    ]  # fmt: skip
    if light.foggy:
        nodes.append(
            Node(
                "Fog",
                {
                    "color": _shown(light.fog_colour),
                    "fogType": "EXPONENTIAL2" if light.fog_power == 2 else "EXPONENTIAL",
                    "visibilityRange": 1.0 / light.fog_density,
                },
                "fog",
            )
        )
    return nodes


def _sun(light: Lighting) -> Node:
    strongest = max(light.sun_colour)
    colour = [part / strongest if strongest else 1.0 for part in light.sun_colour]
    return Node(
        "DirectionalLight",
        {
            "color": _shown(colour),
            "direction": tuple(-part for part in light.sun_direction),
            "intensity": _SUN * strongest,
            "castShadows": strongest > 0.0,
        },
        "tbgl",
    )


def _shown(radiance: Sequence[float]) -> tuple[float, ...]:
    """Return a linear colour as sRGB."""
    return tuple(
        round(float(exact.power(min(max(part, 0.0), 1.0), 1 / 2.2)), 4) for part in radiance
    )


def scene_nodes(scene: Scene, shapes: VrmlShapes, detail: int, *, shining: bool) -> Iterator[Node]:
    """Yield the nodes of all that stands on a map: a solid for the ground, one for each building
    and the like, and one for each class of repeated things.

    Args:
        shapes: Makes the shapes of the file.
        shining: Whether street lamps shine.
    """
    solid = _Solids(scene)
    parts = list(parts_of(scene))
    yield _land(scene, shapes, [part.mesh for part in parts if part.object_class in _GROUND])
    for part in parts:
        if part.object_class not in _GROUND:
            yield _part(part, shapes, solid)
    yield from _repeated(scene, shapes, detail)
    touched = solid.rest()
    if touched:
        fields: dict[str, Value] = {"name": "solid things", "boundingObject": _group(touched)}
        yield Node("Solid", fields, "solid_things")
    yield from _lamps(scene.lamps, shining=shining)


def _land(scene: Scene, shapes: VrmlShapes, meshes: Sequence[Mesh]) -> Node:
    """Return the ground: its drawn meshes, and the grid of its heights, which is solid."""
    shown = [shape for mesh in meshes for shape in shapes.of(_lifted(mesh, scene.terrain.floor))]
    grid, west, south = _grid(scene.terrain, scene.size)
    bound = Node("Pose", {"translation": (west, south, 0.0), "children": [grid]})
    return Node(
        "Solid",
        {
            "translation": (0.0, 0.0, scene.terrain.floor), "name": "land",
            "children": shown, "boundingObject": bound, "locked": True,
        },
        "land",
    )  # fmt: skip


def _lifted(mesh: Mesh, floor: float) -> Mesh:
    """Return a mesh in the frame of the land."""
    places = mesh.positions - np.array([0.0, 0.0, floor], np.float32)
    return Mesh(places, mesh.normals, mesh.uvs, mesh.triangles, mesh.materials, mesh.palette)


def _grid(terrain: Terrain, size: tuple[float, float]) -> tuple[Node, float, float]:
    """Return the heights above the floor, and where their south-western corner is [m]."""
    heights, spacing = terrain.relief, (terrain.spacing, terrain.spacing)
    west, south = terrain.west, terrain.south
    if not heights.size:
        heights, spacing = np.zeros((2, 2), np.float32), size
        west, south = -0.5 * size[0], -0.5 * size[1]
    fields: dict[str, Value] = {
        "xDimension": heights.shape[1], "yDimension": heights.shape[0],
        "xSpacing": spacing[0], "ySpacing": spacing[1],
        "height": floats(heights.ravel()),
    }  # fmt: skip
    return Node("ElevationGrid", fields), west, south


def _part(part: MeshPart, shapes: VrmlShapes, solid: "_Solids") -> Node:
    owner = int(part.name.rpartition("-")[2])
    fields: dict[str, Value] = {"name": part.name, "children": shapes.of(part.mesh)}
    touched = solid.of(owner)
    if touched:
        fields["boundingObject"] = _group(touched)
    return Node("Solid", {**fields, "locked": True}, label(part.name))


def _group(nodes: list[Node]) -> Node:
    return Node("Group", {"children": nodes})


def _repeated(scene: Scene, shapes: VrmlShapes, detail: int) -> Iterator[Node]:
    """Yield a group for each class of repeated things; each prototype is told once."""
    prototypes = prototypes_of(scene.fixtures, detail)
    groups: dict[ObjectClass, list[Value]] = {}
    named: dict[int, Use] = {}
    for copies in copies_of(scene):
        number = copies.prototype
        if not len(prototypes[number].triangles):
            continue
        for pose in copies.pose.astype(np.float64):
            if number not in named:
                name = label(f"{copies.name}_{number}")
                shown: Value = Node("Group", {"children": shapes.of(prototypes[number])}, name)
                named[number] = Use(name)
            else:
                shown = named[number]
            groups.setdefault(copies.object_class, []).append(_copy(pose, shown))
    for kind, things in groups.items():
        yield Node("Group", {"children": things}, label(f"{kind.name.lower()}s"))


def _copy(pose: Floats, shown: Value) -> Node:
    size = np.sqrt(np.square(pose[:, :3]).sum(axis=0))
    fields: dict[str, Value] = {
        "translation": _rounded(pose[:, 3]), "rotation": _axis_angle(pose[:, :3] / size),
        "scale": _rounded(size), "children": [shown],
    }  # fmt: skip
    return Node("Transform", fields)


def _rounded(values: Floats) -> tuple[float, ...]:
    return tuple(round(float(value), 8) + 0.0 for value in values)


def _axis_angle(turn: Floats) -> tuple[float, ...]:
    """Return a rotation matrix as a unit axis and an angle [rad]."""
    twice = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    sine = 0.5 * exact.length(twice)
    cosine = 0.5 * (float(np.trace(turn)) - 1.0)
    angle = float(exact.atan2(sine, cosine))
    if sine > 1e-6:
        axis = twice / (2.0 * sine)
    elif cosine > 0.0:
        return 0.0, 0.0, 1.0, 0.0
    else:  # half a turn: the axis is that of the projection (R + 1) / 2
        projection = 0.5 * (turn + np.eye(3))
        axis = projection[:, int(np.argmax(np.diag(projection)))]
        axis = axis / exact.length(axis)
    return (*_rounded(axis), round(angle, 8))


def _lamps(lamps: Lamps, *, shining: bool) -> Iterator[Node]:
    for number, (place, axis) in enumerate(zip(lamps.position, lamps.axis, strict=True)):
        yield Node(
            "SpotLight",
            {
                "location": _rounded(place.astype(np.float64)),
                "direction": _rounded(axis.astype(np.float64)),
                "intensity": lamps.intensity, "attenuation": (0.0, 0.0, 1.0),
                "beamWidth": 0.8 * lamps.cut_off, "cutOffAngle": lamps.cut_off, "radius": 60.0,
                "color": (1.0, 1.0, 1.0), "on": shining,
            },
            f"lamp_{number}",
        )  # fmt: skip


class _Solids:
    """What bodies meet: prisms and upright cylinders, by the object that they are of."""

    def __init__(self, scene: Scene) -> None:
        solids = scene.colliders
        self._of: dict[int, list[Node]] = {}
        for number, (low, high) in enumerate(pairwise(solids.prism_first.tolist())):
            span = float(solids.prism_bottom[number]), float(solids.prism_top[number])
            made = face_set(*prism(solids.prism_points[low:high], span))
            self._of.setdefault(int(solids.prism_object[number]), []).append(made)
        for number, radius in enumerate(solids.cylinder_radius.tolist()):
            bottom = float(solids.cylinder_bottom[number])
            height = float(solids.cylinder_top[number]) - bottom
            x, y = solids.cylinder_centre[number].tolist()
            made = Node(
                "Pose",
                {
                    "translation": (x, y, bottom + 0.5 * height),
                    "children": [Node("Cylinder", {"height": height, "radius": radius})],
                },
            )
            self._of.setdefault(int(solids.cylinder_object[number]), []).append(made)

    def of(self, owner: int) -> list[Node]:
        """Return those of an object, once."""
        return self._of.pop(owner, [])

    def rest(self) -> list[Node]:
        """Return those that are left, such as trunks."""
        return [node for nodes in self._of.values() for node in nodes]
