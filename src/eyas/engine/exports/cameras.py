"""Pictures of the cameras that trackers have beside their own, and where those are."""

import json
from pathlib import Path
from typing import Any

from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.core.png import png_bytes
from eyas.engine.exports.frame import CameraPose, Frame
from eyas.engine.exports.per_frame import numbered
from eyas.engine.exports.writer import Episode, EpisodeWriter, Files, Run, Summary, Writer
from eyas.lanes import exact

__all__ = ["CameraWriter"]

_PICTURE, _POSES = "cameras/{:02d}-{:06d}.png", "cameras.json"


class CameraWriter(Writer):
    """`cameras/NN-NNNNNN.png`: the picture of each further camera, by its number in the setting
    `cameras`, in each frame; `cameras.json`: names, camera matrices, poses.

    Args:
        run: The recording.
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
            told = read_json(folder / _POSES, 1 << 30)
            frames = {told["frames"], *(len(camera["poses"]) for camera in told["cameras"])}
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
        self._told: dict[str, dict[str, Any]] = {}
        self._frames = 0

    def add(self, frame: Frame) -> None:
        """Write the pictures of a frame."""
        self._frames += 1
        for number, camera in enumerate(frame.cameras):
            name = _PICTURE.format(number, frame.number)
            write_atomic(self._folder / name, png_bytes(camera.rgb))
            told = self._told.setdefault(camera.name, _optics(camera.name, number, camera.pose))
            told["poses"].append(_pose(camera.pose, frame.camera))

    def finish(self) -> None:
        """Write `cameras.json`."""
        told = {"frames": self._frames, "cameras": [*self._told.values()]}
        text = json.dumps(told, indent=1)
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
