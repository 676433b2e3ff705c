"""Maps in the formats of other programs, read by these."""

import json
import os
import re
import shutil
import struct
import subprocess
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.mesh.assembly import transformed
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.scene import Fixtures, Lamps, ObjectClass, Scene
from eyas.maps.formats import layers, usd
from eyas.maps.formats.gltf.file import GltfFile
from eyas.maps.formats.gltf.world import add_lamps, add_world
from eyas.maps.formats.meshes import welded
from eyas.maps.formats.registry import MapExport, export
from eyas.maps.plants.wild import WILD

NODE = """
require("gltf-validator").validateBytes(new Uint8Array(require("fs").readFileSync(process.argv[1])))
  .then(report => console.log(JSON.stringify(report.issues)))
"""


def square(x: float, z: float, material: int = 0) -> Mesh:
    """A horizontal square of 2 m at a place."""
    corners = np.array([[x, 0, z], [x + 2, 0, z], [x + 2, 2, z], [x, 2, z]], np.float32)
    return Mesh(
        positions=corners,
        normals=np.tile(np.float32([0, 0, 1]), (4, 1)),
        uvs=corners[:, :2].copy(),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
        materials=np.full(2, material, np.int32),
        palette=(Material(), Material("brick", (0.5, 0.5, 0.5)), Material(surface=Surface.LAMP)),
    )


def joined(*meshes: Mesh) -> Mesh:
    first = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    return Mesh(
        positions=np.concatenate([mesh.positions for mesh in meshes]),
        normals=np.concatenate([mesh.normals for mesh in meshes]),
        uvs=np.concatenate([mesh.uvs for mesh in meshes]),
        triangles=np.concatenate(
            [mesh.triangles + low for mesh, low in zip(meshes, first[:-1], strict=True)]
        ).astype(np.int32),
        materials=np.concatenate([mesh.materials for mesh in meshes]),
        palette=meshes[0].palette,
    )


@pytest.fixture
def scene() -> Scene:
    """A lawn, two houses, and three trees of one kind, one of them turned and twice as large."""
    pose = np.tile(np.eye(3, 4, dtype=np.float32), (3, 1, 1))
    pose[:, :, 3] = [[0, 10, 0], [5, 10, 0], [9, 10, 0]]
    pose[2, :, :3] = [[0, -2, 0], [2, 0, 0], [0, 0, 2]]
    kinds = [ObjectClass.GROUND, ObjectClass.BUILDING, ObjectClass.BUILDING, ObjectClass.TREE]
    return replace(
        Scene.empty(),
        name="small",
        static=joined(square(0, 0), square(20, 5, 1), square(30, 6, 1)),
        static_object=np.repeat([0, 1, 2], 2).astype(np.int32),
        object_class=np.array(kinds, np.int32),
        fixtures=Fixtures(
            levels=((square(0, 3), square(0, 1)),),
            prototype=np.zeros(3, np.int32),
            pose=pose,
            object_id=np.full(3, 3, np.int32),
            names=("oak",),
        ),
        lamps=Lamps(
            np.array([[1, 2, 8], [4, 5, 8], [7, 8, 8]], np.float32),
            np.array([[0, 0, -1], [0.6, 0, -0.8], [0, 0, 1]], np.float32),
        ),
    )


@pytest.fixture
def written(scene, tmp_path):
    """The file of this map, and what it tells."""
    textures = {"brick": np.full((4, 4, 4), 200, np.uint8)}
    file = GltfFile(scene.name, textures)
    assert add_world(file, scene, detail=1) == 3 * 2 + 3 * 2
    add_lamps(file, scene.lamps)
    path = tmp_path / "small.glb"
    path.write_bytes(file.encoded())
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    return path, json.loads(data[20 : 20 + length])


def matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"]).reshape(4, 4).T
    whole = np.eye(4)
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    whole[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    whole[:3, 3] = node.get("translation", [0, 0, 0])
    return whole


def test_nodes_are_named_by_class_and_object(written):
    _, told = written
    nodes = told["nodes"]
    tree = {
        nodes[group]["name"]: [nodes[child]["name"] for child in nodes[group]["children"]]
        for group in nodes[0]["children"]
    }
    assert tree == {
        "ground": ["ground-0"],
        "building": ["building-1", "building-2"],
        "tree": ["oak-0", "oak-1", "oak-2"],
        "lamps": ["lamp-0", "lamp-1", "lamp-2"],
    }
    houses = [node for node in nodes if node["name"].startswith("building-")]
    assert all(node["extras"] == {"class": "building"} for node in houses)


def test_another_reader_finds_every_shape_in_its_place(written, scene):
    trimesh = pytest.importorskip("trimesh")
    read = trimesh.load(written[0])
    turn, name = read.graph["oak-2"]
    found = trimesh.transform_points(read.geometry[name].vertices, turn)
    ours = transformed(scene.fixtures.levels[0][1], scene.fixtures.pose[2]).positions
    np.testing.assert_allclose(found, ours[:, [0, 2, 1]] * [1, 1, -1], atol=1e-5)  # y points up


def test_lamps_shine_where_they_are_aimed(written, scene):
    _, told = written
    (light,) = told["extensions"]["KHR_lights_punctual"]["lights"]
    assert light["type"] == "spot"
    assert light["spot"]["outerConeAngle"] == scene.lamps.cut_off
    lamps = [node for node in told["nodes"] if "extensions" in node]
    for node, place, axis in zip(lamps, scene.lamps.position, scene.lamps.axis, strict=True):
        assert node["translation"] == place.tolist()
        shines = matrix(node)[:3, :3] @ [0, 0, -1]
        np.testing.assert_allclose(shines, axis, atol=1e-5)


@pytest.mark.checker
def test_the_validator_has_nothing_to_remark(written):
    """Needs node, and `NODE_PATH` where the package gltf-validator is."""
    node = shutil.which("node")
    check = [node or "", "-e", 'require("gltf-validator")']
    if node is None or subprocess.run(check, capture_output=True).returncode != 0:
        pytest.skip("there is no gltf-validator")
    done = subprocess.run([node, "-e", NODE, written[0]], capture_output=True, text=True)
    issues = json.loads(done.stdout)
    assert issues["messages"] == []


def test_an_unknown_format_is_told_with_the_nearest():
    with pytest.raises(UnknownNameError, match=r"^--format: 'glft' .* did you mean 'gltf'\?"):
        list(export("glft", None, MapExport("citystreet")))


@pytest.fixture(scope="module")
def roads(tmp_path_factory):
    """Citystreet's roads as OpenDRIVE."""
    path = tmp_path_factory.mktemp("roads") / "roads.xodr"
    assert list(export("opendrive", path, MapExport("citystreet"))) == [str(path)]
    return path


@pytest.mark.sumo
def test_roads_and_traffic_lights_are_in_opendrive(roads, tmp_path):
    root = ElementTree.parse(roads).getroot()
    head = root.find("header")
    assert head is not None
    assert head.get("name") == "citystreet"
    assert float(head.attrib["north"]) == -float(head.attrib["south"]) > 300.0
    streets = [road for road in root.iter("road") if road.get("junction") == "-1"]
    whole = sum(float(road.attrib["length"]) for road in streets)
    lanes = sum(len(road.findall(".//lane[@type='driving']")) for road in streets)
    assert whole > 3000.0
    assert lanes >= 2 * len(streets)
    assert len(list(root.iter("signal"))) > 50
    assert len(list(root.iter("junction"))) > 10
    again = tmp_path / "again.xodr"
    list(export("opendrive", again, MapExport("citystreet")))
    assert again.read_bytes() == roads.read_bytes()
    assert b"2026" not in again.read_bytes()[:1000]


@pytest.mark.sumo
@pytest.mark.checker
def test_asams_checker_finds_no_issue(roads, tmp_path):
    checker = shutil.which("qc_opendrive")
    if checker is None:
        pytest.skip("there is no asam-qc-opendrive")
    result, config = tmp_path / "result.xqar", tmp_path / "config.xml"
    config.write_text(
        f'<Config><Param name="InputFile" value="{roads}"/><CheckerBundle application='
        f'"xodrBundle"><Param name="resultFile" value="{result}"/></CheckerBundle></Config>'
    )
    # The checker brings its own libraries.
    own = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    subprocess.run([checker, "-c", config], check=True, capture_output=True, env=own)
    report = ElementTree.parse(result).getroot()
    done = [check for check in report.iter("Checker") if check.get("status") == "completed"]
    assert len(done) >= 10
    assert not list(report.iter("Issue"))


@pytest.mark.sumo
def test_sumo_drives_what_is_written(tmp_path):
    from eyas.engine.traffic.sumo_install import sumo_binary, sumo_environment

    lines = list(export("sumo", tmp_path, MapExport("citystreet")))
    assert lines == [
        str(tmp_path / f"citystreet.{kind}") for kind in ("net.xml", "rou.xml", "sumocfg")
    ]
    summary = tmp_path / "summary.xml"
    command = [sumo_binary("sumo"), "-c", tmp_path / "citystreet.sumocfg", "--end", "20"]
    done = subprocess.run(
        [*map(str, command), "--summary-output", str(summary)],
        env=sumo_environment(), capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    last = re.findall(r'inserted="(\d+)" running="(\d+)"', summary.read_text())[-1]
    assert last == ("40", "40")


@pytest.fixture
def stage(scene, monkeypatch, tmp_path):
    """This map as a stage, opened again."""
    pxr = pytest.importorskip("pxr")
    del pxr
    from pxr import Usd

    houses = np.array([[20, 0], [22, 0], [22, 2], [21, 1], [20, 2]], float)
    solid = replace(
        scene.colliders,
        prism_points=houses,
        prism_first=np.array([0, 5], np.int32),
        prism_bottom=np.array([0.0]),
        prism_top=np.array([5.0]),
        prism_object=np.array([1], np.int32),
        cylinder_centre=np.array([[5.0, 10.0]]),
        cylinder_radius=np.array([0.5]),
        cylinder_bottom=np.array([1.0]),
        cylinder_top=np.array([4.0]),
        cylinder_object=np.array([3], np.int32),
    )
    monkeypatch.setattr(usd, "load_scene", lambda name, seed: replace(scene, colliders=solid))
    monkeypatch.setattr(usd, "load_textures", lambda: {"brick": np.full((4, 4, 4), 9, np.uint8)})
    paths = [tmp_path / name / "small.usdc" for name in ("a", "b")]
    for path in paths:
        path.parent.mkdir()
        line = f"{path}: 12 triangles"
        assert list(export("usd", path, MapExport("citystreet"))) == [line]
    assert paths[0].read_bytes() == paths[1].read_bytes()
    return Usd.Stage.Open(str(paths[0]))


def test_a_stage_holds_every_shape_in_its_place_with_its_class(stage, scene):
    from pxr import UsdGeom, UsdSemantics

    assert (UsdGeom.GetStageUpAxis(stage), UsdGeom.GetStageMetersPerUnit(stage)) == ("Z", 1.0)
    house = stage.GetPrimAtPath("/small/building/building_1")
    labels = UsdSemantics.LabelsAPI(house, "class").GetLabelsAttr().Get()
    assert list(labels) == ["building"]
    tree = stage.GetPrimAtPath("/small/tree/oak_2")
    assert tree.IsInstance()
    labels = UsdSemantics.LabelsAPI(tree, "class").GetLabelsAttr().Get()
    assert list(labels) == ["tree"]
    assert tree.HasAPI(UsdSemantics.LabelsAPI, "class")
    shape = UsdGeom.Mesh(
        tree.GetPrimAtPath("shape") or stage.GetPrimAtPath(f"{tree.GetPath()}/shape")
    )
    whole = np.array(UsdGeom.Xformable(shape).ComputeLocalToWorldTransform(0))
    points = np.column_stack([np.array(shape.GetPointsAttr().Get()), np.ones(4)]) @ whole
    ours = transformed(scene.fixtures.levels[0][1], scene.fixtures.pose[2])
    corners = np.array(shape.GetFaceVertexIndicesAttr().Get())
    drawn = ours.positions[ours.triangles.ravel()]
    np.testing.assert_allclose(points[corners, :3], drawn, atol=1e-5)
    primvars = UsdGeom.PrimvarsAPI(shape)
    normals = np.array(primvars.GetPrimvar("normals").ComputeFlattened())
    np.testing.assert_allclose(normals, np.tile([0, 0, 1], (6, 1)))  # before it is turned
    uvs = np.array(primvars.GetPrimvar("st").ComputeFlattened())
    np.testing.assert_allclose(uvs, ours.uvs[ours.triangles.ravel()])
    light = stage.GetPrimAtPath("/small/lamps/lamp_1")
    turn = np.array(UsdGeom.Xformable(light).ComputeLocalToWorldTransform(0))
    np.testing.assert_allclose([0, 0, -1] @ turn[:3, :3], scene.lamps.axis[1], atol=1e-5)


def test_shapes_share_their_points_and_have_no_empty_triangles():
    """Two squares side by side that share no vertex, and a third without width."""
    narrow = square(4, 0)
    narrow.positions[:, 0] = 4.0
    shape = welded(joined(square(0, 0), square(2, 0, 1), narrow))
    assert len(shape.points.values) == 6
    assert shape.materials.tolist() == [0, 0, 1, 1]
    corners = shape.points.values[shape.points.corners]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert area[:, 2].tolist() == [4.0] * 4
    assert len(shape.normals.values) == 1


def test_colliders_of_a_stage_are_closed_and_not_drawn(stage):
    trimesh = pytest.importorskip("trimesh")
    from pxr import UsdGeom, UsdPhysics

    prism = UsdGeom.Mesh(stage.GetPrimAtPath("/small/colliders/prism_0"))
    faces = np.array(prism.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
    body = trimesh.Trimesh(np.array(prism.GetPointsAttr().Get()), faces)
    assert len(body.vertices) == len(prism.GetPointsAttr().Get())  # none merged while read
    assert body.is_watertight
    assert body.volume == pytest.approx(3.0 * 5.0)
    trunk = UsdGeom.Cylinder(stage.GetPrimAtPath("/small/colliders/cylinder_0"))
    assert (trunk.GetRadiusAttr().Get(), trunk.GetHeightAttr().Get()) == (0.5, 3.0)
    for made in (prism, trunk):
        assert made.GetPurposeAttr().Get() == "guide"
        assert made.GetPrim().HasAPI(UsdPhysics.CollisionAPI)


def test_the_validators_of_usd_have_nothing_to_remark(stage):
    from pxr import UsdValidation

    every = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(every) >= 20
    errors = UsdValidation.ValidationContext(every).Validate(stage)
    assert [error.GetMessage() for error in errors] == []


@pytest.mark.parametrize("plant", WILD)
def test_faces_in_usd_front_the_side_to_which_their_normals_point(plant):
    """So says omniverse-asset-validator of each mesh, as a whole."""
    for level in WILD[plant](np.random.default_rng(1))[:2]:
        mesh, thin = usd._fronting(level)
        first, second, third = np.moveaxis(mesh.positions[mesh.triangles], 1, 0)
        front = np.cross(second - first, third - first)
        assert (front * mesh.normals[mesh.triangles].sum(axis=1)).sum() > 0.0
        assert thin == ("tuft" in plant or "reeds" in plant)


def test_other_endings_than_those_of_stages_are_refused(tmp_path):
    with pytest.raises(ConfigError, match=r"^--out: 'a\.glb' is not allowed: .*\.usdc"):
        list(export("usd", tmp_path / "a.glb", MapExport("citystreet")))


def test_few_cells_are_filled_as_many_are(monkeypatch, scene):
    """One by one, or as arrays: the same numbers, also where shapes overlap."""
    rng = np.random.default_rng(7)
    corners = rng.uniform(-6, 6, (200, 1, 3)) + rng.normal(0.0, 1.5, (200, 3, 3))
    heap = replace(
        square(0, 0),
        positions=corners.reshape(-1, 3).astype(np.float32),
        normals=np.zeros((600, 3), np.float32),
        uvs=np.zeros((600, 2), np.float32),
        triangles=np.arange(600, dtype=np.int32).reshape(-1, 3),
        materials=np.zeros(200, np.int32),
    )
    owner = rng.integers(0, 4, 200).astype(np.int32)
    messy = replace(scene, static=heap, static_object=owner, size=(14.0, 14.0))
    ways = []
    for few in (0, layers._FEW, 10**6):
        monkeypatch.setattr(layers, "_FEW", few)
        ways.append(layers.rasters_of(messy, 0.5))
    for occupancy, height in ways[1:]:
        assert (occupancy == ways[0][0]).all()
        assert (height == ways[0][1]).all()
    assert len(np.unique(ways[0][0])) > 2
