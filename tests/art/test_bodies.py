import functools
import itertools

import numpy as np
import pytest

from art import parts
from art.cars.finishes import (
    BLACK_PAINT,
    HEAD_LAMP,
    INDICATOR_LEFT,
    INDICATOR_RIGHT,
    ROOF_GLASS,
    TAIL_LAMP,
    TRIM,
)
from art.cars.wheels import wheel_levels
from art.vehicles.models import VEHICLES
from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.state.mesh import Surface

BY_NAME = {vehicle.name: vehicle for vehicle in VEHICLES}
NAMES = [*BY_NAME]


@functools.cache
def levels_of(name):
    """The bodies; of a truck with a trailer, both."""
    vehicle = BY_NAME[name]
    bodies = vehicle.body(vehicle)
    if not vehicle.articulated:
        return bodies
    add = vehicle.trailer.shape
    trailers = parts.levels_of(lambda mesh, detail: add(mesh, vehicle, detail))
    return [concatenate(pair) for pair in zip(bodies, trailers, strict=True)]


@functools.cache
def whole(name):
    """The finest body with its wheels."""
    vehicle = BY_NAME[name]
    meshes = [levels_of(name)[0]]
    for axle in vehicle.axles:
        pose = np.eye(3, 4)
        pose[:, 3] = axle.x, 0.0, vehicle.wheel_radius
        wheels = wheel_levels(vehicle.wheel_radius, axle.width, axle.track)
        meshes.append(transformed(wheels[0], pose))
    return concatenate(meshes)


def face_normals(mesh):
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return crossed / np.linalg.norm(crossed, axis=1, keepdims=True)


def first_hits(mesh, axis, sign, rays=24):
    """For a grid of rays along an axis: how the first panel that each meets is turned to it.

    Returns the component of the panels' normals against the rays, for the rays that hit.
    """
    u, v = [k for k in range(3) if k != axis]
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    low, high = mesh.positions.min(0), mesh.positions.max(0)
    grid_u = np.linspace(low[u], high[u], rays + 2)[1:-1] + 1.3e-4
    grid_v = np.linspace(low[v], high[v], rays + 2)[1:-1] + 1.7e-4
    point = np.stack(np.meshgrid(grid_u, grid_v), axis=-1).reshape(-1, 1, 2)
    flat = corners[..., [u, v]]
    edge_a, edge_b = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = edge_a[:, 0] * edge_b[:, 1] - edge_a[:, 1] * edge_b[:, 0]
    area = np.where(np.abs(area) < 1e-9, np.nan, area)
    away = point - flat[:, 0]
    b = (away[..., 0] * edge_b[:, 1] - away[..., 1] * edge_b[:, 0]) / area
    c = (edge_a[:, 0] * away[..., 1] - edge_a[:, 1] * away[..., 0]) / area
    inside = (b >= 0) & (c >= 0) & (b + c <= 1)
    along = corners[:, 0, axis] + b * (corners[:, 1, axis] - corners[:, 0, axis])
    along = sign * (along + c * (corners[:, 2, axis] - corners[:, 0, axis]))
    reach = np.where(inside, along, -np.inf)
    hit = inside.any(axis=1)
    return (sign * face_normals(mesh)[reach.argmax(axis=1), axis])[hit]


@pytest.mark.parametrize("name", NAMES)
def test_size_is_the_catalogues_within_five_centimetres_but_for_mirrors(name):
    mesh = whole(name)
    low, high = mesh.positions.min(0), mesh.positions.max(0)
    size = np.array(BY_NAME[name].size)
    assert (high - low)[[0, 2]] == pytest.approx(size[[0, 2]], abs=0.05)
    # The width of a catalogue is that without mirrors, which reach 3.5 cm farther on either side.
    assert -0.05 <= high[1] - low[1] - size[1] <= 0.08
    assert low[2] == pytest.approx(0.0, abs=1e-6)
    assert (low + high)[:2] / 2 == pytest.approx(np.zeros(2), abs=0.03)


@pytest.mark.parametrize("name", NAMES)
def test_normals_agree_with_winding(name):
    vehicle = BY_NAME[name]
    for mesh in (*levels_of(name), *wheel_levels(vehicle.wheel_radius, 0.2, 1.5)):
        assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0, abs=1e-4)
        against = np.einsum("ti,tci->tc", face_normals(mesh), mesh.normals[mesh.triangles])
        assert against.min() > 0.5


@pytest.mark.parametrize("name", NAMES)
def test_no_hole_shows_the_inside_of_the_finest_level(name):
    mesh = whole(name)
    for axis, sign in ((2, 1), (1, 1), (1, -1), (0, 1), (0, -1)):
        turned = first_hits(mesh, axis, sign)
        assert len(turned) > 100
        assert turned.min() > -1e-3, (axis, sign)


