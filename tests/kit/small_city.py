"""A small city for tests: plain shapes whose pictures can be computed by hand."""

import dataclasses

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.mesh.flat import flat_polygon, walls
from eyas.engine.mesh.solids import box, cylinder, sphere
from eyas.engine.render.bake.shadows import ShadowMap
from eyas.engine.render.kernels.bundles import TILE
from eyas.engine.state.draw import DrawList, PartLibrary, Views
from eyas.engine.state.lighting import Lighting
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.scene import Fixtures, Scene
from eyas.engine.world.build.materials import TEXTURES, facade, material
from eyas.maps.roads.painting import RoadPaint, Stripe, margins_of, mesh_of

GROUND, ROAD, TOWER, TREE = 0, 1, 2, 3
TREE_OBJECT = 90
LINE = 91

DAY = Lighting(
    sun_direction=(-0.45, 0.45, 0.7713624),
    sun_colour=(0.95, 0.9, 0.8),
    zenith_colour=(0.10, 0.22, 0.52),
    horizon_colour=(0.60, 0.70, 0.82),
    ambient_up=(0.24, 0.30, 0.40),
    ambient_down=(0.16, 0.15, 0.12),
    fog_colour=(0.60, 0.70, 0.82),
    fog_density=0.0006,
)


def textures() -> dict[str, NDArray[np.uint8]]:
    """Smooth noise in the colours of the real textures."""
    rng = np.random.default_rng(1)
    base = {
        "plain": (255, 255, 255), "asphalt": (70, 70, 74), "lawn": (86, 118, 52),
        "leaves": (70, 108, 44), "bark": (96, 80, 62), "paving": (150, 146, 138),
    }  # fmt: skip
    images = {}
    for name in TEXTURES:
        grain = np.kron(rng.random((64, 64)), np.ones((4, 4)))
        grain = (grain + np.roll(grain, 2, 0) + np.roll(grain, 2, 1)) / 3
        image = np.empty((256, 256, 4))
        image[..., :3] = base.get(name, (170, 160, 148))
        image[..., :3] *= 1.0 if name == "plain" else (0.75 + 0.5 * grain[..., None])
        image[..., 3] = 255
        if name == "leaves":
            image[..., 3] = np.where(grain > 0.42, 255, 0)
        if name.startswith("facade"):
            for row in range(4):
                for column in range(4):
                    image[row * 64 + 16 : row * 64 + 48, column * 64 + 18 : column * 64 + 46] = (
                        40, 48, 56, 0,
                    )  # fmt: skip
        images[name] = np.clip(image, 0, 255).astype(np.uint8)
    return images


def tree(subdivisions: int) -> Mesh:
    """A trunk and a crown of two shells, the outer one with holes."""
    leaves = Material("leaves", surface=Surface.FOLIAGE)
    shells = []
    inside = Material("leaves", (0.5, 0.55, 0.5), Surface.CROWN)
    for radius, what in ((2.2, inside), (2.6, leaves)):
        pose = np.array([[radius, 0, 0, 0], [0, radius, 0, 0], [0, 0, radius, 5.5]])
        shells.append(transformed(sphere(subdivisions, what, tile=0.8), pose))
    trunk = cylinder((0.25, 0.18), (0.0, 4.0), 8, material("bark"))
    return concatenate([trunk, *shells])


def untiled(shadows: ShadowMap) -> NDArray[np.uint16]:
    """The whole shadow map, 0 where it has no tiles."""
    lines, columns = (TILE * n + 1 for n in shadows.tile.shape)
    whole = np.zeros((lines, columns), np.uint16)
    for i, j in np.argwhere(shadows.tile > 0):
        part = whole[TILE * i : TILE * i + TILE + 1, TILE * j : TILE * j + TILE + 1]
        part[:] = shadows.heights[shadows.tile[i, j]]
    return whole


def car_parts() -> PartLibrary:
    """Body, cabin and wheel."""
    paint = Material("plain", surface=Surface.PAINT)
    glass = Material("plain", (0.2, 0.24, 0.28), Surface.GLASS)
    black = Material("plain", (0.12, 0.12, 0.12))
    body = box((4.4, 1.8, 0.7), (0, 0, 0.65), paint, 1.0)
    cabin = box((2.2, 1.6, 0.55), (-0.2, 0, 1.27), glass, 1.0)
    wheel = sphere(1, black)
    scale = np.array([[0.33, 0, 0, 0], [0, 0.15, 0, 0], [0, 0, 0.33, 0]])
    wheel = Mesh(
        wheel.positions @ scale[:, :3].T.astype(np.float32), wheel.normals, wheel.uvs,
        wheel.triangles, wheel.materials, wheel.palette,
    )  # fmt: skip
    return PartLibrary(parts=((body,), (cabin,), (wheel,)), lamps=(True, True, True))


