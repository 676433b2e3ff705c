"""Calibrations of real cameras: the numbers that ROS, OpenCV and Kalibr write."""

import math

import pytest

from eyas.engine.camera.calibration import read_calibration
from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.config import validated
from eyas.engine.core.errors import DataFileError

ROS = """image_width: 640
image_height: 480
camera_name: head
camera_matrix:
  rows: 3
  cols: 3
  data: [500.0, 0.0, 329.5, 0.0, 501.0, 239.5, 0.0, 0.0, 1.0]
distortion_model: {model}
distortion_coefficients:
  rows: 1
  cols: 5
  data: [{numbers}]
rectification_matrix:
  data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
"""
ECHO = """height: 480
width: 640
distortion_model: plumb_bob
d:
- -0.28
- 0.07
- 0.001
- -0.002
- 0.0
k:
- 500.0
- 0.0
- 329.5
- 0.0
- 501.0
- 239.5
- 0.0
- 0.0
- 1.0
"""
OPENCV = """%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.0e+02, 0., 3.295e+02, 0., 5.01e+02, 2.395e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.28, 0.07, 0.001, -0.002, 0. ]
"""
XML = """<?xml version="1.0"?><opencv_storage><image_Width>640</image_Width>
<image_Height>480</image_Height>
<Camera_Matrix type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt>
<data>500. 0. 329.5 0. 501. 239.5 0. 0. 1.</data></Camera_Matrix>
<Distortion_Coefficients type_id="opencv-matrix"><rows>5</rows>
<data>-0.28 0.07 0.001 -0.002 0.</data></Distortion_Coefficients></opencv_storage>
"""
KALIBR = """cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.001, -0.002]
  distortion_model: radtan
  intrinsics: [500.0, 501.0, 329.5, 239.5]
  resolution: [640, 480]
"""
BARREL = "-0.28, 0.07, 0.001, -0.002, 0.0"


@pytest.mark.parametrize(
    "text",
    [ROS.format(model="plumb_bob", numbers=BARREL), ECHO, OPENCV, XML, KALIBR],
    ids=["ros", "echo", "opencv", "xml", "kalibr"],
)
def test_each_form_means_the_same_camera(tmp_path, text):
    path = tmp_path / "camera.yaml"
    path.write_text(text)
    settings, notes = read_calibration(path)
    config = validated(CameraConfig, settings, "camera")
    assert (config.width, config.height) == (640, 480)
    assert config.field_of_view == pytest.approx(2.0 * math.atan(320.0 / 500.0), abs=1e-5)
    lens = config.lens
    assert (lens.model, lens.k1, lens.k2, lens.p1, lens.p2) == ("brown", -0.28, 0.07, 0.001, -0.002)
    assert lens.right == pytest.approx(10.0 / 640.0, abs=1e-5)  # 329.5 counts from a pixel's middle
    assert lens.below == pytest.approx(0.0, abs=1e-5)
    assert notes == []


def test_a_fisheye_is_one_and_what_is_left_out_is_a_note(tmp_path):
    path = tmp_path / "camera.yaml"
    path.write_text(ROS.format(model="equidistant", numbers="0.1, 0.02, -0.003, 0.0004"))
    lens = read_calibration(path)[0]["lens"]
    assert (lens["model"], lens["k4"]) == ("fisheye", 0.0004)
    path.write_text(ROS.format(model="rational_polynomial", numbers=BARREL + ", 0.5, 0, 0"))
    assert "after the fifth" in read_calibration(path)[1][0]
    path.write_text(ROS.format(model="plumb_bob", numbers="0, 0, 0, 0, 0").replace("501.0", "700"))
    settings, notes = read_calibration(path)
    assert "model" not in settings["lens"]
    assert notes == ["pixels are square here: fy 700 counts as fx 500"]


VINS = """%YAML:1.0
---
model_type: {model}
image_width: 752
image_height: 480
distortion_parameters:
   k1: -0.28
   k2: 0.07
   p1: 0.001
   p2: -0.002
projection_parameters:
   {numbers}
"""
SLAM = """Camera.type: "{model}"
Camera1.fx: 460.0
Camera1.fy: 460.0
Camera1.cx: 375.5
Camera1.cy: 239.5
Camera1.k1: -0.28
Camera1.k2: 0.07
Camera1.p1: 0.001
Camera1.p2: -0.002
Camera.width: 752
Camera.height: 480
"""
MATRIX = "fx: 460.0\n   fy: 460.0\n   cx: 375.5\n   cy: 239.5"


@pytest.mark.parametrize(
    "text", [VINS.format(model="PINHOLE", numbers=MATRIX), SLAM.format(model="PinHole")]
)
def test_numbers_with_names_of_their_own_are_read(tmp_path, text):
    path = tmp_path / "camera.yaml"
    path.write_text(text)
    settings, _ = read_calibration(path)
    lens = settings["lens"]
    assert settings["field_of_view"] == pytest.approx(2.0 * math.atan(376.0 / 460.0), abs=1e-5)
    assert (lens["right"], lens["below"]) == (0.0, 0.0)
    assert [lens[key] for key in ("k1", "k2", "p1", "p2")] == [-0.28, 0.07, 0.001, -0.002]


def test_a_fisheye_of_vins_counts_from_k2_and_a_mirror_is_refused_by_name(tmp_path):
    path = tmp_path / "camera.yaml"
    numbers = "k2: 0.1\n   k3: 0.02\n   k4: -0.003\n   k5: 0.0004\n   " + MATRIX.replace(
        "fx", "mu").replace("fy", "mv").replace("cx", "u0").replace("cy", "v0")  # fmt: skip
    text = VINS.format(model="KANNALA_BRANDT", numbers=numbers)
    path.write_text(text.replace("   k1: -0.28\n   k2: 0.07\n", ""))
    lens = read_calibration(path)[0]["lens"]
    assert lens["model"] == "fisheye"
    assert [lens[f"k{k}"] for k in range(1, 5)] == [0.1, 0.02, -0.003, 0.0004]
    path.write_text(text.replace("KANNALA_BRANDT", "MEI"))
    with pytest.raises(DataFileError, match="the camera model MEI"):
        read_calibration(path)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("camera_matrix", "matrix", r"no camera_matrix \(or K\)"),
        ("image_width: 640\n", "", "no image_width and image_height"),
        ("image_width: 640", "image_width: 99999", "99999 x 480 pixels are not allowed"),
        ("500.0", "1e300", "a focal length of 1e\\+300"),
        ("329.5", "-90000", "a principal point at -90000"),
        ("-0.28", "1e9", "beyond 10"),
    ],
)
def test_what_is_no_calibration_is_one_line(tmp_path, old, new, line):
    path = tmp_path / "camera.yaml"
    path.write_text(ROS.format(model="plumb_bob", numbers=BARREL).replace(old, new))
    with pytest.raises(DataFileError, match=line):
        read_calibration(path)
