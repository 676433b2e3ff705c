"""The input of the peers: Eyas's scene, cars and cameras as plain arrays."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.optics.pinhole import field_along
from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.renderer import CpuRenderer, build_renderer
from eyas.engine.sim.assets import Assets, load_assets
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.still import StillWorld
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import PartLibrary, Views
from eyas.engine.state.mesh import Mesh, Surface
from eyas.engine.targets.catalogue import KINDS
from eyas.engine.targets.rig import part_library
from eyas.maps.textures.shipped import build_textures

CHUNK = 32.0
"""Side of the squares that are skipped if not in view [m]."""


@dataclass
class Batch:
    """Triangles, three corners each, sorted by square. V corners."""

    positions: np.ndarray
    """[m], float32, shape (V, 3)."""
    normals: np.ndarray
    """float32, shape (V, 3)."""
    uvs: np.ndarray
    """Texture coordinates [tiles], float32, shape (V, 2)."""
    colours: np.ndarray
    """Tint, sRGB 0 to 1, float32, shape (V, 3)."""
    layers: np.ndarray
    """Texture, int32, shape (V,)."""
    painted: np.ndarray
    """Whether the colour of the instance applies, bool, shape (V,)."""
    first: np.ndarray
    """First corner of each square, and the end, shape (C + 1,)."""
    boxes: np.ndarray
    """Lower and upper corners of squares [m], shape (C, 6)."""


@dataclass
class City:
    """The scene and the cars at one time, and the cameras of N trackers in one world."""

    static: Batch
    """Streets, houses and trees."""
    parts: list[Batch]
    """Parts of cars."""
    slots: list[np.ndarray]
    """Poses of each part in the world, float32, shape (K, 3, 4)."""
    slot_colours: list[np.ndarray]
    """Their colours, sRGB 0 to 1, shape (K, 3)."""
    textures: np.ndarray
    """sRGB and alpha, row 0 on top, uint8, shape (layers, 256, 256, 4)."""
    views: Views
    """The cameras."""
    sun: np.ndarray
    """Unit vector."""


def load_city(count: int) -> City:
    """Return citystreet by day and the cameras of `count` trackers after a reset.

    All views show the cars of one world, so that peers need not move them. Everything has its
    finest level of detail, as `finest_renderer` draws it too.
    """
    simulation = build_simulation(SimConfig(), each_alone(count))
    simulation.reset()
    assets = load_assets(SimConfig().world, SimConfig().traffic, count)
    scene, images = assets.scene, build_textures()
    names = list(images)
    fixtures = scene.fixtures
    copies = [
        transformed(fixtures.levels[kind][0], pose)
        for kind, pose in zip(fixtures.prototype, fixtures.pose, strict=True)
    ]
    cameras = simulation.snapshot.cameras
    movers = StillWorld(assets).movers(simulation.snapshot.episodes.tick[0] * PHYSICS_STEP)
    parts = [levels[0] for levels in _library(assets).parts]
    drawn = [movers.part[0] == k for k in range(len(parts))]
    field = float(cameras.field_of_view[0])
    camera = SimConfig().camera
    views = Views(
        position=cameras.position.copy(),
        rotation=cameras.rotation.copy(),
        world=np.zeros(count, np.int32),
        subject=np.full(count, -1, np.int32),
        field_of_view=field,
        vertical_field_of_view=field_along(field, camera.height / camera.width),
    )
    return City(
        static=_batch(concatenate([scene.static, *copies]), names, CHUNK),
        parts=[_batch(mesh, names, 1e9) for mesh in parts],
        slots=[movers.pose[0][chosen].copy() for chosen in drawn],
        slot_colours=[movers.colour[0][chosen].copy() for chosen in drawn],
        textures=np.stack([images[name] for name in names]),
        views=views,
        sun=np.array(assets.lighting.sun_direction),
    )


def _library(assets: Assets) -> PartLibrary:
    kinds = np.unique(assets.traffic.motion.kind).tolist()
    return part_library(tuple(KINDS[kind] for kind in kinds))


def finest_renderer(assets: Assets) -> CpuRenderer:
    """Return a renderer that draws what the peers draw: all at the finest level of detail."""
    scene, library = assets.scene, _library(assets)
    levels = tuple(levels[:1] for levels in scene.fixtures.levels)
    scene = replace(scene, fixtures=replace(scene.fixtures, levels=levels))
    library = replace(library, parts=tuple(levels[:1] for levels in library.parts))
    geometry = build_geometry(scene, library, build_textures())
    return build_renderer(scene, geometry, assets.lighting)


def _batch(mesh: Mesh, names: list[str], side: float) -> Batch:
    corners = mesh.triangles
    middle = mesh.positions[corners].mean(axis=1)
    cell = np.floor(middle[:, :2] / side).astype(np.int64)
    key = (cell[:, 0] - cell[:, 0].min()) * 100_000 + cell[:, 1] - cell[:, 1].min()
    order = np.argsort(key, kind="stable")
    flat = corners[order].ravel()
    first = np.flatnonzero(np.diff(key[order], prepend=-1)) * 3
    material = np.repeat(mesh.materials[order], 3)
    positions = mesh.positions[flat]
    ends = np.append(first, len(flat))
    boxes = [
        np.concatenate([positions[a:b].min(axis=0), positions[a:b].max(axis=0)])
        for a, b in pairwise(ends)
    ]
    return Batch(
        positions=positions,
        normals=mesh.normals[flat],
        uvs=mesh.uvs[flat],
        colours=np.array([m.tint for m in mesh.palette], np.float32)[material],
        layers=np.array([names.index(m.texture) for m in mesh.palette], np.int32)[material],
        painted=np.array([m.surface == Surface.PAINT for m in mesh.palette])[material],
        first=ends,
        boxes=np.array(boxes, np.float32),
    )


def projection(views: Views, width: int, height: int) -> np.ndarray:
    """Return world to OpenGL clip coordinates for each view, shape (V, 4, 4)."""
    near, far = 0.3, 3000.0
    across = 1.0 / np.tan(views.field_of_view / 2)
    assert views.vertical_field_of_view is not None
    up = 1.0 / np.tan(views.vertical_field_of_view / 2)
    lens = np.array(
        [
            [across, 0, 0, 0],
            [0, up, 0, 0],
            [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)],
            [0, 0, -1, 0],
        ]
    )
    # OpenGL's camera looks along -z with x to the right; our columns are forward, left, up.
    axes = np.stack(
        [-views.rotation[:, :, 1], views.rotation[:, :, 2], -views.rotation[:, :, 0]], axis=1
    )
    look = np.zeros((len(axes), 4, 4))
    look[:, :3, :3] = axes
    look[:, :3, 3] = -np.einsum("vij,vj->vi", axes, views.position)
    look[:, 3, 3] = 1.0
    return lens @ look


def seen(boxes: np.ndarray, clip: np.ndarray) -> np.ndarray:
    """Return which boxes may be in a view, shape (C,)."""
    planes = np.stack([clip[3] + s * clip[k] for k in range(3) for s in (1, -1)])
    far = np.where(planes[:, None, :3] > 0, boxes[None, :, 3:], boxes[None, :, :3])
    inside: np.ndarray = (np.einsum("pcj,pj->pc", far, planes[:, :3]) + planes[:, 3:] > 0).all(
        axis=0
    )
    return inside


def runs(visible: np.ndarray) -> list[tuple[int, int]]:
    """Return first and last + 1 of each run of consecutive visible squares."""
    edges = np.diff(np.concatenate([[0], visible.astype(np.int8), [0]]))
    return list(
        zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True)
    )