def put_car(draw_list: DrawList, world: int, slot: int, actor: int, x: float, y: float, yaw: float):
    """Fill six slots with a car."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    base = np.array([[cos, -sin, 0, x], [sin, cos, 0, y], [0, 0, 1, 0]])
    offsets = [(0, 0, 0), (0, 0, 0)]
    offsets += [(a, b, 0.33) for a in (-1.4, 1.4) for b in (-0.85, 0.85)]
    for k, offset in enumerate(offsets):
        pose = base.copy()
        pose[:, 3] += base[:, :3] @ offset
        draw_list.part[world, slot + k] = min(k, 2)
        draw_list.pose[world, slot + k] = pose
        draw_list.object_id[world, slot + k] = (1 << 16) + actor
        hue = (actor * 0.37) % 1.0
        draw_list.colour[world, slot + k] = (0.2 + 0.7 * hue, 0.15, 0.8 - 0.6 * hue)


def scene_of(
    meshes: list[Mesh], objects: list[int], fixtures: Fixtures | None = None, size: float = 400.0
) -> Scene:
    """A scene of world-space meshes, an object id for each."""
    ids = [np.full(len(m.triangles), o, np.int32) for m, o in zip(meshes, objects, strict=True)]
    scene = Scene.empty()
    return dataclasses.replace(
        scene,
        size=(size, size),
        static=concatenate(meshes),
        static_object=np.concatenate([np.zeros(0, np.int32), *ids]),
        object_class=np.zeros(128, np.int32),
        fixtures=fixtures or scene.fixtures,
    )


def trees_at(places: list[tuple[float, float]]) -> Fixtures:
    """Trees with three levels of detail."""
    poses = np.zeros((len(places), 3, 4), np.float32)
    for pose, (x, y) in zip(poses, places, strict=True):
        scale = 0.8 + 0.05 * (int(abs(x) + abs(y)) % 8)
        pose[:, :3] = scale * np.eye(3)
        pose[:, 3] = (x, y, 0.0)
    return Fixtures(
        levels=((tree(3), tree(2), tree(1)),),
        prototype=np.zeros(len(places), np.int32),
        pose=poses,
        object_id=np.full(len(places), TREE_OBJECT, np.int32),
    )


def floor(half: float = 200.0, texture: str = "lawn") -> Mesh:
    """A flat square at z = 0."""
    tile = TEXTURES[texture]
    return flat_polygon(shapely.box(-half, -half, half, half), 0.0, material(texture), tile)


def tower(x: float, y: float, side: float, height: float) -> Mesh:
    """A house with windows and a flat roof."""
    half = side / 2
    outline = [
        (x - half, y - half),
        (x + half, y - half),
        (x + half, y + half),
        (x - half, y + half),
    ]
    roof = flat_polygon(shapely.Polygon(outline), height, material("concrete"), 6.0)
    return concatenate([walls(outline, 0.0, height, facade("facade_plaster"), 12.0), roof])


def city_scene() -> Scene:
    """Lawn, a road, houses along it, trees."""
    road = flat_polygon(shapely.box(-200, -7, 200, 7), 0.02, material("asphalt"), 8.0)
    rng = np.random.default_rng(2)
    meshes, objects, places = [floor(), road], [GROUND, ROAD], []
    for k, x in enumerate(np.arange(-160, 161, 40)):
        for side in (-1, 1):
            meshes.append(tower(float(x), side * 26.0, 20.0, float(rng.integers(3, 12) * 3)))
            objects.append(TOWER + 2 * k + (side > 0))
            places.append((float(x) + 20.0, side * 11.0))
    return scene_of(meshes, objects, trees_at(places))


def with_line(scene: Scene, width: float = 0.2, rise: float = 0.02) -> Scene:
    """The same with a white line along y = 0 and asphalt beside it: objects `LINE` and `ROAD`."""
    line = Stripe(np.array([[-200.0, 0.0], [200.0, 0.0]]), width)
    meshes = [make(RoadPaint([line], [], [])) for make in (mesh_of, margins_of)]
    for mesh in meshes:
        mesh.positions[:, 2] += rise
    ids = np.repeat([LINE, ROAD], [len(mesh.triangles) for mesh in meshes]).astype(np.int32)
    return dataclasses.replace(
        scene,
        static=concatenate([scene.static, *meshes]),
        static_object=np.concatenate([scene.static_object, ids]),
    )


def city_traffic(worlds: int) -> DrawList:
    """Eight cars on the road of each world."""
    draw_list = DrawList.create(worlds, 50)
    for world in range(worlds):
        for actor in range(8):
            lane = 3.5 if actor % 2 else -3.5
            x = -70.0 + 18.0 * actor + 2.0 * world
            put_car(draw_list, world, 6 * actor, actor, x, lane, 0.0 if lane < 0 else np.pi)
    return draw_list


def looking(
    positions: list[tuple[float, float, float]],
    yaw: float | list[float] = 0.0,
    pitch: float | list[float] = 0.0,
    fov: float = 1.0,
    subject: int = -1,
) -> Views:
    """Cameras without roll; yaw counter-clockwise from east, pitch positive down."""
    count = len(positions)
    yaws, pitches = np.broadcast_to(yaw, count), np.broadcast_to(pitch, count)
    rotation = np.empty((count, 3, 3))
    for k in range(count):
        cy, sy, cp, sp = np.cos(yaws[k]), np.sin(yaws[k]), np.cos(pitches[k]), np.sin(pitches[k])
        rotation[k] = [[cy * cp, -sy, cy * sp], [sy * cp, cy, sy * sp], [-sp, 0, cp]]
    return Views(
        position=np.asarray(positions, np.float64),
        rotation=rotation,
        world=np.zeros(count, np.int32),
        subject=np.full(count, subject, np.int32),
        field_of_view=fov,
    )
