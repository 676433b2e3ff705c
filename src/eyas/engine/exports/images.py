"""Pictures, one file a frame: colours, masks, classes, depth, normals as PNG, JPEG or arrays; and
the pictures of the cameras that trackers have beside their own, with the poses of these.
"""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from eyas.engine.core.codecs.jpeg import jpeg_bytes
from eyas.engine.core.codecs.png import png_bytes
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.exports.frame import CameraPose, Frame
from eyas.engine.exports.writer import (
    Episode,
    EpisodeWriter,
    Files,
    PerFrameWriter,
    Run,
    Summary,
    Writer,
    numbered,
)
from eyas.engine.state.scene import ACTOR_OBJECT, LABELLED, LAST_PARKED
from eyas.lanes import exact

_MOST = np.iinfo(np.uint16).max  # Largest value of a pixel of 16 bits
_LABELLED = sorted(map(int, LABELLED))


class PlaneWriter(PerFrameWriter):
    """An array of a frame as PNG, as it is."""

    def encoded(self, frame: Frame) -> bytes:
        """Return the bytes of the one array that is wanted."""
        (plane,) = self.wants
        return png_bytes(getattr(frame, plane))


class PngWriter(PlaneWriter):
    """`NNNNNN.png`: the colours."""

    name = "{:06d}.png"
    wants = frozenset({"rgb"})
    files = Files(frame=(name,))


class CleanWriter(PlaneWriter):
    """`clean/NNNNNN.png`: the colours without noise, blur, dirt and the like, of the same instant,
    pose and lens as the picture.
    """

    name = "clean/{:06d}.png"
    wants = frozenset({"clean"})
    files = Files(frame=(name,))


class MaskWriter(PerFrameWriter):
    """`masks/NNNNNN.png`: which object of the labels each pixel shows, 16 bits: 0 for none, the
    number among the actors + 1 of what moves, that is the label's id - 65535, and 65535 less the id
    of what is parked.
    """

    name = "masks/{:06d}.png"
    wants = frozenset({"object_id", "class_id"})
    files = Files(frame=(name,))

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's masks."""
        assert frame.object_id is not None
        assert frame.class_id is not None
        shown = frame.object_id
        masks = np.maximum(shown - (ACTOR_OBJECT - 1), 0)
        parked = np.isin(frame.class_id, _LABELLED) & (shown > 0) & (shown <= LAST_PARKED)
        return png_bytes(np.where(parked, _MOST - shown, masks).astype(np.uint16))


class ClassWriter(PlaneWriter):
    """`classes/NNNNNN.png`: the `ObjectClass` of each pixel, 8 bits."""

    name = "classes/{:06d}.png"
    wants = frozenset({"class_id"})
    files = Files(frame=(name,))


class DepthWriter(PerFrameWriter):
    """`depth/NNNNNN.png`: distance along the optical axis in units of `video.depth_unit`, 16 bits;
    0 for the sky and what is too far.
    """

    name = "depth/{:06d}.png"
    wants = frozenset({"depth"})
    files = Files(frame=(name,))

    def __init__(self, run: Run) -> None:
        self._unit = run.depth_unit

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's depth."""
        assert frame.depth is not None
        units = np.maximum(np.rint(frame.depth / np.float64(self._unit)), 1.0)
        return png_bytes(np.where(units <= _MOST, units, 0.0).astype(np.uint16))


class NormalWriter(PlaneWriter):
    """`normals/NNNNNN.png`: the surface normal of each pixel in the camera's frame, right, down and
    ahead, each from -1 to 1 as 0 to 255; all 0 for the sky.
    """

    name = "normals/{:06d}.png"
    wants = frozenset({"normal"})
    files = Files(frame=(name,))


