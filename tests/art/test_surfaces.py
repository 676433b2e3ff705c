"""Vehicles have no two surfaces that could fight for a pixel, at any level of detail."""

import numpy as np
import pytest

from art.cars.wheels import wheel_levels
from art.parts import levels_of
from art.vehicles.models import VEHICLES
from eyas.engine.mesh.flat import quads
from eyas.engine.state.mesh import Material

CLOSE = 0.01
"""Surfaces that face alike must be farther apart, or the same [m]."""

WEIGHTS = np.array([(1, 1, 1), (4, 1, 1), (1, 4, 1), (1, 1, 4), (3, 3, 1), (1, 3, 3), (3, 1, 3)])
WEIGHTS = WEIGHTS / WEIGHTS.sum(axis=1, keepdims=True)


def fights(mesh):
    """Pairs of triangles that face alike, and lie less than `CLOSE` above each other."""
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(crossed, axis=1)
    corners, normal = corners[area > 2e-5], (crossed / area[:, None])[area > 2e-5]
    below, above = np.nonzero(normal @ normal.T > 0.9985)
    below, above = below[below != above], above[below != above]
    points = np.einsum("kc,tcd->tkd", WEIGHTS, corners)[above]
    a, n = corners[below], normal[below]
    height = np.einsum("pkd,pd->pk", points - a[:, :1], n)
    inside = np.abs(height) < CLOSE
    for k in range(3):
        edge = a[:, (k + 1) % 3] - a[:, k]
        inward = np.cross(n, edge) / np.linalg.norm(edge, axis=1, keepdims=True)
        inside &= np.einsum("pkd,pd->pk", points - a[:, k : k + 1], inward) > 1e-3
    found = inside.any(axis=1)
    return [tuple(np.round(pair, 3)) for pair in points[found].mean(axis=1)]


def meshes_of(vehicle):
    yield from vehicle.body(vehicle)
    if vehicle.trailer is not None:
        shape = vehicle.trailer.shape
        yield from levels_of(lambda shell, detail: shape(shell, vehicle, detail))


@pytest.mark.parametrize("vehicle", VEHICLES, ids=lambda vehicle: vehicle.name)
def test_no_surface_lies_within_a_centimetre_of_another(vehicle):
    for level, mesh in enumerate(meshes_of(vehicle)):
        assert fights(mesh) == [], level
    for axle in vehicle.axles:
        for mesh in wheel_levels(vehicle.wheel_radius, axle.width, 0.0):
            assert fights(mesh) == []


def test_a_strip_just_above_a_panel_is_found():
    panel = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float64)
    strip = 0.5 * panel + (0.1, 0.2, 0.008)
    flat = np.zeros((2, 4, 2))
    assert fights(quads([panel, strip], flat, Material()))
    assert not fights(quads([panel, strip + np.array([0, 0, 0.004])], flat, Material()))
