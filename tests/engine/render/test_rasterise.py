"""No holes and no double pixels at shared edges; triangles through the camera."""

import math

import numpy as np
import pytest

from eyas.engine.core.optics.pinhole import rays
from eyas.engine.render.kernels.scalars import i4
from eyas.engine.render.kernels.visibility.fill import SPAN_ROWS, fill
from eyas.engine.render.kernels.visibility.holes import no_holes
from eyas.engine.render.kernels.visibility.meshes import ASIDE
from eyas.engine.render.kernels.visibility.triangles import TRIANGLE_ROWS, load_corners, set_up
from eyas.engine.state.mesh import Mesh
from eyas.engine.world.build.materials import material
from eyas.lanes import kernel
from eyas.lanes.vector import any_of, lane_numbers, splat

from ...kit.small_city import looking, scene_of

SIDE = 40


@kernel
def draw(corners, top, width, key, tag, both, triangle, span, texture):
    """Python's way in."""
    bottom = top + key.shape[0]
    seen = set_up(
        load_corners(corners), lane_numbers() < i4(1), splat(both), float(top), float(bottom),
        float(width), ASIDE, triangle,
    )  # fmt: skip
    if any_of(seen):
        fill(triangle, 0, top, width, key, tag, no_holes(texture), span)


def filled(corners: np.ndarray, top: int = 0, rows: int = SIDE, both: bool = False) -> np.ndarray:
    """Draw one triangle; corners are columns, rows and 1/distances, shape (3, 3)."""
    key = np.zeros((rows, SIDE + 8), np.int64)  # 40 columns are shown
    eight, triangle = np.zeros((9, 8)), np.zeros((TRIANGLE_ROWS, 8))
    span = np.zeros((SPAN_ROWS, 8), np.int32)
    eight[:, 0] = np.ravel(corners)
    draw(eight, top, SIDE, key, 5, both, triangle, span, np.zeros((1, 1), np.uint32))
    assert not key[:, SIDE:].any()
    return key[:, :SIDE]


def inverses(key: np.ndarray) -> np.ndarray:
    return (key >> 32).astype(np.int32).view(np.float32)


def drawn_pixels(corners: np.ndarray, top: int = 0, rows: int = SIDE, both: bool = False):
    """Which pixels one triangle covers, from its corners [pixels], shape (3, 2)."""
    key = filled(np.column_stack([corners, np.full(3, 0.25)]), top, rows, both)
    covered = key != 0
    np.testing.assert_array_equal(inverses(key), np.where(covered, np.float32(0.25), 0))
    np.testing.assert_array_equal(key & 0xFFFFFFFF, np.where(covered, 5, 0))
    return covered


def coverage(points: np.ndarray, triangles: np.ndarray, top: int = 0, rows: int = SIDE):
    """How often each pixel is drawn if every triangle is drawn alone."""
    count = np.zeros((rows, SIDE), int)
    for triangle in triangles:
        count += drawn_pixels(points[list(triangle)], top, rows)
    return count


def covered_by_integers(corners: np.ndarray) -> np.ndarray:
    """What `drawn_pixels` must be: edge functions of Python's whole numbers, top-left rule."""
    points = [(math.floor(x * 16 + 0.5), math.floor(y * 16 + 0.5)) for x, y in corners.tolist()]
    (ax, ay), (bx, by), (cx, cy) = points
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    covered = np.ones((SIDE, SIDE), np.bool_)
    if area == 0:
        return ~covered
    if area < 0:
        points.reverse()
    for (x0, y0), (x1, y1) in zip(points, points[1:] + points[:1], strict=True):
        dx, dy = x1 - x0, y1 - y0
        belongs = dy < 0 or (dy == 0 and dx > 0)  # left, or top
        for row, column in np.ndindex(SIDE, SIDE):
            edge = dx * (16 * row + 8 - y0) - dy * (16 * column + 8 - x0)
            covered[row, column] &= edge > 0 or (edge == 0 and belongs)
    return covered


def random_corners(rng: np.random.Generator) -> np.ndarray:
    """Triangles of all kinds: large, slivers, with corners on centres of pixels, far outside."""
    corners = rng.uniform(-12.0, SIDE + 12.0, (3, 2))
    kind = rng.integers(6)
    if kind == 1:
        corners = np.round(corners - 0.5) + 0.5
    if kind == 2:
        corners = np.round(corners * 4) / 4
    if kind == 3:  # a sliver
        corners[2] = corners[0] + rng.uniform(0, 1) * (corners[1] - corners[0])
        corners[2] += rng.normal(0.0, 0.2, 2)
    if kind == 4:
        corners[1] += 5e3 * rng.normal(size=2)
    if kind == 5:  # smaller than a pixel or two
        corners[1:] = corners[0] + rng.normal(0.0, 0.7, (2, 2))
    return corners


@pytest.mark.parametrize("seed", range(4))
def test_the_same_pixels_are_covered_as_by_edges_in_whole_numbers(seed):
    rng = np.random.default_rng(seed)
    for _ in range(60):
        corners = random_corners(rng)
        expected = covered_by_integers(corners)
        np.testing.assert_array_equal(drawn_pixels(corners, both=True), expected)


def test_triangles_that_reach_millions_of_pixels_outside_share_their_edges():
    rng = np.random.default_rng(8)
    for _ in range(100):
        inside = rng.uniform(0.0, SIDE, 2)
        ring = np.sort(rng.uniform(0.0, 2 * math.pi, 7))[::-1]  # clockwise where rows go down
        if np.max(np.diff(ring, append=ring[0] - 2 * math.pi) * -1) > 2.5:
            continue
        far = 10.0 ** rng.uniform(3.0, 8.0, (7, 1))
        points = np.concatenate(
            [[inside], inside + far * np.column_stack([np.cos(ring), np.sin(ring)])]
        )
        fan = [(0, 1 + k, 1 + (k + 1) % 7) for k in range(7)]
        assert (coverage(points, fan) == 1).all()


def test_depth_is_that_of_the_corners_before_they_are_rounded():
    corners = np.array([(3.03, 2.03), (4.02, 33.04), (37.03, 8.01)])
    slope = np.array([0.013, -0.007])
    key = filled(np.column_stack([corners, 0.5 + corners @ slope]))
    row, column = np.nonzero(key)
    expected = 0.5 + np.column_stack([column + 0.5, row + 0.5]) @ slope
    assert len(row) > 300
    np.testing.assert_allclose(inverses(key)[row, column], expected, rtol=2e-7)


def test_a_sliver_is_nowhere_much_nearer_than_its_corners():
    rng = np.random.default_rng(2)
    seen = 0
    for _ in range(300):
        ends = rng.uniform(2.0, SIDE - 2.0, (2, 2))
        third = ends.mean(axis=0) + rng.normal(0.0, 0.02, 2)
        inverse = rng.uniform(0.1, 0.2, 3)
        key = filled(np.column_stack([[*ends, third], inverse]), both=True)
        found = inverses(key)[key != 0]
        seen += len(found)
        assert (found <= inverse.max() * (1 + ASIDE) * (1 + 1e-6)).all()
        assert (found >= inverse.min() * (1 - ASIDE) * (1 - 1e-6)).all()
    assert seen > 50


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
