"""URDF files as shapes."""

import math

import numpy as np
import pytest

from eyas.cli.bring import Brought, bring
from eyas.engine.core.errors import EyasError
from eyas.engine.custom.config import CustomConfig
from eyas.engine.custom.kind import own_target
from eyas.engine.custom.mesh_file import read_mesh

CART = """
<?xml version="1.0"?>
<robot name="cart" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="base">
    <visual>
      <origin xyz="0 0 0.5"/>
      <geometry><box size="2 1 0.5"/></geometry>
      <material name="red"/>
    </visual>
    <collision><geometry><box size="9 9 9"/></geometry></collision>
  </link>
  <link name="wheel">
    <visual>
      <origin rpy="1.5707963267948966 0 0"/>
      <geometry><cylinder radius="0.25" length="0.1"/></geometry>
      <material name="blue"><color rgba="0 0 1 1"/></material>
    </visual>
  </link>
  <link name="head">
    <visual><geometry><sphere radius="0.1"/></geometry></visual>
    <visual><geometry><sphere radius="0"/></geometry></visual>
  </link>
  <joint name="axle" type="continuous">
    <parent link="base"/><child link="wheel"/>
    <origin xyz="1, 0.5, 0.25"/>
  </joint>
  <joint name="neck" type="fixed">
    <parent link="wheel"/><child link="head"/>
    <origin xyz="0 0 1" rpy="0 0 0.3"/>
  </joint>
</robot>
"""


@pytest.fixture
def read(tmp_path):
    def from_text(text, name="cart.urdf"):
        (tmp_path / name).write_text(text)
        return read_mesh(tmp_path / name)

    return from_text


def one(geometry, extra=""):
    visual = f"<visual>{extra}<geometry>{geometry}</geometry></visual>"
    return f'<robot name="r"><link name="a">{visual}</link></robot>'


def test_links_stand_where_their_joints_put_them(read):
    shape = read(CART)
    blue = shape.points[shape.corners[shape.colours[:, 2] == 1.0].ravel()]
    assert blue.min(axis=0) == pytest.approx([0.75, 0.45, 0.0], abs=1e-6)
    assert blue.max(axis=0) == pytest.approx([1.25, 0.55, 0.5], abs=1e-6)
    red = shape.points[shape.corners[(shape.colours == (1.0, 0.0, 0.0)).all(axis=1)].ravel()]
    assert np.ptp(red, axis=0) == pytest.approx([2.0, 1.0, 0.5])
    assert shape.points[:, 2].max() == pytest.approx(1.25 + 0.1)
    assert shape.left_out == "left out, as not read: 1 sphere without a size"


@pytest.mark.parametrize(
    ("rpy", "end"),
    [
        ("0 0 1.5707963267948966", (0, 1, 0)),
        ("0 1.5707963267948966 0", (0, 0, -1)),
        ("1.5707963267948966 0 1.5707963267948966", (0, 1, 0)),
        ("0.3 -0.2 0.9", None),
    ],
)
def test_angles_turn_about_fixed_axes_roll_first(read, rpy, end):
    box = '<box size="0.02 0.02 0.02"/>'
    text = one(box).replace("</link>", '</link><link name="b"/>')
    joint = f'<joint name="j"><parent link="b"/><child link="a"/><origin rpy="{rpy}"/></joint>'
    text = text.replace("<visual>", '<visual><origin xyz="1 0 0"/>').replace(
        "</robot>", joint + "</robot>"
    )
    _, p, y = map(float, rpy.split())
    if end is None:  # x of the matrix of yaw, pitch and roll
        end = (math.cos(y) * math.cos(p), math.sin(y) * math.cos(p), -math.sin(p))
    assert read(text).points.mean(axis=0) == pytest.approx(end, abs=1e-9)


TETRA = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@pytest.mark.parametrize(
    "address",
    [
        "../meshes/t.obj",
        "package://cart_description/meshes/t.obj",
        "model://cart_description/meshes/t.obj",
        "/home/somebody/ws/src/cart_description/meshes/t.obj",
        "package://other_name/meshes/t.obj",
    ],
)
def test_meshes_are_looked_up_in_the_package(tmp_path, address):
    pytest.importorskip("trimesh")
    package = tmp_path / "cart_description"
    (package / "meshes").mkdir(parents=True)
    (package / "urdf").mkdir()
    (package / "meshes" / "t.obj").write_text(TETRA)
    red = '<material name="m"><color rgba="1 0 0 1"/></material>'
    text = one(f'<mesh filename="{address}" scale="1 2 -3"/>', red)
    (package / "urdf" / "r.urdf").write_text(text)
    shape = read_mesh(package / "urdf" / "r.urdf")
    assert shape.size == pytest.approx((1.0, 2.0, 3.0))
    assert (shape.colours == (1.0, 0.0, 0.0)).all()
    a, b, c = np.moveaxis(shape.points[shape.corners], 1, 0)
    assert (a * np.cross(b, c)).sum() / 6.0 == pytest.approx(1.0)  # still from outside


def test_few_meshes_that_are_missing_are_named_and_many_refused(read):
    box = '<box size="1 1 1"/>'
    mesh = '<mesh filename="package://r/arm.stl"/>'
    shape = read(one(f"{box}</geometry></visual><visual><geometry>{mesh}"))
    assert shape.left_out == "left out, as not read: 1 arm.stl (no such file)"
    with pytest.raises(EyasError, match=r"more than half of its meshes are missing: .*arm\.stl"):
        read(one(mesh))


def test_it_is_a_target_and_brought(tmp_path):
    path = tmp_path / "cart.urdf"
    path.write_text(CART)
    size = own_target(CustomConfig(mesh=str(path))).size
    assert size == pytest.approx((2.25, 1.1, 1.35), abs=1e-3)
    (found,) = bring([path])
    assert isinstance(found, Brought)
    assert found.what == "a shape for a target"
    assert "1 sphere without a size" in " ".join(found.notes)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("<robot", "not XML: "),
        ("<sdf/>", "its content is <sdf>, not <robot>"),
        ('<!DOCTYPE r [<!ENTITY a "b">]><robot/>', "it has a DOCTYPE, an ENTITY"),
        ('<robot name="r"><link name="a"/></robot>', "nothing of it is visible"),
        (one("<torus/>"), r"nothing of it is visible \(left out, as not read: 1 torus\)"),
        (one('<box size="1 2"/>'), "box.size is '1 2'; allowed: 3 numbers"),
        (one('<box size="1 2 nan"/>'), "allowed: 3 numbers"),
        (one('<box size="1 2 1e9"/>'), "allowed: 3 numbers"),
        (one('<box size="1 2 ${h}"/>'), r"write `xacro FILE > robot\.urdf` first"),
        (
            '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:a/></robot>',
            r"it is for xacro: write `xacro FILE > robot\.urdf`",
        ),
        (
            '<robot><link name="a"/><link name="b"/><link name="c"/>'
            '<joint><parent link="a"/><child link="b"/></joint>'
            '<joint><parent link="b"/><child link="b"/></joint></robot>',
            "links nested too deep, or too many",
        ),
    ],
)
def test_bad_files_are_told_in_one_line(read, text, problem):
    with pytest.raises(EyasError, match=problem) as caught:
        read(text)
    assert "\n" not in str(caught.value)
    assert "cart.urdf: cannot read as a URDF: " in str(caught.value)