class ArrayWriter(PerFrameWriter):
    """`arrays/NNNNNN.npz`: `depth` [m], `object_id` and `class_id` as the renderer has them; not
    compressed.
    """

    name = "arrays/{:06d}.npz"
    wants = frozenset({"depth", "object_id", "class_id"})
    files = Files(frame=(name,))

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's arrays."""
        assert frame.depth is not None
        assert frame.object_id is not None
        assert frame.class_id is not None
        file = io.BytesIO()
        np.savez(file, depth=frame.depth, object_id=frame.object_id, class_id=frame.class_id)
        return file.getvalue()


class JpegWriter(PerFrameWriter):
    """`NNNNNN.jpeg` for each frame; the same picture gives the same bytes."""

    name = "{:06d}.jpeg"
    wants = frozenset({"rgb"})
    files = Files(frame=(name,))

    def __init__(self, run: Run) -> None:
        self._quality = run.jpeg_quality

    def encoded(self, frame: Frame) -> bytes:
        """Return a frame's picture."""
        assert frame.rgb is not None
        return jpeg_bytes(frame.rgb, self._quality)


_PICTURE, _POSES = "cameras/{:02d}-{:06d}.png", "cameras.json"


class CameraWriter(Writer):
    """`cameras/NN-NNNNNN.png`: the picture of each further camera, by its number in the setting
    `cameras`, in each frame; `cameras.json`: names, camera matrices, poses.
    """

    wants = frozenset({"cameras"})
    files = Files(frame=(_PICTURE,), episode=(_POSES,))

    def __init__(self, run: Run) -> None:
        self._count = len(run.config.cameras)

    def begin(self, episode: Episode) -> "_CameraFiles":
        """Return the writer of an episode's files."""
        with refusals(episode.folder):
            (episode.folder / _PICTURE).parent.mkdir(exist_ok=True)
        return _CameraFiles(episode.folder)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of frames; None if a file is missing."""
        try:
            content = read_json(folder / _POSES, 1 << 30)
            frames = {content["frames"], *(len(camera["poses"]) for camera in content["cameras"])}
        except (DataFileError, KeyError, TypeError):
            return None
        for number in range(self._count):
            found = numbered(folder, f"cameras/{number:02d}-{{:06d}}.png")
            frames.add(-1 if found is None else found.frames)
        return Summary(frames.pop()) if len(frames) == 1 and -1 not in frames else None


class _CameraFiles(EpisodeWriter):
    """The files of one episode."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._by_name: dict[str, dict[str, Any]] = {}
        self._frames = 0

    def add(self, frame: Frame) -> None:
        """Write the pictures of a frame."""
        self._frames += 1
        for number, camera in enumerate(frame.cameras):
            name = _PICTURE.format(number, frame.number)
            write_atomic(self._folder / name, png_bytes(camera.rgb))
            content = self._by_name.setdefault(
                camera.name, _optics(camera.name, number, camera.pose)
            )
            content["poses"].append(_pose(camera.pose, frame.camera))

    def finish(self) -> None:
        """Write `cameras.json`."""
        content = {"frames": self._frames, "cameras": [*self._by_name.values()]}
        text = json.dumps(content, indent=1)
        write_atomic(self._folder / _POSES, text.encode())


def _optics(name: str, number: int, pose: CameraPose) -> dict[str, Any]:
    """Return what stays the same in an episode."""
    return {
        "name": name,
        "number": number,
        "width": pose.width,
        "height": pose.height,
        "field_of_view": pose.field_of_view,
        "intrinsics": pose.intrinsics.tolist(),
        "poses": [],
    }


def _pose(pose: CameraPose, own: CameraPose) -> dict[str, Any]:
    """Return a pose in the world, and relative to the tracker's own camera: forward, left, up."""
    offset = exact.product(own.rotation.T, pose.position - own.position)
    return {
        "position": pose.position.tolist(),
        "rotation": pose.rotation.tolist(),
        "from_own": {
            "position": offset.tolist(),
            "rotation": exact.product(own.rotation.T, pose.rotation).tolist(),
        },
    }
