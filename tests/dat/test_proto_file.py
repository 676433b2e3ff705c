"""Webots' `.proto` files as shapes."""

import math
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eyas.cli.targets.check import check
from eyas.engine.core.errors import EyasError
from eyas.engine.custom.config import CustomConfig
from eyas.engine.custom.kind import own_target
from eyas.engine.custom.mesh_file import loaded, read_mesh

CART = """#VRML_SIM R2023b utf8
# tags: nonDeterministic
EXTERNPROTO "webots://projects/appearances/protos/Rust.proto"
PROTO Cart [
  field SFVec3f    translation 0 0 0.4
  field SFRotation rotation    0 0 1 0
  field SFString   name        "cart"
  field SFColor{1 0 0, 0 1 0}  colour 1 0 0
  field MFNode     load        []
]
{
  Robot {
    translation IS translation
    rotation IS rotation
    name IS name
    children [
      DEF BODY Shape {
        appearance PBRAppearance { baseColor IS colour roughness 1 }
        geometry Box { size 2 1 0.5 }
      }
      HingeJoint {
        jointParameters HingeJointParameters { axis 0 1 0 }
        endPoint Solid {
          translation 0.5, 0, -0.3
          rotation 1 0 0 1.5707963267948966
          children [
            Shape {
              appearance Appearance { material Material { diffuseColor 0 0 1 } }
              geometry Cylinder { radius 0.2 height 0.1 }
            }
          ]
        }
      }
      Group { children IS load }
      Transform { translation 0 0 1 scale 0.5 0.5 0.5 children USE BODY }
    ]
    boundingObject Box { size 9 9 9 }
    physics Physics { mass 5 }
  }
}
"""


@pytest.fixture
def read(tmp_path):
    def from_text(text, name="thing.proto"):
        (tmp_path / name).write_text(text)
        return read_mesh(tmp_path / name)

    return from_text


def proto(geometry):
    return f"PROTO Thing [] {{ Solid {{ children [ Shape {{ geometry {geometry} }} ] }} }}"


def volume(shape):
    """Of a closed surface whose triangles are counter-clockwise from outside [m^3]."""
    a, b, c = np.moveaxis(shape.points[shape.corners], 1, 0)
    return (a * np.cross(b, c)).sum() / 6.0


def test_parts_are_where_the_nodes_put_them(read):
    shape = read(CART)
    low, high = shape.points.min(axis=0), shape.points.max(axis=0)
    # A box of 2 x 1 x 0.5, wheel below, half a box above; all 0.4 m up.
    assert low == pytest.approx([-1.0, -0.5, 0.4 - 0.5], abs=1e-9)
    assert high == pytest.approx([1.0, 0.5, 0.4 + 1.0 + 0.125], abs=1e-9)
    assert set(map(tuple, shape.colours.tolist())) == {(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)}
    wheel = shape.points[shape.corners[shape.colours[:, 2] == 1.0].ravel()]
    assert np.ptp(wheel, axis=0) == pytest.approx([0.4, 0.1, 0.4], abs=1e-9)
    assert volume(shape) == pytest.approx(
        1.0 + 1.0 / 8.0 + 0.1 * 24 / 2 * math.sin(2 * math.pi / 24) * 0.04, rel=1e-9
    )


@pytest.mark.parametrize(
    ("geometry", "expected"),
    [
        ("Box { size 1 2 3 }", 6.0),
        ("Sphere { radius 0.5 subdivision 3 }", 4 / 3 * math.pi * 0.125),
        ("Cylinder { radius 0.5 height 2 }", math.pi * 0.5),
        ("Cone { bottomRadius 0.5 height 3 }", math.pi * 0.25),
        ("Capsule { radius 0.5 height 2 }", math.pi * 0.5 + 4 / 3 * math.pi * 0.125),
        (
            "IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0, 0 0 1 ] } "
            "coordIndex [ 0 2 1 -1, 0 1 3 -1 0 3 2 -1 1 2 3 ] }",
            1 / 6,
        ),
    ],
)
def test_each_geometry_encloses_its_volume(read, geometry, expected):
    assert volume(read(proto(geometry))) == pytest.approx(expected, rel=0.04)


