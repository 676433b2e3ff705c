"""Box trackers: they get the target's first box, and find it again in each picture.

One class serves offline (`eyas track`) and in flight (`eyas evaluate --policy`).
"""

import os
from abc import abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError, DataFileError, MissingExtraError, UnknownNameError
from eyas.engine.core.own_code import imported, left_out

Box = tuple[float, float, float, float]  # Left, top, width, height [pixels]

Picture = NDArray[np.uint8]  # sRGB, row 0 on top, shape (H, W, 3)

NANO_FOLDER = "EYAS_NANOTRACK"
"""Environment variable: the folder with the two networks of NanoTrack."""

_LEAST = 8  # Smallest side of a box with which the trackers of OpenCV can begin [pixels]


class BoxTracker(Protocol):
    """Tracks one target through one sequence of pictures."""

    @abstractmethod
    def begin(self, picture: Picture, box: Box) -> None:
        """Begin with the first picture, and the target's box in it."""

    @abstractmethod
    def update(self, picture: Picture) -> Box | None:
        """Return the target's box in the next picture; None: it is not found."""


class _OpenCv:
    """A tracker of OpenCV, which `make` returns."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self._tracker = make()

    def begin(self, picture: Picture, box: Box) -> None:
        """Begin with a picture and a box."""
        left, top, width, height = (round(side) for side in box)
        whole = left, top, max(width, _LEAST), max(height, _LEAST)
        self._tracker.init(np.ascontiguousarray(picture[..., ::-1]), whole)

    def update(self, picture: Picture) -> Box | None:
        """Return the box in the next picture."""
        found, box = self._tracker.update(np.ascontiguousarray(picture[..., ::-1]))
        left, top, width, height = box
        return (float(left), float(top), float(width), float(height)) if found else None


class _Stay:
    """Says that the box has not moved: what a data set gives away for nothing."""

    def begin(self, picture: Picture, box: Box) -> None:
        """Remember the box."""
        self._box = box

    def update(self, picture: Picture) -> Box | None:
        """Return the first box."""
        return self._box


def _opencv(name: str) -> Callable[[], BoxTracker]:
    """Return what makes a tracker of OpenCV."""
    try:
        import cv2 as module
    except ImportError as error:
        raise MissingExtraError(f"the tracker {name!r}", "policies") from error
    cv2: Any = module  # whose types do not tell all of it
    cv2.setNumThreads(1)  # for the same bytes on every machine
    if name != "nano":
        made = f"Tracker{_OF_OPENCV[name]}_create"
        found = getattr(cv2, made, None) or getattr(getattr(cv2, "legacy", None), made, None)
        if found is None:
            raise ConfigError(
                f"--tracker: {name!r} is not in this OpenCV {cv2.__version__}: "
                "pip install opencv-contrib-python-headless, and no other package of OpenCV"
            )
        return lambda: _OpenCv(found)
    settings = cv2.TrackerNano_Params()
    settings.backbone, settings.neckhead = map(str, _networks())
    return lambda: _OpenCv(lambda: cv2.TrackerNano_create(settings))


def _networks() -> tuple[Path, Path]:
    """Return the files of NanoTrack's networks, which Eyas may not give away."""
    folder = Path(os.environ.get(NANO_FOLDER, "."))
    names = "nanotrack_backbone_sim.onnx", "nanotrack_head_sim.onnx"
    for name in names:
        if not (folder / name).is_file():
            raise DataFileError(
                f"{folder / name}: cannot read: no such file; --tracker nano wants {names[0]} and "
                f"{names[1]} of https://github.com/HonglinChu/SiamTrackers in the folder that the "
                f"environment variable {NANO_FOLDER} names"
            )
    return folder / names[0], folder / names[1]


_OF_OPENCV = {"csrt": "CSRT", "kcf": "KCF", "mosse": "MOSSE", "medianflow": "MedianFlow"}
"""OpenCV's classes by our names. MIL is not among them: it samples of one generator for all
sequences, which cannot be seeded, so that its boxes depend on what was tracked before."""


BOX_TRACKERS = (*_OF_OPENCV, "nano", "stay")  # Names of all


def box_tracker(
    said: str,  # A name of `BOX_TRACKERS`, a detector's `.onnx`, or `package.module:Class`
    setting: str = "--tracker",  # What names it, for messages
) -> Callable[[], BoxTracker]:
    """Return what makes a box tracker for a sequence.

    Raises:
        EyasError: There is no such tracker, or it cannot be used here.
    """
    if said == "stay":
        return _Stay
    if said in BOX_TRACKERS:
        return _opencv(said)
    if said.endswith(".onnx"):
        from eyas.benchmark.policies.detections import detector_tracker

        return detector_tracker(Path(said))
    if ":" not in said:
        raise UnknownNameError(
            setting, said, BOX_TRACKERS, others="FILE.onnx, package.module:Class"
        )
    try:
        found: Any = imported(said, setting)
    except ImportError as error:
        raise ConfigError(f"{setting}: '{said}' cannot be imported: {error}") from error
    if not callable(found) or left_out(found, ("begin", "update")):
        raise ConfigError(
            f"{setting}: '{said}' is not allowed: a class with begin(picture, box) and "
            "update(picture)"
        )
    made: Callable[[], BoxTracker] = found
    return made
