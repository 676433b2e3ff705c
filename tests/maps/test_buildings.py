"""City blocks filled with buildings, and the meshes of single ones."""

import numpy as np
import pytest
import shapely

from eyas.engine.state.mesh import Surface
from eyas.engine.world.build.materials import FACADES, TEXTURES, material
from eyas.maps.buildings.facades import mesh_of, prisms_of
from eyas.maps.buildings.lots import turned
from eyas.maps.buildings.parts import PARAPET
from eyas.maps.buildings.placing import SETBACK, place_buildings
from eyas.maps.plan.plan import BuildingPart

COUNT = 83


def city_blocks():
    """Nine turned blocks of about 150 by 140 m, as in the street city."""
    return [
        turned(shapely.box(x, y, x + 150 + 0.05 * x, y + 140 + 0.03 * y), 0.7)
        for x in (-260, -80, 100)
        for y in (-240, -75, 90)
    ]


@pytest.fixture(scope="module")
def blocks():
    return city_blocks()


@pytest.fixture(scope="module")
def park():
    return turned(shapely.Point(-20, 0).buffer(30), 0.7)


@pytest.fixture(scope="module")
def buildings(blocks, park):
    return place_buildings(blocks, COUNT, np.random.default_rng(0), park)


def a_building(**changes):
    values = {
        "outline": shapely.Polygon([(0, 0), (30, 0), (30, 18), (0, 18)]),
        "bottom": 0.0,
        "height": 24.0,
        "facade": "facade_brick",
        "tint": (1.0, 1.0, 1.0),
        "roof": "flat",
        "cover": material("bitumen"),
    }
    return BuildingPart(**(values | changes))


def footprint_area(building):
    return shapely.Polygon(building.footprint).area


def test_about_as_many_buildings_as_asked_for_cover_the_ground_of_the_original(buildings):
    ground = sum(footprint_area(b) for b in buildings if b.bottom < 0)
    assert abs(len(buildings) - COUNT) <= 4
    assert 80_000 < ground < 108_000


def test_footprints_are_spread_as_in_the_original(buildings):
    q25, median, q75 = np.quantile([footprint_area(b) for b in buildings], [0.25, 0.5, 0.75])
    assert 290 < q25 < 560
    assert 650 < median < 1150
    assert 1300 < q75 < 2400


def test_heights_are_spread_as_in_the_original(buildings):
    tops = np.array([b.bottom + b.height for b in buildings])
    q25, median, q75 = np.quantile(tops, [0.25, 0.5, 0.75])
    assert 5 < tops.min() < 8
    assert 9 < q25 < 16
    assert 24 < median < 36
    assert 48 < q75 < 66
    assert 190 < tops.max() < 235
    assert 40 < tops.mean() < 52


def test_buildings_keep_off_the_kerb_and_out_of_the_park(buildings, blocks, park):
    kerbs = shapely.union_all([block.exterior for block in blocks])
    inside = shapely.union_all(blocks)
    for building in buildings:
        shape = shapely.Polygon(building.footprint)
        assert inside.contains(shape)
        assert shape.distance(kerbs) >= SETBACK - 1e-6
        assert shape.intersection(park).area < 1e-6


def test_no_two_buildings_share_space(buildings):
    prisms = [(shapely.Polygon(p), low, high) for b in buildings for p, low, high in prisms_of(b)]
    for i, (shape, low, high) in enumerate(prisms):
        for other, other_low, other_high in prisms[:i]:
            if min(high - PARAPET, other_high - PARAPET) > max(low, other_low) + 0.01:
                assert shape.intersection(other).area < 1e-6


def test_towers_stand_on_the_roof_of_another_building(buildings):
    grounded = [b for b in buildings if b.bottom < 0]
    towers = [b for b in buildings if b.bottom > 0]
    assert len(towers) > 10
    for tower in towers:
        shape = shapely.Polygon(tower.footprint)
        below = [b for b in grounded if shapely.Polygon(b.footprint).contains(shape)]
        assert len(below) == 1
        assert below[0].bottom + below[0].height == pytest.approx(tower.bottom)
        assert below[0].roof == "flat"


def test_walls_are_whole_storeys_and_roofs_and_facades_are_mixed(buildings):
    assert all(b.height % 3 == 0 for b in buildings)
    assert {b.facade for b in buildings} == set(FACADES)
    assert 0.03 < np.mean([b.roof == "pyramid" for b in buildings]) < 0.25
    low = [b for b in buildings if b.bottom + b.height < 20]
    assert np.mean([b.cover.texture != "bitumen" for b in low]) > 0.7


def test_small_things_are_walked_round():
    block = shapely.box(0, 0, 150, 140)
    columns = shapely.union_all([shapely.Point(x, 70).buffer(3) for x in range(10, 150, 20)])
    placed = place_buildings([block], 8, np.random.default_rng(1), columns)
    assert len(placed) >= 7
    assert all(shapely.Polygon(b.footprint).intersection(columns).area < 1e-6 for b in placed)