def test_a_mesh_beside_it_is_read_too(read, tmp_path):
    pytest.importorskip("trimesh")
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "t.obj").write_text(
        "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\n"
    )
    shape = read(proto('Mesh { url [ "meshes/t.obj" ] }'))
    assert shape.size == pytest.approx((2.0, 3.0, 1.0))
    for url, why in (
        ("meshes/u.obj", r"1 u\.obj \(no such file\)"),
        ("https://somewhere/t.obj", r"t\.obj \(no such file, on the web\)"),
        ("webots://t.obj", r"t\.obj \(no such file, see WEBOTS_HOME\)"),
    ):
        with pytest.raises(EyasError, match=f"more than half of its meshes are missing: .*{why}"):
            read(proto(f'Mesh {{ url "{url}" }}'))


@pytest.mark.parametrize(
    "url",
    [
        "webots://projects/a/t.obj",
        "https://raw.githubusercontent.com/cyberbotics/webots/R2023b/projects/a/t.obj",
    ],
)
def test_meshes_and_protos_of_webots_are_read_from_its_folder(read, tmp_path, monkeypatch, url):
    pytest.importorskip("trimesh")
    library = tmp_path / "webots" / "projects" / "a"
    library.mkdir(parents=True)
    (library / "t.obj").write_text("v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\n")
    (library / "Tail.proto").write_text(LEG.replace("Leg", "Tail"))
    monkeypatch.setenv("WEBOTS_HOME", str(tmp_path / "webots"))
    shape = read(f'PROTO T [] {{ Group {{ children [ CadShape {{ url "{url}" }} Tail {{ }} ] }} }}')
    assert len(shape.corners) == 2 + 4 * 24
    assert shape.left_out == ""


def test_it_is_a_target(tmp_path):
    (tmp_path / "Cart.proto").write_text(CART)
    config = CustomConfig(mesh=str(tmp_path / "Cart.proto"))
    assert loaded(config).points[:, 2].min() == pytest.approx(0.0)
    assert own_target(config).size == pytest.approx((2.0, 1.0, 1.625))


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "holds no triangles: the file is empty"),
        ("hello", "no PROTO"),
        ("PROTO X [", "cut off"),
        ("PROTO X [] { Solid { } }", "no geometry that can be read; allowed: Box, "),
        (proto("ElevationGrid { }"), r"1 ElevationGrid\); allowed: Box, "),
        (proto("Box { size 1 2 }"), r"Box\.size: 3 numbers expected"),
        (proto("Sphere { radius -1 }"), r"Sphere\.radius: a number above 0 expected"),
        (proto("IndexedFaceSet { coordIndex [ 0 1 2 ] }"), "up to -1 expected"),
        (proto("Box { size 1 2 1e999 }"), "the number 1e999 is not allowed"),
        ("PROTO X [] { %< for >% }", "its template breaks off"),
        ('PROTO X [] { Solid { name "a', "a text without its end"),
        ("PROTO X [] { Solid { children [ USE A ] } }", "USE A: no such DEF"),
        ("PROTO X [] { " + 99 * "Group { children " + "NULL", "nested more than 64 deep"),
        ("PROTO X [] { " + 2000 * "[ ", "."),
        ("PROTO X [] { DEF A Group { children [ USE A USE A ] } }", "nested too deep, or too many"),
    ],
)
def test_bad_files_are_told_in_one_line(read, text, problem):
    with pytest.raises(EyasError, match=problem) as caught:
        read(text)
    assert "\n" not in str(caught.value)
    assert "thing.proto: " in str(caught.value)


