"""What a map nine times as large costs: citystreet three by three, with 747 buildings.

    python bench/large_city.py        # packing, baking and memory; time of pictures, CPU

Each copy keeps what stands on its own floor. The scene is not cached, its shadows are baked anew.
"""

import dataclasses
import itertools
import tempfile
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.render.bake.ambient import bake_ambient
from eyas.engine.render.bake.land import no_land
from eyas.engine.render.bake.shadows import bake_shadows
from eyas.engine.render.bake.tracks import TrackMap
from eyas.engine.render.kernels.visibility.passes import SMALLEST_DETAIL
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.pack.light import Baked, build_light
from eyas.engine.render.renderer import CpuRenderer
from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.draw import DrawList, DrawStage, PartLibrary, Picture, Views
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.scene import Fixtures, Lamps, ObjectClass, Scene
from eyas.engine.world.maps import MAPS
from eyas.maps.textures.shipped import build_textures

__all__ = ["horizon_views", "large_city", "street_views"]

SIDE = 3
"""Copies along a side."""

_VIEWS, _SIZE = 64, 84
_HORIZON_FIELD = 1.2
"""Field of view from the horizon [rad]."""


def large_city(side: int = SIDE) -> Scene:
    """Return citystreet `side` by `side` times, one beside the other."""
    city = load_scene("citystreet")
    width = np.array(city.size)
    inside = np.abs(city.static.positions[:, :2]) <= 0.5 * width + 1e-3
    kept = inside.all(axis=1)[city.static.triangles].all(axis=1)
    objects = len(city.object_class)
    steps = [k - (side - 1) / 2 for k in range(side)]
    moves = [np.append(width * place, 0.0) for place in itertools.product(steps, steps)]
    network, fixtures, lamps = city.network, city.fixtures, city.lamps
    lanes = len(network.lane_points)
    count = len(moves)
    return dataclasses.replace(
        city,
        name="large city",
        size=(side * city.size[0], side * city.size[1]),
        static=concatenate([_moved(city.static, kept, move) for move in moves]),
        static_object=np.concatenate(
            [city.static_object[kept] + k * objects for k in range(count)]
        ).astype(np.int32),
        object_class=np.tile(city.object_class, count),
        fixtures=Fixtures(
            fixtures.levels,
            np.tile(fixtures.prototype, count),
            np.concatenate([_posed(fixtures.pose, move) for move in moves]),
            np.concatenate([fixtures.object_id + k * objects for k in range(count)]),
            fixtures.names,
        ),
        network=dataclasses.replace(
            network,
            lane_points=np.concatenate([network.lane_points + move[:2] for move in moves]),
            lane_first=np.append(
                np.concatenate([network.lane_first[:-1] + k * lanes for k in range(count)]),
                count * lanes,
            ).astype(np.int32),
        ),
        lamps=Lamps(
            np.concatenate([lamps.position + np.float32(move) for move in moves]),
            np.tile(lamps.axis, (count, 1)),
        ),
    )


def _moved(mesh: Mesh, kept: NDArray[np.bool_], move: NDArray[np.float64]) -> Mesh:
    return dataclasses.replace(
        mesh,
        positions=mesh.positions + move.astype(np.float32),
        triangles=mesh.triangles[kept],
        materials=mesh.materials[kept],
    )


def _posed(pose: NDArray[np.float32], move: NDArray[np.float64]) -> NDArray[np.float32]:
    moved = pose.copy()
    moved[:, :, 3] += move.astype(np.float32)
    return moved


def _looking(
    position: NDArray[np.float64], yaw: NDArray[np.float64], pitch: float, field: float
) -> Views:
    zero = np.zeros(len(yaw))
    level = np.stack([np.cos(yaw), np.sin(yaw), zero], axis=1)
    forward = np.cos(pitch) * level - np.sin(pitch) * np.array([0.0, 0.0, 1.0])
    left = np.cross([0.0, 0.0, 1.0], level)
    return Views(
        position=position,
        rotation=np.stack([forward, left, np.cross(forward, left)], axis=2),
        world=np.zeros(len(yaw), np.int32),
        subject=np.full(len(yaw), -1, np.int32),
        field_of_view=field,
    )


def street_views(scene: Scene, count: int = _VIEWS, pitch: float = 1.37) -> Views:
    """Return views from 22 m over the roads; by default as steep as those of an episode."""
    rng = np.random.default_rng(3)
    points = scene.network.lane_points[rng.integers(len(scene.network.lane_points), size=count)]
    position = np.column_stack([points, np.full(count, 22.0)])
    return _looking(position, rng.uniform(0, 2 * np.pi, count), pitch, 0.785)


