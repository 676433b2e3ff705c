from pathlib import Path

import numpy as np
import pytest

from eyas.cli.targets.check import check
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.custom.config import CustomConfig
from eyas.engine.custom.kind import kind_name_of
from eyas.engine.custom.mesh_file import Triangles, loaded
from eyas.engine.custom.problems import of_shape
from eyas.engine.custom.shape import levels_of_detail, mesh_of, simplified

trimesh = pytest.importorskip("trimesh")

SIZE = (2.0, 1.0, 0.5)
RED = [200, 20, 10, 255]


@pytest.fixture(params=["glb", "obj", "stl", "ply"])
def box(request, tmp_path: Path) -> Path:
    """A red box, 2 m long; in a GLB file y is up and z ahead."""
    shape = trimesh.creation.box((1.0, 0.5, 2.0) if request.param == "glb" else SIZE)
    if request.param != "stl":
        shape.visual.vertex_colors = RED
    path = tmp_path / f"box.{request.param}"
    shape.export(path)
    return path


def ball(subdivisions: int) -> Triangles:
    shape = trimesh.creation.icosphere(subdivisions)
    colours = np.tile([0.2, 0.4, 0.6], (len(shape.faces), 1))
    return Triangles(np.array(shape.vertices), np.array(shape.faces), colours)


def test_a_file_stands_on_the_ground_and_looks_along_x(box: Path):
    shape = loaded(CustomConfig(mesh=str(box)))
    np.testing.assert_allclose(shape.size, SIZE, atol=1e-6)
    np.testing.assert_allclose(shape.points.min(axis=0), [-1.0, -0.5, 0.0], atol=1e-6)
    if box.suffix != ".stl":
        np.testing.assert_allclose(shape.colours, np.array([RED[:3]] * 12) / 255.0, atol=0.03)
    turned = loaded(CustomConfig(mesh=str(box), turn=np.pi / 2, scale=0.1))
    np.testing.assert_allclose(turned.size, [0.1, 0.2, 0.05], atol=1e-6)
    assert list(of_shape(shape)) == []


def test_a_positive_turn_is_counter_clockwise_from_above(tmp_path: Path):
    arrow = trimesh.Trimesh([[0, 0, 0], [4, 0, 0], [0, 1, 0], [0, 0, 1]],
                            [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])  # fmt: skip
    arrow.export(tmp_path / "arrow.ply")
    shape = loaded(CustomConfig(mesh=str(tmp_path / "arrow.ply"), turn=np.pi / 2))
    assert shape.size == pytest.approx((1.0, 4.0, 1.0))
    tops = shape.points[shape.points[:, 2] > 0.9]
    assert tops[0][:2] == pytest.approx([0.5, -2.0])  # its tip is to the left


def test_a_factor_dyes_the_texture(tmp_path: Path):
    from PIL import Image

    white = Image.new("RGB", (8, 8), (255, 255, 255))
    dyed = trimesh.visual.material.PBRMaterial(
        baseColorTexture=white, baseColorFactor=[255, 128, 0, 255]
    )
    visual = trimesh.visual.TextureVisuals(uv=np.eye(4, 2), material=dyed)
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    trimesh.Trimesh(points, faces, visual=visual, process=False).export(tmp_path / "dyed.glb")
    colours = loaded(CustomConfig(mesh=str(tmp_path / "dyed.glb"))).colours
    np.testing.assert_allclose(colours, [[1.0, 0.5, 0.0]] * len(colours), atol=0.02)


def test_a_texture_becomes_colours(tmp_path: Path):
    from PIL import Image

    halves = np.zeros((8, 8, 3), np.uint8)
    halves[:, :4], halves[:, 4:] = (255, 0, 0), (0, 0, 255)
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]]
    uv = np.array([[x / 2, y] for x, y, _ in points], np.float64)
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.fromarray(halves))
    visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    faces = [[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]
    trimesh.Trimesh(points, faces, visual=visual, process=False).export(tmp_path / "flag.glb")
    colours = loaded(CustomConfig(mesh=str(tmp_path / "flag.glb"))).colours
    np.testing.assert_allclose(colours[:2], [[1, 0, 0]] * 2, atol=0.02)
    np.testing.assert_allclose(colours[2:], [[0, 0, 1]] * 2, atol=0.02)


@pytest.mark.parametrize("ending", ["glb", "obj"])
def test_large_triangles_show_their_texture(tmp_path: Path, ending: str):
    """A square of two triangles with a red disc in the upper half of its picture."""
    from PIL import Image, ImageDraw

    picture = Image.new("RGB", (64, 64), (240, 240, 240))
    ImageDraw.Draw(picture).ellipse((16, 4, 48, 36), fill=(200, 0, 0))
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=picture)
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float64)
    flat = np.column_stack([uv - 0.5, np.zeros(4)])
    points = flat if ending == "obj" else flat[:, [1, 2, 0]]  # y is up in glTF, z ahead
    shape = trimesh.Trimesh(
        points,
        [[0, 1, 2], [0, 2, 3]],
        visual=trimesh.visual.TextureVisuals(uv=uv, material=material),
        process=False,
    )
    shape.export(tmp_path / f"disc.{ending}")
    read = loaded(CustomConfig(mesh=str(tmp_path / f"disc.{ending}")))
    middle = read.points[read.corners].mean(axis=1)[:, :2]
    away = np.hypot(middle[:, 0], middle[:, 1] - 12 / 64)
    assert np.abs(read.colours[away < 0.2] - [0.78, 0.0, 0.0]).max() < 0.02
    assert np.abs(read.colours[away > 0.32] - [0.94, 0.94, 0.94]).max() < 0.02
    assert len(read.corners) <= 20_000


