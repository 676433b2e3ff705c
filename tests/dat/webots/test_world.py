"""Worlds and PROTOs for Webots, read back by a grammar written from its reference.

Webots itself cannot be had where these tests run.
"""

import json
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from eyas.dat.webots.vrml import Node, world
from eyas.dat.webots.world import VrmlShapes, scene_nodes, sky_nodes
from eyas.engine.exports.resting import resting_mesh
from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.state.scene import Fixtures, Lamps, ObjectClass, Scene
from eyas.engine.state.terrain import Terrain
from eyas.engine.targets.catalogue import MODELS, model_index
from eyas.engine.world.maps import MAPS
from eyas.engine.world.weather import CLEAR_DAY, FOG
from eyas.maps.formats.meshes import parts_of

from .conftest import MAP, WORLD
from .grammar import Reader

FLOOR = -0.1


def square(x: float, z: float, material: int = 0) -> Mesh:
    """A horizontal square of 2 m at a place, and a triangle without area."""
    corners = np.array([[x, 0, z], [x + 2, 0, z], [x + 2, 2, z], [x, 2, z]], np.float32)
    return Mesh(
        positions=corners,
        normals=np.tile(np.float32([0, 0, 1]), (4, 1)),
        uvs=corners[:, :2].copy(),
        triangles=np.array([[0, 1, 2], [0, 2, 3], [0, 0, 2]], np.int32),
        materials=np.full(3, material, np.int32),
        palette=(Material(), Material("brick", (0.5, 0.4, 0.3))),
    )


@pytest.fixture
def scene() -> Scene:
    """A hilly lawn, two houses, and three trees, each turned about another axis, one larger."""
    pose = np.tile(np.eye(3, 4, dtype=np.float32), (3, 1, 1))
    pose[:, :, 3] = [[0, 10, 0], [5, 10, 0], [9, 10, 0]]
    pose[1, :, :3] = [[-1, 0, 0], [0, 1, 0], [0, 0, -1]]  # half a turn
    pose[2, :, :3] = [[0, 0, 2], [2, 0, 0], [0, 2, 0]]
    meshes = [square(0, 0), square(20, 5, 1), square(30, 6, 1)]
    whole = concatenate(meshes)
    kinds = [ObjectClass.GROUND, ObjectClass.BUILDING, ObjectClass.BUILDING, ObjectClass.TREE]
    house = np.array([[20, 0], [22, 0], [22, 2], [21, 1], [20, 2]], float)
    empty = Scene.empty()
    return replace(
        empty,
        name="small",
        terrain=Terrain(FLOOR, np.float32([[0, 1, 2], [3, 4, 5]]), -6.0, -2.0, 4.0),
        static=whole,
        static_object=np.repeat([0, 1, 2], 3).astype(np.int32),
        object_class=np.array(kinds, np.int32),
        fixtures=Fixtures(
            levels=((square(0, 3),),),
            prototype=np.zeros(3, np.int32),
            pose=pose,
            object_id=np.full(3, 3, np.int32),
            names=("an oak",),
        ),
        colliders=replace(
            empty.colliders,
            prism_points=house,
            prism_first=np.array([0, 5], np.int32),
            prism_bottom=np.array([0.0]),
            prism_top=np.array([5.0]),
            prism_object=np.array([1], np.int32),
            cylinder_centre=np.array([[5.0, 10.0]]),
            cylinder_radius=np.array([0.5]),
            cylinder_bottom=np.array([1.0]),
            cylinder_top=np.array([4.0]),
            cylinder_object=np.array([3], np.int32),
        ),
        lamps=Lamps(np.float32([[1, 2, 8]]), np.float32([[0.6, 0, -0.8]])),
    )


def read(scene, light=CLEAR_DAY, *, shining=True):
    """The nodes of a scene's world, by their names."""
    nodes = sky_nodes("small", light, "of the town")
    nodes += scene_nodes(scene, VrmlShapes("textures"), 1, shining=shining)
    return Reader(world([], [], nodes)).world()[0]


def named(nodes, name):
    return next(node for node in nodes if node.name == name)


def turned(rotation):
    """The matrix of an axis and an angle (Rodrigues)."""
    *axis, angle = rotation
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def corners(node, place=None):
    """Corners of all triangles below a node with their colours, in the frame of the world."""
    place = np.eye(4) if place is None else place
    if node.kind == "Shape":
        geometry = node["geometry"]
        points = geometry["coord"]["point"][geometry["coordIndex"].reshape(-1, 4)[:, :3]]
        look = node["appearance"]
        colour = look.get("baseColor", (1, 1, 1))
        return [(points @ place[:3, :3].T + place[:3, 3], colour)]
    here = np.eye(4)
    if node.kind in ("Solid", "Transform", "Pose"):
        scale = np.array(node.get("scale", (1, 1, 1)))
        here[:3, :3] = turned(node.get("rotation", (0, 0, 1, 0))) * scale
        here[:3, 3] = node.get("translation", (0, 0, 0))
    found = [corners(child, place @ here) for child in node.get("children") or []]
    return [each for several in found for each in several]