def bomb(levels):
    """Groups that hold the one before twice: 2 ** levels shapes in a small file."""
    text = "DEF G0 Group { children Shape { geometry Box { } } }"
    for level in range(levels):
        text += f" DEF G{level + 1} Group {{ children [ USE G{level} USE G{level} ] }}"
    return f"PROTO X [] {{ Group {{ children [ {text} ] }} }}"


def test_a_small_file_cannot_become_a_large_shape(read):
    with pytest.raises(EyasError, match=r"more than 5000 shapes|too many nodes"):
        read(bomb(40))


@settings(max_examples=150, deadline=None)
@given(st.integers(0, len(CART)), st.integers(0, 60), st.text('{}[]"#%<IS USE0.-\n', max_size=8))
def test_damaged_files_are_read_or_refused(tmp_path_factory, place, cut, put):
    path = tmp_path_factory.mktemp("proto") / "thing.proto"
    path.write_text(CART[:place] + put + CART[place + cut :])
    with suppress(EyasError):
        shape = read_mesh(path)
        assert shape.corners.max() < len(shape.points)


DOG = """#VRML_SIM R2023b utf8
EXTERNPROTO "parts/Leg.proto"
EXTERNPROTO "https://raw.githubusercontent.com/x/y/Tail.proto"
PROTO Dog [ field SFVec3f translation 0 0 0 field MFNode hat [ Ear { } ] ]
{
  Robot {
    translation IS translation
    children [
      Shape { appearance Fur { } geometry Box { size 1 0.4 0.2 } }
      Leg { translation 0.4 0 0 length 0.8 }
      Leg { translation -0.4 0 0 }
      Tail { }
      Propeller { slowHelix Solid { children [ Shape { geometry Box { size 0.1 2 0.1 } } ] } }
      Slot { endPoint Ear { } }
      Group { children IS hat }
      Shape { geometry IndexedLineSet { coordIndex [ 0 1 -1 ] } }
      Skin { }
    ]
  }
}
"""
LEG = """PROTO Leg [ field SFVec3f translation 0 0 0 field SFFloat length 0.2 ]
{ Solid { translation IS translation
    children [ Shape { geometry Cylinder { radius 0.05 height IS length } } ] } }
"""


@pytest.fixture
def dog(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "Leg.proto").write_text(LEG)
    (tmp_path / "Ear.proto").write_text(LEG.replace("Leg", "Ear"))
    path = tmp_path / "Dog.proto"
    path.write_text(DOG)
    return path


def test_protos_beside_it_are_read_with_the_fields_that_are_given(dog):
    shape = read_mesh(dog)
    assert np.allclose(shape.size, (1.0, 2.0, 0.8))  # the propeller is widest, one leg is longer
    assert len(shape.corners) == 12 + 12 + 4 * 4 * 24  # two boxes, two legs, two ears


def test_protos_in_folders_inside_it_need_no_name_as_before_r2022b(dog, tmp_path):
    (tmp_path / "parts" / "more").mkdir()
    (tmp_path / "parts" / "more" / "Skin.proto").write_text(LEG.replace("Leg", "Skin"))
    assert "Skin" not in read_mesh(dog).left_out


def test_what_is_left_out_is_counted_and_named(dog, caplog):
    told = "left out, as not read: 1 Fur (a colour), 1 IndexedLineSet, 1 Skin, 1 Tail"
    assert read_mesh(dog).left_out == told
    assert f"note: {told}" in check(str(dog), CustomConfig(mesh=str(dog)), "citystreet")[0]
    own_target(CustomConfig(mesh=str(dog)))
    assert f"{dog}: {told}" in caplog.text


def test_a_proto_of_which_nothing_is_read_says_what_it_has(tmp_path):
    path = tmp_path / "a.proto"
    path.write_text("PROTO a [] { Robot { children [ Body { } Body { } ] } }")
    with pytest.raises(EyasError, match=r"left out, as not read: 2 Body\); allowed: Box"):
        read_mesh(path)