def test_edges_stay_sharp_and_curves_are_smooth():
    box = trimesh.creation.box(SIZE)
    sharp = mesh_of(Triangles(box.vertices, box.faces, np.ones((12, 3))))
    assert len(sharp.positions) == 24  # three normals at each corner
    smooth = mesh_of(ball(3))
    np.testing.assert_allclose(smooth.normals, smooth.positions, atol=0.02)
    assert len(smooth.positions) == 642


def test_simpler_meshes_keep_their_size():
    shape = ball(4)
    for most in (1500, 300, 60):
        simpler = simplified(shape, most)
        assert 0.4 * most < len(simpler.corners) <= most
        np.testing.assert_allclose(simpler.size, shape.size, rtol=0.25)
    counts = [len(mesh.triangles) for mesh in levels_of_detail(shape)]
    assert counts[0] == 5120 > counts[1] > counts[2] > 60


def told(shape: Triangles) -> list[str]:
    return [finding.text for finding in of_shape(shape)]


def test_what_is_wrong_with_a_shape_is_told():
    good = ball(2)
    assert told(good) == []
    holed = Triangles(good.points, good.corners[3:], good.colours[3:])
    assert told(holed)[0].startswith("it is not closed: ")
    inside_out = Triangles(good.points, good.corners[:, ::-1], good.colours)
    assert told(inside_out) == ["it is inside out: its triangles run clockwise from outside"]
    assert (
        "in millimetres? then use custom.scale=0.001 (--scale 0.001)"
        in told(Triangles(good.points * 900.0, good.corners, good.colours))[0]
    )
    broken = good.points.copy()
    broken[7, 1] = np.nan
    assert told(Triangles(broken, good.corners, good.colours)) == ["1 vertex not finite (NaN)"]
    flat = Triangles(good.points * [1, 1, 0], good.corners, good.colours)
    assert told(flat)[0].startswith("it has no size, or is flat: ")


@pytest.mark.slow
def test_a_mesh_that_is_too_large_is_refused_and_simplified_on_request(tmp_path: Path):
    path = tmp_path / "fine.stl"
    trimesh.creation.uv_sphere(count=[225, 225]).export(path)
    with pytest.raises(ConfigError, match=r"202496 triangles; allowed: up to 200000; simplify"):
        kind_name_of(CustomConfig(mesh=str(path)))
    lines, usable = check(str(path), CustomConfig(path="-", most_triangles=2000), "citystreet")
    assert usable
    assert " of 202496 triangles" in lines[0]


def test_files_that_are_none_are_told_in_one_line(tmp_path: Path):
    (tmp_path / "noise.glb").write_bytes(b"glTF and then nothing")
    (tmp_path / "empty.obj").write_text("# nothing\n")
    (tmp_path / "empty.glb").write_bytes(b"")
    for name, message in (
        ("missing.stl", "no such file"),
        ("empty.glb", "holds no triangles: the file is empty"),
        ("noise.glb", "cannot read as a mesh"),
        ("empty.obj", "empty.obj: "),
    ):
        with pytest.raises(DataFileError, match=message) as caught:
            loaded(CustomConfig(mesh=str(tmp_path / name)))
        assert "\n" not in str(caught.value)


def test_files_that_a_mesh_needs_are_named(tmp_path: Path):
    import json

    text = trimesh.creation.box(SIZE).export(file_type="gltf")["model.gltf"]
    model = json.loads(text)
    for buffer in model["buffers"]:
        buffer["uri"] = "corners.bin"
    (tmp_path / "model.gltf").write_text(json.dumps(model))
    with pytest.raises(DataFileError, match=r"it needs 'corners\.bin'; there is none$"):
        loaded(CustomConfig(mesh=str(tmp_path / "model.gltf")))


def test_a_corner_that_is_no_number_is_told(tmp_path: Path):
    corners = "v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    (tmp_path / "nan.obj").write_text(corners + "f 1 2 3\nf 1 3 4\nf 2 3 4\nf 1 4 2\n")
    with pytest.raises(ConfigError, match=r"nan\.obj: 1 vertex not finite"):
        kind_name_of(CustomConfig(mesh=str(tmp_path / "nan.obj")))


def test_a_mesh_in_millimetres_is_suspected_and_refused(tmp_path: Path):
    trimesh.creation.box((900, 400, 300)).export(tmp_path / "drawn.stl")
    with pytest.raises(ConfigError, match=r"in millimetres\? then use custom\.scale=0\.001"):
        kind_name_of(CustomConfig(mesh=str(tmp_path / "drawn.stl")))


def test_triangles_that_are_mere_points_are_left_out_of_a_simpler_mesh():
    corners = np.repeat(np.arange(300)[:, None], 3, axis=1)
    corners[:10, 1:] += [1, 2]
    points = np.random.default_rng(0).random((300, 3))
    few = simplified(Triangles(points, corners, np.zeros((300, 3))), 20)
    assert len(few.corners) == 10
