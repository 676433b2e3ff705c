"""Calibrations of real cameras as settings: ROS' `camera_info`, files of OpenCV, Kalibr, CamOdoCal
(VINS) and ORB-SLAM.

Read are the size, the camera matrix and the distortion, by the names that these tools give them, in
YAML or in OpenCV's XML. Coefficients of `plumb_bob`, `radtan` and of OpenCV become the lens
`brown`, those of `equidistant`, `kannala_brandt` and `fisheye` the lens `fisheye`.
"""

import math
import re
from pathlib import Path
from typing import Any

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.lanes import exact

ENDINGS = (".yaml", ".yml", ".xml")

_LARGEST = 4 << 20  # Largest file [bytes]
_FISHEYES = ("equi", "kannala", "fisheye")  # Beginnings of names of models
_SQUARE = 0.005  # Largest share by which pixels are higher than wide without a note

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_LIST = rf"\[([^\]]*)\]|((?:\s*-\s*{_NUMBER}\s*?(?=\n|$))+)"


def read_calibration(path: Path) -> tuple[dict[str, Any], list[str]]:
    """Return the settings of `camera` that a calibration means, and notes on what they leave out.

    Raises:
        DataFileError: It has no camera matrix, or an absurd one; one line.
    """
    text = _usual(path, read_limited(path, _LARGEST).decode("utf-8-sig", "replace"))
    size = _size(text)
    matrix = _list(text, ("camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "k"), 9)
    if matrix is None:
        short = _list(text, ("intrinsics",), 4)  # Kalibr
        matrix = short and [short[0], 0.0, short[2], 0.0, short[1], short[3], 0.0, 0.0, 1.0]
    if matrix is None or size is None:
        missing = "image_width and image_height" if matrix else "camera_matrix (or K)"
        raise DataFileError(f"{path}: not a calibration: it has no {missing}")
    (width, height), (fx, cx, fy, cy) = size, (matrix[0], matrix[2], matrix[4], matrix[5])
    if not (8 <= width <= 8192 and 8 <= height <= 8192):
        raise DataFileError(f"{path}: {width} x {height} pixels are not allowed: 8 to 8192")
    if not (0.1 * width <= fx <= 50.0 * width and 0.1 * width <= fy <= 50.0 * width):
        raise DataFileError(f"{path}: a focal length of {fx:g}, {fy:g} pixels is not allowed")
    # OpenCV counts from the middle of the first pixel, Eyas from its corner.
    right, below = (cx + 0.5) / width - 0.5, (cy + 0.5) / height - 0.5
    if not max(abs(right), abs(below)) <= 0.4:
        raise DataFileError(f"{path}: a principal point at {cx:g}, {cy:g} is not allowed")
    lens: dict[str, Any] = {"right": round(right, 6), "below": round(below, 6)}
    notes = []
    if abs(fy / fx - 1.0) > _SQUARE:
        notes.append(f"pixels are square here: fy {fy:g} counts as fx {fx:g}")
    lens |= _distortion(path, text, notes)
    view = 2.0 * float(exact.atan(0.5 * width / fx))
    return {"width": width, "height": height, "field_of_view": round(view, 6), "lens": lens}, notes


def _usual(path: Path, text: str) -> str:
    """Return a calibration whose numbers have names of their own with those of ROS behind it."""
    row = rf"^[ \t]*(?:Camera1?\.)?(\w+)[ \t]*:[ \t]*\"?({_NUMBER}|\w+)"
    cells = dict(re.findall(row, text, re.MULTILINE))
    model = str(cells.get("model_type") or cells.get("type") or "pinhole").lower()
    names = ("mu", "mv", "u0", "v0") if model.startswith(_FISHEYES) else ("fx", "fy", "cx", "cy")
    if model == "mei":
        raise DataFileError(
            f"{path}: the camera model MEI (unified, with a mirror) is not read; allowed: pinhole "
            "with radial and tangential distortion, Kannala-Brandt"
        )
    if "camera_matrix" in text or not set(names) <= cells.keys():
        return text
    fx, fy, cx, cy = (cells[name] for name in names)
    first = 2 if "k5" in cells and model.startswith(_FISHEYES) else 1  # CamOdoCal counts from k2
    fisheye = [f"k{k}" for k in range(first, first + 4)]
    wanted = fisheye if model.startswith(_FISHEYES) else ["k1", "k2", "p1", "p2", "k3"]
    return (
        f"{text}\ncamera_matrix: [{fx}, 0, {cx}, 0, {fy}, {cy}, 0, 0, 1]\n"
        f"distortion_model: {'fisheye' if wanted is fisheye else 'plumb_bob'}\n"
        f"distortion_coefficients: [{', '.join(cells.get(name, '0') for name in wanted)}]\n"
    )


def _distortion(path: Path, text: str, notes: list[str]) -> dict[str, Any]:
    names = ("distortion_coefficients", "distortion_coeffs", "Distortion_Coefficients",
             "dist_coeffs", "distCoeffs", "D", "d")  # fmt: skip
    numbers = _list(text, names) or []
    named = re.search(r"distortion_model\W+([A-Za-z_]+)", text)
    model = named[1].lower() if named else "plumb_bob"
    if not any(numbers):
        return {}
    if not all(abs(number) <= 10.0 for number in numbers):
        raise DataFileError(f"{path}: distortion coefficients beyond 10")
    if model.startswith(_FISHEYES):
        return {"model": "fisheye", **dict(zip(("k1", "k2", "k3", "k4"), numbers, strict=False))}
    if any(numbers[5:]):
        notes.append(f"{model}: coefficients after the fifth are left out: {numbers[5:]}")
    brown = ("k1", "k2", "p1", "p2", "k3")
    return {"model": "brown", **dict(zip(brown, numbers, strict=False))}


def _size(text: str) -> tuple[int, int] | None:
    found = _list(text, ("resolution",), 2)  # Kalibr
    if found is not None:
        return int(found[0]), int(found[1])
    sides = []
    for name in ("width", "height"):
        match = re.search(rf"\b(?:image_|img_)?{name}\W+(\d{{1,6}})\b", text, re.IGNORECASE)
        if match is None:
            return None
        sides.append(int(match[1]))
    return sides[0], sides[1]


def _list(text: str, names: tuple[str, ...], count: int | None = None) -> list[float] | None:
    """Return the numbers under the first of some names, in YAML or in OpenCV's XML."""
    for name in names:
        head = rf"^\s*{name}\s*:(?:[^\[]{{0,200}}?\bdata\s*:)?\s*"
        yaml = re.search(rf"{head}(?:{_LIST})", text, re.MULTILINE)
        xml = re.search(rf"<{name}[^>]*>.*?<data>([^<]*)</data>", text, re.DOTALL)
        for match in filter(None, (yaml, xml)):
            cells = re.findall(_NUMBER, next(filter(None, match.groups()), ""))
            numbers = [float(cell) for cell in cells]
            if (count is None or len(numbers) == count) and all(map(math.isfinite, numbers)):
                return numbers
    return None
