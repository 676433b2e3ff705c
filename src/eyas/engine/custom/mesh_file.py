"""Reading of mesh files through trimesh: triangles in metres, each with one colour."""

import io
import logging
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.doors import brought_object
from eyas.engine.core.errors import DataFileError, EyasError, MissingExtraError
from eyas.engine.core.files import read_limited, user_path
from eyas.engine.custom.collada_file import checked_collada
from eyas.engine.custom.config import ENDINGS, MESHES, CustomConfig
from eyas.engine.custom.gltf_file import beside, mended_gltf
from eyas.lanes import exact

LARGEST = 200_000  # Largest number of triangles of a target
_LARGEST_FILE = 512 << 20  # [bytes]
_GLTF_ENDINGS = (".glb", ".gltf")
_GLTF = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Our axes by those of glTF: z ahead, x left, y up."""

_INSIDE = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4], [2, 2, 2]]) / 6.0
"""Points of a triangle at which its texture is looked up, as shares of its corners."""

_FINE = 20_000
"""Number of triangles up to which textured parts are cut, so that they show their texture."""

_LARGEST_TEXTURE = 8192  # Largest side of a texture [pixels]
_EVEN = 0.01  # Mean deviation of the texture within triangles that is not worth a cut [sRGB 0 to 1]
_PLAIN = (0.62, 0.62, 0.62)  # sRGB of what has no colour


@dataclass(frozen=True, slots=True)
class Triangles:
    """A shape without materials. V vertices, T triangles."""

    points: NDArray[np.float64]  # [m], shape (V, 3)
    corners: NDArray[np.int64]  # Vertices, counter-clockwise as seen from outside, shape (T, 3)
    colours: NDArray[np.float64]  # sRGB 0 to 1, shape (T, 3)
    left_out: str = ""  # Parts of the file that are not read, in words
    up: str = "z"  # Axis that is up in the file, `y` or `z`

    @property
    def size(self) -> tuple[float, float, float]:
        """Length, width and height [m]."""
        used = self.points[self.corners.ravel()]
        length, width, height = (used.max(axis=0) - used.min(axis=0)).tolist()
        return length, width, height


def loaded(config: CustomConfig) -> Triangles:
    """Return the mesh that settings name, on the ground at the origin and looking along x.

    Raises:
        DataFileError: The file is missing, empty or cannot be read.
        MissingExtraError: trimesh is not installed.
    """
    assert config.mesh is not None
    path = user_path(config.mesh)
    shape = read_mesh(path)
    return placed(shape, config.up or shape.up, config.turn, config.scale)


Part = tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]
"""Points [m], shape (V, 3), triangles, shape (T, 3), and sRGB of each, shape (T, 3)."""

Reader = Callable[[Path, Callable[[Path], Part]], tuple[list[Part], str]]
"""Takes a path, and what reads the mesh files that it names; returns the parts, and a line about
what was left out."""


def reader_of(ending: str) -> Reader | None:
    """Return what a house brings to read files of an ending (group `eyas.mesh_files`)."""
    found: Reader | None = brought_object("eyas.mesh_files", ending)
    return found


def read_mesh(path: Path) -> Triangles:
    """Return the triangles of a file, in its own unit and axes.

    Raises:
        DataFileError: The file is missing, empty or cannot be read.
        MissingExtraError: trimesh is not installed.
    """
    if path.suffix.lower() not in ENDINGS:
        raise DataFileError(f"{path}: not a mesh file; allowed: {', '.join(ENDINGS)}")
    if not path.is_file():
        where = "" if path.is_absolute() else f" in {Path.cwd()}"
        raise DataFileError(f"{path}: cannot read: no such file{where}")
    if path.stat().st_size == 0:
        raise DataFileError(f"{path}: holds no triangles: the file is empty")
    if path.stat().st_size > _LARGEST_FILE:
        raise DataFileError(f"{path}: larger than {_LARGEST_FILE >> 20} MiB")
    if (read := reader_of(path.suffix.lower())) is not None:
        parts, left_out = read(path, _part_of)
        return replace(_joined([Triangles(*part) for part in parts]), left_out=left_out)
    return _from_trimesh(path)


def _from_trimesh(path: Path) -> Triangles:
    ending = path.suffix.lower()
    trimesh, left_out, up, unit = _trimesh(ending), "", "z", 1.0
    try:
        if ending in _GLTF_ENDINGS:
            (content, left_out), up = mended_gltf(path, _LARGEST_FILE), "y"
        else:
            content = read_limited(path, _LARGEST_FILE)
        if ending == ".dae":
            content, up, unit = checked_collada(content)
        with warnings.catch_warnings(), _quiet("trimesh"):
            warnings.simplefilter("ignore")  # what is wrong with a file is said in our words
            parts = [_checked(part) for part in _parts(trimesh, path, content)]
    except EyasError:
        raise
    except (KeyError, FileNotFoundError) as error:  # a buffer or a picture beside it
        missing = getattr(error, "filename", None) or next(iter(error.args), "")
        raise DataFileError(f"{path}: cannot read: it needs {missing!r}; there is none") from None
    except Exception as error:  # its readers raise whatever they stumble on
        said = str(error) if str(error) and not isinstance(error, NameError) else ""
        reason = said or "damaged, or without the numbers that it describes"
        raise DataFileError(f"{path}: cannot read as a mesh: {reason}") from None
    if not parts:
        raise DataFileError(f"{path}: holds no triangles")
    shape = _joined(parts)
    return replace(shape, points=shape.points * unit, left_out=left_out, up=up)


@contextmanager
def _quiet(library: str) -> Iterator[None]:
    """Keep a library from writing its warnings to the screen."""
    log = logging.getLogger(library)
    before = log.disabled
    log.disabled = True
    try:
        yield
    finally:
        log.disabled = before


def _part_of(path: Path) -> Part:
    """Return points, corners and colours of a mesh file that another file names."""
    if path.suffix.lower() not in MESHES:
        raise DataFileError(f"{path}: not a mesh file; allowed: {', '.join(MESHES)}")
    shape = read_mesh(path)
    return shape.points, shape.corners, shape.colours


def _joined(parts: Sequence[Triangles]) -> Triangles:
    first = np.cumsum([0, *(len(part.points) for part in parts)])
    return Triangles(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.corners + k for part, k in zip(parts, first, strict=False)]),
        np.concatenate([part.colours for part in parts]),
    )


def placed(
    shape: Triangles,  # As in the file
    up: str,  # The file's axis that is up: `y` as in glTF, or `z`
    turn: float,  # Angle by which it is turned, counter-clockwise from above [rad]
    scale: float,  # Metres in the file's unit
) -> Triangles:
    """Return a shape in metres, on the ground, its middle above the origin."""
    axes = _GLTF if up == "y" else np.eye(3)
    cosine, sine = exact.cos(turn), exact.sin(turn)
    axes = exact.product(
        np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]]), axes
    )
    with np.errstate(invalid="ignore"):  # what is not a number is told later
        points = exact.product(shape.points * scale, axes.T)
    used = points[shape.corners.ravel()]
    if not np.isfinite(used).all():
        return replace(shape, points=points)  # `eyas.engine.custom.problems` tells it
    low, high = used.min(axis=0), used.max(axis=0)
    middle = np.array([*(0.5 * (low + high))[:2], low[2]])
    return replace(shape, points=points - middle)


def _parts(trimesh: ModuleType, path: Path, content: bytes) -> Iterator[Triangles]:
    class Beside(trimesh.resolvers.FilePathResolver):  # type: ignore[misc,name-defined]
        """Reads files that a mesh names: materials, textures, buffers."""

        def get(self, name: str) -> bytes:
            found = beside(path, name.strip())
            if not found.is_file():
                raise FileNotFoundError(2, "no such file", name)
            return read_limited(found, _LARGEST_FILE)

    scene = trimesh.load_scene(
        io.BytesIO(content),
        file_type=path.suffix.lower()[1:],
        resolver=Beside(str(path)),
        # Not cleaned up: it would have lost the corners that are not numbers.
        process=False,
    )
    for part in scene.dump():
        corners = getattr(part, "faces", None)
        if corners is not None and len(corners):
            points = np.asarray(part.vertices, np.float64)
            corners = np.asarray(corners, np.int64)
            if _texture(part.visual) is None:
                yield Triangles(points, corners, _colours(part.visual, corners))
            else:
                yield _textured(trimesh, part.visual, points, corners)


def _checked(part: Triangles) -> Triangles:
    """Return triangles whose arrays fit to each other; `ValueError` if they do not."""
    count = len(part.corners)
    shapes = part.points.shape[1:], part.corners.shape[1:], part.colours.shape
    if part.points.ndim != 2 or shapes != ((3,), (3,), (count, 3)):
        raise ValueError("its points, triangles and colours do not fit to each other")
    if not ((part.corners >= 0) & (part.corners < len(part.points))).all():
        raise ValueError("a triangle has a corner that is not there")
    return part


def _colours(visual: Any, corners: NDArray[np.int64]) -> NDArray[np.float64]:  # noqa: ANN401
    """Return the colour of each triangle without a texture."""
    count = len(corners)
    if hasattr(visual, "material"):
        return np.tile(np.asarray(visual.material.main_color, np.float64)[:3] / 255.0, (count, 1))
    if not visual.defined:
        return np.tile(_PLAIN, (count, 1))
    if visual.kind == "vertex":
        colours = np.asarray(visual.vertex_colors, np.float64)[corners]
        return np.asarray(colours.mean(axis=1)[:, :3] / 255.0, np.float64)
    return np.asarray(visual.face_colors, np.float64)[:, :3] / 255.0


def _texture(visual: Any) -> Any:  # noqa: ANN401  # trimesh has no types
    """Return the picture that is the texture; None if there is none."""
    material = getattr(visual, "material", None)
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    return None if getattr(visual, "uv", None) is None else image


def _textured(
    trimesh: ModuleType,
    visual: Any,  # noqa: ANN401  # trimesh has no types
    points: NDArray[np.float64],
    corners: NDArray[np.int64],
) -> Triangles:
    """Return triangles with the mean of the texture in each, cut in four until they show it."""
    uv = np.asarray(visual.uv, np.float64)
    image = _texture(visual)
    if max(image.size) > _LARGEST_TEXTURE:
        raise ValueError(f"a texture of {image.size} pixels; allowed: {_LARGEST_TEXTURE} a side")
    pixels = np.asarray(image.convert("RGB"))
    given = getattr(visual.material, "baseColorFactor", None)
    factor = np.ones(3) if given is None else np.asarray(given, np.float64)[:3] / 255.0
    seen = _looked_up(pixels, factor, uv[corners])
    while 4 * len(corners) <= _FINE and seen.std(axis=0).mean() > _EVEN:
        points, corners, more = trimesh.remesh.subdivide(
            points, corners, vertex_attributes={"": uv}
        )
        uv = more[""]
        seen = _looked_up(pixels, factor, uv[corners])
    return Triangles(points, np.asarray(corners, np.int64), seen.mean(axis=0))


def _looked_up(
    pixels: NDArray[np.uint8],  # The texture, shape (H, W, 3)
    factor: NDArray[np.float64],  # By which its colours are multiplied, shape (3,)
    uv: NDArray[np.float64],  # Coordinates in it of the corners of the triangles, shape (T, 3, 2)
) -> NDArray[np.float64]:
    """Return the texture at four points of each triangle, shape (4, T, 3)."""
    height, width = pixels.shape[:2]
    u, v = np.moveaxis(exact.product(_INSIDE, uv), (2, 1), (0, 1))
    column = np.floor(u * width).astype(np.int64) % width
    row = np.floor((1.0 - v) * height).astype(np.int64) % height
    return np.asarray(pixels[row, column] / 255.0 * factor)


def _trimesh(ending: str) -> ModuleType:
    try:
        import trimesh
    except ImportError:
        raise MissingExtraError("a target's mesh file", "mesh") from None
    if ending == ".dae" and find_spec("collada") is None:
        raise MissingExtraError("a COLLADA file", "mesh")
    module: ModuleType = trimesh
    return module
