"""A detector in an ONNX file as a box tracker: of all that it finds, what fits the last box best.

The forms of YOLO's outputs are read by their shapes: (1, A, 5 + C) with a score of its own for each
box (v5 to v7), (1, 4 + C, A) (v8 to v12), both with the middle, width and height; and (1, K, 6)
with two corners, score and class (v10, and exports with the suppression inside). The input is one
picture, (1, 3, H, W), 0 to 1; ours is made to fit it, with grey borders.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.box_trackers import Box
from eyas.benchmark.policies.tracker.detector import Session
from eyas.engine.core.errors import DataFileError
from eyas.lanes import exact

Floats = NDArray[np.float64]

_SIDE = 640  # Of the input, where a network leaves it open [pixels]
_BORDER = 114  # Its grey
_SCORE = 0.1  # Least score that counts
_FEW = 1000  # Most boxes of an output with corners; without, there are thousands
_REACH = 1.5  # How far the target can be from where it was expected, in diagonals of its box
_FORGET = 0.7  # Share of the old velocity in the new one
_SAME = 3.0  # Largest ratio of the sizes of two boxes of one target


class _Form(NamedTuple):
    height: int
    width: int
    kind: Any  # Of numpy
    corners: bool
    across: bool  # Whether the boxes are along the last axis
    own_score: bool


def is_detector(session: Session) -> bool:
    """Return whether a network has the input and the output of a detector."""
    return _form(session) is not None


def _form(session: Session) -> _Form | None:
    inputs, outputs = session.get_inputs(), session.get_outputs()
    types = {"tensor(float)": np.float32, "tensor(float16)": np.float16}
    if len(inputs) != 1 or inputs[0].type not in types or len(inputs[0].shape) != 4:
        return None
    sides = [each if isinstance(each, int) else _SIDE for each in inputs[0].shape[2:]]
    shape = [each if isinstance(each, int) else 0 for each in outputs[0].shape]
    if inputs[0].shape[1] != 3 or len(shape) != 3 or max(sides) > 4096 or min(sides) < 32:
        return None
    rows, columns = shape[1:]
    if columns == 6 and 0 < rows <= _FEW:
        form = (True, False, True)
    elif rows >= 5 and (columns > rows or columns == 0):
        form = (False, True, False)
    elif columns >= 6:
        form = (False, False, True)
    else:
        return None
    height, width = sides
    return _Form(height, width, types[inputs[0].type], *form)


def detector_tracker(path: Path) -> Callable[[], "DetectionTracker"]:
    """Return what makes a tracker of the detector in a file.

    Raises:
        EyasError: It is no detector, or onnxruntime is not installed.
    """
    from eyas.benchmark.policies.onnx import open_session

    session = open_session(path)
    form = _form(session)
    if form is None:
        raise DataFileError(
            f"{path}: not a detector: one input (1, 3, H, W) and an output (1, A, 5 + C), "
            "(1, 4 + C, A) or (1, K, 6), as YOLO has them"
        )
    return lambda: DetectionTracker(session, form)


class DetectionTracker:
    """Follows one box through the detections of each picture."""

    def __init__(self, session: Session, form: _Form) -> None:
        self._session, self._form = session, form
        self._name = session.get_inputs()[0].name
        self._output = session.get_outputs()[0].name

    def begin(self, picture: NDArray[np.uint8], box: Box) -> None:
        """Begin with the first picture, and the target's box in it."""
        self._box, self._velocity, self._lost = np.array(box, np.float64), np.zeros(2), 0

    def update(self, picture: NDArray[np.uint8]) -> Box | None:
        """Return the detection that fits best; None: none does."""
        expected = self._box.copy()
        expected[:2] += self._velocity
        boxes = self._detections(picture)
        reach = _REACH * (1 + min(self._lost, 20) / 5) * float(exact.hypot(*expected[2:]))
        middle = expected[:2] + 0.5 * expected[2:]
        away = exact.hypot(*(boxes[:, :2] + 0.5 * boxes[:, 2:4] - middle).T)
        size = np.sqrt(np.maximum(boxes[:, 2] * boxes[:, 3], 1.0))
        usual = np.sqrt(max(expected[2] * expected[3], 1.0))
        fits = (away < reach) & (size < _SAME * usual) & (usual < _SAME * size)
        if not fits.any():
            self._box, self._lost = expected, self._lost + 1
            return None
        cost = away / reach + np.abs(exact.log(size / usual)) - 0.3 * boxes[:, 4]
        best = boxes[np.argmin(np.where(fits, cost, np.inf)), :4]
        moved = best[:2] + 0.5 * best[2:] - self._box[:2] - 0.5 * self._box[2:]
        self._velocity = _FORGET * self._velocity + (1.0 - _FORGET) * moved
        self._box, self._lost = best, 0
        left, top, width, height = best.tolist()
        return left, top, width, height

    def _detections(self, picture: NDArray[np.uint8]) -> Floats:
        """Return left, top, width, height [pixels of the picture] and score, shape (K, 5)."""
        from PIL import Image

        form = self._form
        height, width = picture.shape[:2]
        scale = min(form.width / width, form.height / height)
        inner = max(round(width * scale), 1), max(round(height * scale), 1)
        left, top = (form.width - inner[0]) // 2, (form.height - inner[1]) // 2
        fed = np.full((form.height, form.width, 3), _BORDER, np.uint8)
        small = Image.fromarray(picture).resize(inner, Image.Resampling.BILINEAR)
        fed[top : top + inner[1], left : left + inner[0]] = np.asarray(small)
        unit = (fed.transpose(2, 0, 1)[None].astype(np.float32) / 255.0).astype(form.kind)
        (answer,) = self._session.run([self._output], {self._name: unit})
        table = np.asarray(answer, np.float64).reshape(answer.shape[-2:])
        table = np.nan_to_num(table.T if form.across else table, posinf=0.0, neginf=0.0)
        boxes = table[:, :4].copy()
        if boxes.size and boxes.max() <= 2.0:  # shares of the picture
            boxes *= [form.width, form.height, form.width, form.height]
        if form.corners:
            boxes[:, 2:] -= boxes[:, :2]
            score = table[:, 4]
        else:
            boxes[:, :2] -= 0.5 * boxes[:, 2:]
            classes = table[:, 5 if form.own_score else 4 :]
            score = classes.max(axis=1) * (table[:, 4] if form.own_score else 1.0)
        boxes[:, :2] -= [left, top]
        chosen = (score >= _SCORE) & (boxes[:, 2:] > 0.0).all(axis=1)
        return np.column_stack([boxes / scale, score])[chosen]