def together(found):
    """Corners as a set that does not depend on the order of triangles."""
    points = np.concatenate([points for points, _ in found]).reshape(-1, 9)
    return points[np.lexsort(np.rint(points.T * 100))]


def drawn(mesh):
    return mesh.positions[mesh.triangles].astype(float)


def test_every_shape_is_in_its_place_with_its_size_and_colour(scene):
    nodes = read(scene)
    houses = [node for node in nodes if node.name.startswith("building_")]
    assert [house["name"] for house in houses] == ["building-1", "building-2"]
    ((points, colour),) = corners(houses[1])
    ours = drawn(list(parts_of(scene))[2].mesh)[:2]  # the third has no area
    np.testing.assert_allclose(points, ours, atol=1e-4)
    assert colour == (0.5, 0.4, 0.3)
    ((points, _),) = corners(named(nodes, "land"))
    np.testing.assert_allclose(points, drawn(square(0, 0))[:2], atol=1e-4)
    trees = named(nodes, "trees")["children"]
    for tree, pose in zip(trees, scene.fixtures.pose, strict=True):
        ((points, _),) = corners(tree)
        ours = drawn(transformed(scene.fixtures.levels[0][0], pose))[:2]
        np.testing.assert_allclose(points, ours, atol=1e-4)
    assert trees[1]["children"][0] is trees[0]["children"][0]  # told once


def test_the_ground_is_a_grid_of_the_same_heights(scene):
    land = named(read(scene), "land")
    assert land["translation"] == (0.0, 0.0, FLOOR)
    corner = land["boundingObject"]
    (grid,) = corner["children"]
    assert corner["translation"] == (-6.0, -2.0, 0.0)
    assert (grid["xDimension"], grid["yDimension"]) == (3, 2)
    assert (grid["xSpacing"], grid["ySpacing"]) == (4.0, 4.0)
    assert grid["height"].tolist() == [0, 1, 2, 3, 4, 5]
    flat = replace(scene, terrain=Terrain.flat(FLOOR), size=(100.0, 60.0))
    (grid,) = named(read(flat), "land")["boundingObject"]["children"]
    assert (grid["xSpacing"], grid["ySpacing"]) == (100.0, 60.0)


def test_what_bodies_meet_is_solid(scene):
    nodes = read(scene)
    (house,) = named(nodes, "building_1")["boundingObject"]["children"]
    faces = house["coord"]["point"][house["coordIndex"].reshape(-1, 4)[:, :3]]
    volume = np.einsum("ij,ij->", faces[:, 0], np.cross(faces[:, 1], faces[:, 2])) / 6
    assert volume == pytest.approx(3.0 * 5.0)  # closed, and turned outwards
    (trunk,) = named(nodes, "solid_things")["boundingObject"]["children"]
    assert trunk["translation"] == (5.0, 10.0, 2.5)
    assert (trunk["children"][0]["height"], trunk["children"][0]["radius"]) == (3.0, 0.5)


def test_sky_sun_fog_and_lamps_are_those_of_the_weather(scene):
    nodes = read(scene)
    assert nodes[0]["basicTimeStep"] == 2
    assert "have not seen it run" in nodes[0]["info"][0]
    sun = named(nodes, "tbgl")
    np.testing.assert_allclose(sun["direction"], -np.array(CLEAR_DAY.sun_direction), atol=1e-6)
    assert sun["intensity"] == pytest.approx(1.77 * 1.56)
    assert not [node for node in nodes if node.kind == "Fog"]
    fog = named(read(scene, FOG), "fog")
    assert (fog["fogType"], fog["visibilityRange"]) == ("EXPONENTIAL", pytest.approx(1000.0))
    lamp = named(read(scene, shining=False), "lamp_0")
    assert lamp["location"] == (1.0, 2.0, 8.0)
    assert lamp["direction"] == pytest.approx((0.6, 0.0, -0.8))
    assert lamp["on"] is False
    assert named(nodes, "lamp_0")["on"] is True


@pytest.mark.parametrize(
    ("wrong", "what"),
    [
        (Node("Solid", {"colour": (1.0, 0.0, 0.0)}), "Solid has no field colour"),
        (Node("Sphere", {}), "no node Sphere"),
        (Node("PBRAppearance", {"baseColor": (1.5, 0.0, 0.0)}), "PBRAppearance.baseColor"),
        (Node("Pose", {"rotation": (1.0, 1.0, 0.0, 1.0)}), "unit axis"),
        (Node("Transform", {"children": [Node("Solid")]}), "below a Transform"),
        (Node("Shape", {"geometry": Node("Solid")}), "holds a Solid"),
        (Node("Solid", {"boundingObject": Node("Transform")}), "Transform"),
        (Node("ElevationGrid", {"xDimension": 2, "yDimension": 2, "height": []}), "ElevationGrid|"),
    ],
)
def test_the_grammar_refuses_what_webots_would(wrong, what):
    with pytest.raises((AssertionError, KeyError, ValueError), match=what):
        Reader(world([], [], [wrong])).world()