def horizon_views(scene: Scene, count: int = _VIEWS) -> Views:
    """Return views from a ring outside the city, which show all of it."""
    pitch, field = 0.3, _HORIZON_FIELD
    points = scene.network.lane_points
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    away = np.linalg.norm(points - centre, axis=1).max() / np.sin(0.5 * field)
    turn = np.arange(count) * (2 * np.pi / count)
    out = away * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    position = np.column_stack([centre + out, np.full(count, away * np.tan(pitch))])
    return _looking(position, turn + np.pi, pitch, field)


def _print_facing(scene: Scene) -> None:
    """Print which static triangles face a view from the horizon and are drawn, by class."""
    place = horizon_views(scene).position[0]
    corners = scene.static.positions[scene.static.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    ahead = place - corners.mean(axis=1)
    focal = 0.5 * _SIZE / np.tan(0.5 * _HORIZON_FIELD)
    size = np.sqrt(0.5 * np.linalg.norm(normal, axis=1))
    pixels = size * focal / np.linalg.norm(ahead, axis=1)
    kind = scene.object_class[scene.static_object]
    details = np.isin(kind, (ObjectClass.MARKING, ObjectClass.BUILDING))
    drawn = ((normal * ahead).sum(axis=1) > 0.0) & (~details | (pixels >= SMALLEST_DETAIL))
    counts = {one.name.lower(): int((drawn & (kind == one)).sum()) for one in ObjectClass}
    listed = ", ".join(f"{name} {count:,}" for name, count in counts.items() if count)
    print(f"  triangles that face the horizon: {listed}")


def _measured(name: str, renderer: CpuRenderer, views: Views) -> None:
    """Print the CPU time of a picture, up to the end of each stage."""
    count = len(views.position)
    picture, nothing = Picture.create(count, _SIZE, _SIZE), DrawList.create(1, 1)
    line = []
    for stage in (DrawStage.CULLING, DrawStage.VERTICES, DrawStage.RASTERISING, DrawStage.SHADING):
        times = []
        for _ in range(4):
            start = time.process_time()
            renderer.draw(views, nothing, picture, until=stage)
            times.append(time.process_time() - start)
        line.append(f"{stage.name.lower()} {1e6 * min(times[1:]) / count:,.0f}")
    print(f"{name}: until the end of {', '.join(line)} µs")


def _report(name: str, scene: Scene) -> None:
    images, start = build_textures(), time.process_time()
    geometry = build_geometry(scene, PartLibrary(()), images)
    packed = time.process_time()
    lighting = MAPS.get("citystreet").light("day")
    with tempfile.TemporaryDirectory() as folder:
        shadows = bake_shadows(geometry, lighting.sun_direction, scene.terrain.floor, Path(folder))
        baked = time.process_time()
        ambient = bake_ambient(scene, Path(folder))
        opened = time.process_time()
        size = sum(a.nbytes for a in geometry if isinstance(a, np.ndarray)) / 2**20
        print(f"{name}: {len(scene.static.triangles):,} static triangles, "
              f"{len(scene.fixtures.pose):,} fixtures")  # fmt: skip
        _print_facing(scene)
        print(f"  packed in {packed - start:.1f} s CPU, {size:.0f} MiB")
        held = (shadows.heights.nbytes + shadows.tile.nbytes) / 2**20
        print(f"  shadows: {held:.1f} MiB, texels of {shadows.texel:.3f} m")
        print(f"  baked in {baked - packed:.1f} s CPU")
        print(f"  ambient: {ambient.openness.nbytes / 2**20:.1f} MiB in {opened - baked:.1f} s CPU")
        maps = Baked(shadows, ambient, no_land(), TrackMap.empty())
        light = build_light(scene, lighting, maps, geometry)
        renderer = CpuRenderer(lambda: (geometry, light))
        _measured("  street, 84x84", renderer, street_views(scene))
        _measured("  street, pitch 0.3", renderer, street_views(scene, pitch=0.3))
        _measured("  horizon", renderer, horizon_views(scene))


def main() -> None:
    """Measure the city, and the large one."""
    _report("citystreet", load_scene("citystreet"))
    _report("3 x 3", large_city())


if __name__ == "__main__":
    main()