def test_the_same_seed_gives_the_same_city_and_another_one_another(blocks, park, buildings):
    again = place_buildings(blocks, COUNT, np.random.default_rng(0), park)
    other = place_buildings(blocks, COUNT, np.random.default_rng(1), park)
    assert [b.footprint.tobytes() for b in again] == [b.footprint.tobytes() for b in buildings]
    assert [b.footprint.tobytes() for b in other] != [b.footprint.tobytes() for b in buildings]


def test_no_blocks_give_no_buildings():
    assert place_buildings([], 10, np.random.default_rng(0), shapely.Polygon()) == []


@pytest.mark.parametrize("roof", ["flat", "pyramid"])
def test_triangles_face_outwards(roof):
    mesh = mesh_of(a_building(roof=roof))
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal = mesh.normals[mesh.triangles[:, 0]]
    assert (np.einsum("ti,ti->t", face, normal) > 0).all()


@pytest.mark.parametrize(("roof", "least", "most"), [("flat", 1.0, 1.02), ("pyramid", 1.02, 1.06)])
def test_a_mesh_encloses_the_volume_of_its_building(roof, least, most):
    # Divergence theorem: the flow of (x, y, z) / 3 out of the surface; the missing floor is at
    # z = 0, where nothing flows. The house is too small for anything to stand on its roof.
    outline = shapely.Polygon([(0, 0), (10, 0), (10, 9), (0, 9)])
    mesh = mesh_of(a_building(outline=outline, roof=roof))
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    volume = np.einsum("ti,ti->", face, corners.mean(axis=1)) / 3
    assert least < volume / (10 * 9 * 24) < most


def test_windows_meet_corners_in_whole_bays_and_storeys():
    mesh = mesh_of(a_building())
    facade = [m.surface == Surface.FACADE for m in mesh.palette]
    used = mesh.triangles[np.array(facade)[mesh.materials]]
    quarter = mesh.uvs[used.ravel()] * 4
    assert np.abs(quarter - np.round(quarter)).max() < 1e-4


def test_a_building_always_looks_the_same():
    first, second = mesh_of(a_building()), mesh_of(a_building())
    assert first.positions.tobytes() == second.positions.tobytes()


def test_materials_are_known_and_solids_cover_the_parapet():
    building = a_building()
    assert {m.texture for m in mesh_of(building).palette} <= set(TEXTURES)
    ((_, bottom, top),) = prisms_of(building)
    assert (bottom, top) == (0.0, 24.0 + PARAPET)


def test_a_high_building_has_a_base_a_shaft_and_a_top_and_keeps_its_storeys():
    mesh = mesh_of(a_building(bottom=-0.1, height=60.0))
    looks = {m for m in mesh.palette if m.surface == Surface.FACADE}
    assert len({m.texture for m in looks}) == 3  # street level, shaft and base, top
    assert len({m.tint for m in looks if m.texture == "facade_brick"}) == 2
    walls = np.array([m.surface == Surface.FACADE for m in mesh.palette])[mesh.materials]
    heights = mesh.positions[mesh.triangles[walls].ravel(), 2] + 0.1
    assert np.abs(heights / 3 - np.round(heights / 3)).max() < 1e-4
    quarter = mesh.uvs[mesh.triangles[walls].ravel()] * 4
    assert np.abs(quarter - np.round(quarter)).max() < 1e-4


def test_most_roofs_are_terracotta_but_no_two_alike(buildings):
    covers = [b.cover for b in buildings]
    kinds = [material.texture for material in covers]
    assert 0.5 < np.mean([kind in ("roof_terrace", "roof_tiles") for kind in kinds]) < 0.9
    assert {"bitumen", "roof_gravel", "roof_membrane"} < set(kinds)
    assert len(set(covers)) > 0.9 * len(covers)
    assert len({b.tint for b in buildings}) > 0.9 * len(buildings)


def test_a_courtyard_has_walls_and_a_parapet_and_is_not_solid():
    yard = shapely.box(0, 0, 40, 30).difference(shapely.box(12, 10, 28, 20))
    building = a_building(outline=yard)
    mesh = mesh_of(building)
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    volume = np.einsum("ti,ti->", face, corners.mean(axis=1)) / 3
    assert volume == pytest.approx(yard.area * 24, rel=0.02)
    solid = shapely.union_all([shapely.Polygon(outline) for outline, _, _ in prisms_of(building)])
    assert solid.symmetric_difference(yard).area < 1e-6


@pytest.mark.parametrize("height", [7.0, 8.2, 10.9])
def test_storeys_of_any_height_are_whole(height):
    mesh = mesh_of(a_building(bottom=-0.1, height=height))
    walls = np.array([m.surface == Surface.FACADE for m in mesh.palette])[mesh.materials]
    used = mesh.triangles[walls].ravel()
    storey = height / round(height / 3)
    stories = (mesh.positions[used, 2] + 0.1) / storey
    assert np.abs(stories - np.round(stories)).max() < 1e-4
    rows = mesh.uvs[used, 1] * 4
    assert np.abs(rows - np.round(rows)).max() < 1e-4
