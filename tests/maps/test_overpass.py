"""The elevated road: its course, its walls, its pillars."""

import numpy as np
import pytest
import shapely

from eyas.engine.mesh.assembly import concatenate
from eyas.maps.roads.overpass import (
    DECK_WIDTH,
    carriageway_mesh,
    deck_area,
    deck_prisms,
    path,
    pillar_mesh,
    pillars,
    sides_mesh,
)

FLOOR = -0.1


@pytest.fixture(scope="module")
def middle():
    profile = ((0.0, 0.0), (0.5, 20.0), (1.0, 20.0))
    return path([[0, 0], [300, 0], [300, 300]], [60.0], profile)


def test_a_path_turns_in_an_arc_of_the_asked_radius_and_keeps_its_ends(middle):
    assert np.allclose(middle[0], [0, 0, 0])
    assert np.allclose(middle[-1], [300, 300, 20])
    curve = middle[(middle[:, 0] > 245) & (middle[:, 1] < 55), :2]
    assert np.linalg.norm(curve - [240, 60], axis=1) == pytest.approx(60.0, abs=0.1)


def test_a_path_never_dips(middle):
    assert np.all(np.diff(middle[:, 2]) >= 0)
    assert middle[:, 2].max() == 20.0


def test_the_deck_is_closed_round_its_section_and_has_walls_two_metres_high(middle):
    flat = middle[:30] * [1, 1, 0] + [0, 0, 30]
    mesh = concatenate([carriageway_mesh(flat), sides_mesh(flat, FLOOR)])
    assert mesh.positions[:, 2].max() == pytest.approx(32.0)
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    # Lines lie on the surface; all else goes once around the section, so its faces cancel.
    body = np.abs(corners[:, :, 2].mean(1) - 30.035) > 1e-3
    assert np.abs(normal[body].sum(0)).max() < 1e-2
    surface = (np.abs(corners[:, :, 2] - 30.0).max(1) < 1e-4) & (normal[:, 2] > 0)
    length = np.linalg.norm(flat[-1] - flat[0])
    assert normal[surface, 2].sum() == pytest.approx(DECK_WIDTH * length, rel=0.01)


def test_a_low_ramp_is_solid_down_to_the_floor(middle):
    mesh = sides_mesh(middle, FLOOR)
    assert mesh.positions[:, 2].min() == pytest.approx(-1.5, abs=0.2)
    near_start = [bottom for outline, bottom, _ in deck_prisms(middle, FLOOR)
                  if outline[:, 0].max() < 60]  # fmt: skip
    assert near_start
    assert set(near_start) == {FLOOR}


def test_solids_cover_the_deck_and_leave_the_air_below_free(middle):
    prisms = deck_prisms(middle, FLOOR)
    outlines = [shapely.Polygon(outline) for outline, _, _ in prisms]
    assert all(shapely.is_ccw(outline.exterior) for outline in outlines)
    assert shapely.union_all(outlines).area == pytest.approx(deck_area(middle).area, rel=0.01)
    assert prisms[-1][1] == pytest.approx(18.5)


def test_pillars_stand_under_the_deck_and_not_on_roads(middle):
    road = shapely.box(180, -20, 194, 20)
    made = pillars(middle, 5, FLOOR, road)
    assert len(made) == 5
    for pillar in made:
        assert not pillar.base.intersects(road)
        assert deck_area(middle).contains(pillar.base)
        low, high = np.ptp(pillar.columns, axis=0), pillar.top
        assert np.hypot(*low) == pytest.approx(5.0)
        assert pillar_mesh(pillar, FLOOR).positions[:, 2].max() < high + 0.3
