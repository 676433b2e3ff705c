"""No holes and no double pixels at shared edges; triangles through the camera."""

import numpy as np
import pytest

from eyas.core.jit import kernel
from eyas.core.pinhole import rays
from eyas.render.kernels.visibility.rasterise import FRONT, rasterise
from eyas.state.mesh import Mesh
from eyas.world.build.materials import material

from .small_city import looking, scene_of

SIDE = 40


@kernel
def draw(corners, a, b, c, top, depth, owner, tag, sides, textures, layer, level):
    """Python's way in."""
    rasterise(corners, a, b, c, top, depth, owner, tag, sides, textures, layer, level)


def coverage(points: np.ndarray, triangles: np.ndarray, top: int = 0, rows: int = SIDE):
    """How often each pixel is drawn if every triangle is drawn alone."""
    count = np.zeros((rows, SIDE), int)
    corners = np.column_stack([points, np.full(len(points), 0.25), np.zeros(len(points))])
    texture = np.zeros((1, 1), np.uint32)
    for a, b, c in triangles:
        depth, owner = np.zeros((rows, SIDE), np.float32), np.full((rows, SIDE), -1)
        draw(
            corners, int(a), int(b), int(c), top, depth, owner, 5, FRONT, texture, 0, -1
        )  # fmt: skip
        count += owner == 5
        np.testing.assert_array_equal(depth > 0, owner == 5)
    return count


def jittered_grid(rng, cells: int, low: float, high: float, snap: bool):
    """Points and front-facing triangles of a grid whose inner points are moved."""
    line = np.linspace(low, high, cells + 1)
    points = np.stack(np.meshgrid(line, line), axis=-1)
    step = (high - low) / cells
    points[1:-1, 1:-1] += rng.uniform(-0.35 * step, 0.35 * step, (cells - 1, cells - 1, 2))
    if snap:  # corners and edges exactly on pixel centres
        points = np.round(points * 2) / 2
    index = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    flip = rng.random(a.shape)[..., None] < 0.5
    one = np.where(flip, np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    two = np.where(flip, np.stack([a, c, d], -1), np.stack([b, c, d], -1))
    return points.reshape(-1, 2), np.concatenate([one.reshape(-1, 3), two.reshape(-1, 3)])


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("snap", [False, True])
def test_each_pixel_of_a_mesh_is_drawn_once(seed, snap):
    rng = np.random.default_rng(seed)
    points, triangles = jittered_grid(rng, 6 + 3 * seed, -7.5, SIDE + 7.5, snap)
    assert (coverage(points, triangles) == 1).all()


def test_the_border_of_a_mesh_is_drawn_by_the_top_left_rule():
    rng = np.random.default_rng(3)
    points, triangles = jittered_grid(rng, 4, 10.5, 20.5, snap=True)
    count = coverage(points, triangles)
    expected = np.zeros_like(count)
    expected[10:20, 10:20] = 1  # centres on the left and upper border belong to it
    np.testing.assert_array_equal(count, expected)


def test_a_band_draws_the_same_pixels():
    rng = np.random.default_rng(4)
    points, triangles = jittered_grid(rng, 8, 3.2, 31.7, snap=False)
    whole = coverage(points, triangles)
    np.testing.assert_array_equal(coverage(points, triangles, 11, 9), whole[11:20])


def test_back_faces_are_not_drawn():
    points = np.array([[5.0, 5.0], [30.0, 5.0], [5.0, 30.0]])
    assert coverage(points, [(0, 2, 1)]).sum() > 100
    assert coverage(points, [(0, 1, 2)]).sum() == 0


def soup(rng, count: int) -> Mesh:
    """Large triangles all around and through the origin, each twice, seen from both sides."""
    corners = rng.normal(0.0, 6.0, (count, 3, 3))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    both = np.concatenate([corners, corners[:, ::-1]])
    facing = np.concatenate([normals, -normals])
    return Mesh(
        positions=both.reshape(-1, 3).astype(np.float32),
        normals=np.repeat(facing, 3, axis=0).astype(np.float32),
        uvs=np.zeros((6 * count, 2), np.float32),
        triangles=np.arange(6 * count, dtype=np.int32).reshape(-1, 3),
        materials=np.zeros(2 * count, np.int32),
        palette=(material("plain"),),
    )


def cast(mesh: Mesh, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nearest triangle and depth along rays from the origin (Moeller and Trumbore, 1997)."""
    a, b, c = np.moveaxis(mesh.positions[mesh.triangles].astype(float), 1, 0)
    e1, e2 = b - a, c - a
    d = directions.reshape(-1, 1, 3)
    p = np.cross(d, e2)
    det = np.einsum("tj,rtj->rt", e1, p)
    u = np.einsum("tj,rtj->rt", -a, p) / det
    q = np.cross(-a, e1)
    v = (d * q).sum(-1) / det
    t = (e2 * q).sum(-1) / det
    hit = (det > 0) & (u > 0) & (v > 0) & (u + v < 1) & (t >= 0.08)
    t = np.where(hit, t, np.inf)
    return t.argmin(axis=1), t.min(axis=1)


@pytest.mark.parametrize("seed", range(4))
def test_triangles_through_the_camera_are_cut_at_the_near_plane(seed, renderer_of, drawn):
    mesh = soup(np.random.default_rng(seed), 40)
    scene = scene_of([mesh], [0])
    scene.static_object = np.arange(len(mesh.triangles), dtype=np.int32)
    views = looking([(0.0, 0.0, 0.0)], yaw=0.4, pitch=0.3, fov=1.4)
    picture = drawn(renderer_of(scene), views)
    owner, depth = cast(mesh, rays(views.rotation[0], 128, 96, 1.4))
    owner, depth = owner.reshape(96, 128), depth.reshape(96, 128)
    seen = np.isfinite(depth)
    owner[~seen] = -1
    assert np.mean(picture.object_id[0] == owner) > 0.998  # rays through edges may differ
    same = seen & (picture.object_id[0] == owner)
    np.testing.assert_allclose(picture.depth[0][same], depth[same], rtol=2e-4)