def test_protos_that_name_each_other_end_in_one_line(tmp_path):
    for one, other in ("ab", "ba"):
        body = f"Group {{ children [ {other} {{ }} {other} {{ }} ] }}"
        (tmp_path / f"{one}.proto").write_text(f"PROTO {one} [] {{ {body} }}")
    with pytest.raises(EyasError, match=r"a\.proto: cannot read as a PROTO: nested too deep"):
        read_mesh(tmp_path / "a.proto")


def test_a_cad_shape_is_read_in_its_colours(tmp_path):
    pytest.importorskip("trimesh")
    (tmp_path / "red.mtl").write_text("newmtl red\nKd 1 0 0\n")
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    (tmp_path / "part.obj").write_text(f"mtllib red.mtl\n{corners}usemtl red\nf 1 2 3\nf 1 2 4\n")
    path = tmp_path / "cart.proto"
    path.write_text('PROTO cart [] { Pose { children [ CadShape { url "part.obj" } ] } }')
    assert read_mesh(path).colours.tolist() == [[1.0, 0.0, 0.0]] * 2
    path.write_text('PROTO cart [] { Pose { children [ CadShape { url "part.step" } ] } }')
    (tmp_path / "part.step").write_text("ISO-10303-21;")
    with pytest.raises(EyasError, match=r"part\.step: not a mesh file; allowed: \.dae"):
        read_mesh(path)


def test_a_geometry_and_a_colour_may_be_protos(read, tmp_path):
    (tmp_path / "Rod.proto").write_text("PROTO Rod [ field SFFloat r 1 ] { Cone { height IS r } }")
    (tmp_path / "Red.proto").write_text("PROTO Red [] { PBRAppearance { baseColor 1 0 0 } }")
    shape = read(
        "PROTO Thing [] { Group { children [ Shape { appearance Red { } geometry Rod { r 0.5 } } "
        "Shape { appearance Plastic { colorOverride 0 1 0 } geometry Box { } } ] } }"
    )
    assert shape.points[:, 2].max() == pytest.approx(0.25)
    assert set(map(tuple, shape.colours.tolist())) == {(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)}
    assert shape.left_out == ""


def test_what_a_proto_that_is_not_there_holds_is_shown(read):
    shape = read(
        "PROTO Thing [] { Robot { children [ SpringJoint { endPoint Solid { translation 0 0 1 "
        "children [ Shape { geometry Box { size 1 1 1 } } ] } } ] } }"
    )
    assert shape.points[:, 2].max() == pytest.approx(1.5)
    assert shape.left_out == "left out, as not read: 1 SpringJoint"


def test_before_r2022a_the_axis_of_what_is_round_is_y(read):
    text = proto("Cylinder { radius 0.5 height 3 }")
    assert read(text).size == pytest.approx((1.0, 1.0, 3.0), abs=1e-9)
    old = read("#VRML_SIM R2021b utf8\n" + text)
    assert old.size == pytest.approx((1.0, 3.0, 1.0), abs=1e-9)
    assert "custom.up=y stands it upright" in old.left_out


def test_motors_may_have_numbers_without_bounds(read):
    text = "PROTO Thing [] { Solid { children [ HingeJoint { device RotationalMotor { "
    text += "maxTorque 1e10 } endPoint Solid { children [ Shape { geometry Box { } } ] } } ] } }"
    assert len(read(text).corners) == 12
    with pytest.raises(EyasError, match=r"Box\.size: 3 numbers expected"):
        read(proto("Box { size 1 2 1e10 }"))


def test_a_node_turns_what_is_inside_it_counter_clockwise_about_its_axis(read):
    box = "Shape { geometry Box { size 0.2 0.2 0.2 } }"
    inner = f"Pose {{ translation 1 0 0 children [ {box} ] }}"
    quarter = f"Pose {{ rotation 0 0 1 {math.pi / 2} children [ {inner} ] }}"
    shape = read(f"PROTO Thing [] {{ Solid {{ children [ {quarter} ] }} }}")
    assert shape.points.mean(axis=0) == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