@pytest.mark.sumo
def test_the_project_of_a_map_is_whole(project, told):
    path = project / "worlds" / WORLD
    nodes, known, importable = told
    assert importable == ["../protos/Drone.proto"]
    for each in [*known, *importable]:
        assert (path.parent / each).is_file()
    scene = load_scene(MAP, 0, MAPS.get(MAP).season("dusk"))
    standing = [
        each for node in nodes if node.kind in ("Solid", "Group") for each in corners_of(node)
    ]
    ours = [part.mesh for part in parts_of(scene)]
    ours += [
        transformed(
            scene.fixtures.levels[kind][1 if len(scene.fixtures.levels[kind]) > 1 else 0], at
        )
        for kind, at in zip(scene.fixtures.prototype, scene.fixtures.pose, strict=True)
    ]
    theirs, mine = together(standing), drawn(concatenate(ours)).reshape(-1, 9)
    low, high = theirs.reshape(-1, 3).min(axis=0), theirs.reshape(-1, 3).max(axis=0)
    np.testing.assert_allclose(low, mine.reshape(-1, 3).min(axis=0), atol=1e-3)
    np.testing.assert_allclose(high, mine.reshape(-1, 3).max(axis=0), atol=1e-3)
    assert area(theirs) == pytest.approx(area(mine), rel=1e-4)
    assert 0 <= len(mine) - len(theirs) < 0.02 * len(mine)  # those without area
    for url in urls(nodes):
        Image.open(path.parent / url).verify()
    receiver = named(nodes, "GLOBAL_RECEIVER")
    assert receiver["supervisor"] is True
    assert (project / "controllers" / receiver["controller"] / "global_receiver.py").is_file()
    roads = named(nodes, "SUMO_INTERFACE")["networkFiles"]
    for file in ("sumo.net.xml", "sumo.rou.xml", "sumo.sumocfg", "ground.json"):
        assert (path.parent / roads / file).is_file()
    settings = json.loads((project / "config" / "env_config.json").read_text())
    assert settings["World_Path"] == f"worlds/{WORLD}"


def corners_of(node):
    return [] if node.name.startswith("SUMO_VEHICLE") else corners(node)


def area(rows):
    points = rows.reshape(-1, 3, 3)
    across = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    return 0.5 * np.sqrt(np.square(across).sum(axis=1)).sum()


def urls(nodes):
    """All paths of pictures below some nodes."""
    found, left = set(), list(nodes)
    while left:
        node = left.pop()
        for value in node.fields.values():
            children = value if isinstance(value, list) else [value]
            left += [child for child in children if hasattr(child, "fields")]
        found |= set(node.get("url") or []) if node.kind == "ImageTexture" else set()
    return found


@pytest.mark.sumo
def test_vehicles_are_the_catalogue_s_and_take_a_colour(project, protos, told):
    vehicles = [node for node in told[0] if node.name.startswith("SUMO_VEHICLE")]
    assert [node.name for node in vehicles] == [f"SUMO_VEHICLE{k}" for k in range(len(vehicles))]
    cars = [node for node in vehicles if node["model"] == "passenger"]
    assert len(cars) == 40
    assert len({car["children"][0].kind for car in cars}) == 7
    assert len({car["children"][0]["color"] for car in cars}) == 8
    for proto in protos:
        if proto.name not in {node["children"][0].kind for node in vehicles}:
            continue
        assert proto.fields["color"] == "SFColor"
        model = MODELS[model_index(proto.name)]
        theirs = together(corners(proto.body)) + [0, 0, model.rise] * 3
        np.testing.assert_allclose(np.ptp(theirs.reshape(-1, 3), axis=0), model.size, rtol=0.1)
        ours = drawn(resting_mesh(proto.name, 1)).reshape(-1, 3)
        np.testing.assert_allclose(theirs.reshape(-1, 3).max(axis=0), ours.max(axis=0), atol=1e-3)
        painted = [node for node in shapes(proto.body) if "baseColor" in node["appearance"].taken]
        assert painted, proto.name
        for url in urls([proto.body]):
            assert (project / "protos" / url).is_file()


def shapes(node):
    if node.kind == "Shape":
        return [node]
    return [each for child in node.get("children") or [] for each in shapes(child)]


@pytest.mark.sumo
def test_the_drone_has_the_original_s_camera_on_its_gimbal(protos):
    drone = next(proto for proto in protos if proto.name == "Drone")
    kinds = [child.kind for child in drone.body["children"]]
    assert set(kinds) >= {"GPS", "InertialUnit", "Gyro", "Accelerometer", "Lidar", "HingeJoint"}
    place, node = np.zeros(3), drone.body["children"][-1]
    axes = []
    while node.kind == "HingeJoint":
        axes.append(node["jointParameters"]["axis"])
        link = node["endPoint"]
        assert link["translation"] == node["jointParameters"]["anchor"]
        place = place + link["translation"]
        (node,) = link["children"]
    assert axes == [(0, 0, 1), (0, 1, 0), (1, 0, 0)]
    assert node.kind == "Camera"
    assert place == pytest.approx([0.13817207, 0.0060388, -0.03960881])
    assert drone.defaults["cameraWidth"] == 320