@pytest.mark.parametrize("name", NAMES)
def test_left_and_right_look_alike_from_above(name):
    mesh = levels_of(name)[1]
    area = np.linalg.norm(np.ptp(mesh.positions, axis=0)[:2])
    assert abs(mesh.positions[:, 1].min() + mesh.positions[:, 1].max()) < 0.02 * area


@pytest.mark.parametrize("name", NAMES)
def test_paint_glass_and_lamps_are_there(name):
    surfaces = {material.surface for material in levels_of(name)[0].palette}
    assert {Surface.PAINT, Surface.GLASS, Surface.LAMP} <= surfaces


@pytest.mark.parametrize("name", NAMES)
def test_every_level_has_lamps_at_both_ends_on_both_sides(name):
    """They are what shows a far vehicle at night, where the coarsest level is drawn."""
    least = 0.008 if "bike" in name or "Scooter" in name else 0.02  # each side [m2]
    for mesh in levels_of(name):
        corners = mesh.positions[mesh.triangles].astype(np.float64)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
        for lamp, sign in ((HEAD_LAMP, 1), (TAIL_LAMP, -1)):
            shining = np.array([material == lamp for material in mesh.palette])[mesh.materials]
            facing = np.where(shining, np.maximum(sign * normals[:, 0], 0), 0)
            reach = (sign * corners[shining, :, 0]).max(initial=0.0)
            assert reach > 0.29 * BY_NAME[name].length
            for side in (1, -1):
                assert facing[side * corners[:, :, 1].mean(axis=1) > 0.01].sum() > least


@pytest.mark.parametrize("name", NAMES)
def test_levels_get_coarser(name):
    counts = [len(mesh.triangles) for mesh in levels_of(name)]
    assert counts[0] <= 1250
    assert all(fine > 1.15 * coarse for fine, coarse in itertools.pairwise(counts))


def test_roofs_tell_the_range_rover_and_the_tesla_from_the_others():
    for name in NAMES:
        palette = levels_of(name)[0].palette
        assert (BLACK_PAINT in palette) == (name == "RangeRoverSportSVRSimple")
        assert (ROOF_GLASS in palette) == (name == "TeslaModel3Simple")


@pytest.mark.parametrize("vehicle", VEHICLES, ids=lambda vehicle: vehicle.name)
def test_the_box_of_a_model_holds_every_level_of_every_variant(vehicle):
    half = np.array([vehicle.length / 2, vehicle.width / 2, vehicle.height])
    for body in (vehicle.body, *vehicle.variants):
        for mesh in body(vehicle):
            assert (np.abs(mesh.positions) <= half + 0.04).all()
            assert mesh.uvs.min() >= 0.0
            assert mesh.uvs.max() <= 1.0


@pytest.mark.parametrize("vehicle", VEHICLES, ids=lambda vehicle: vehicle.name)
def test_variants_differ_in_detail_and_have_the_size_and_roof_of_their_model(vehicle):
    first = vehicle.body(vehicle)[0]
    seen = [first]
    for variant in vehicle.variants:
        mesh = variant(vehicle)[0]
        span = np.ptp(mesh.positions, axis=0), np.ptp(first.positions, axis=0)
        assert span[0] == pytest.approx(span[1], abs=0.03)
        for material in (BLACK_PAINT, ROOF_GLASS):
            assert (material in mesh.palette) == (material in first.palette)
        looks = [(other.palette, other.materials.tolist()) for other in seen]
        assert (mesh.palette, mesh.materials.tolist()) not in looks
        seen.append(mesh)


def corners_of(mesh, material):
    return mesh.positions[mesh.triangles[mesh.materials == mesh.palette.index(material)]]


def test_a_motorbike_has_an_indicator_on_either_side_of_its_tail():
    mesh = levels_of("MotorbikeSimple")[0]
    left, right = (corners_of(mesh, lamp) for lamp in (INDICATOR_LEFT, INDICATOR_RIGHT))
    assert left[..., 1].min() > 0.0 > right[..., 1].max()
    assert left[..., 0].max() < -1.0


def test_the_dark_bumper_of_a_van_is_no_wall():
    mesh = levels_of("MercedesBenzSprinterSimple")[0]
    dark = mesh.positions[mesh.triangles[mesh.materials == mesh.palette.index(TRIM)]]
    tail = dark[np.all(dark[..., 0] < mesh.positions[:, 0].min() + 0.04, axis=1)]
    assert 0.3 < np.ptp(tail[..., 2]) < 0.5


def test_silhouettes_differ():
    seen = set()
    for name in NAMES:
        mesh = whole(name)
        bins = np.clip((mesh.positions[:, 0] + 7.2) / 0.6, 0, 23).astype(int)
        line = tuple(
            round(float(mesh.positions[bins == k, 2].max(initial=0)), 1) for k in range(24)
        )
        assert line not in seen
        seen.add(line)
