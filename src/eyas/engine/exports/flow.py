"""Optical flow from the true motion of the camera, of what stands still, and of every moving part.

The point of the world that a pixel shows moves with its part, and is looked for in the next
picture. What falls or shimmers (snow, water) counts as standing still.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.codecs.png import png_bytes
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.core.optics.lens import NO_LENS, Lens, distorted, principal_point, undistorted
from eyas.engine.core.optics.pinhole import focal_length
from eyas.engine.exports.frame import CameraPose, Floats, Frame
from eyas.engine.exports.writer import Episode, EpisodeWriter, Files, Run, Summary, Writer, numbered
from eyas.engine.render.kernels.bundles import NEAR
from eyas.engine.state.draw import MovingParts
from eyas.lanes import compiled, kernel

SCALE, ZERO = 64.0, 32768.0  # KITTI's encoding of a flow: 64 for each pixel, above 32768
_TOLERANCE, _LEAST = 0.01, 0.02
"""A point is hidden by what is nearer than it by this share of its distance, and [m]: more than
what depths of neighbouring pixels leave open."""


class FlowWriter(Writer):
    """`flow/NNNNNN.png`: where each pixel's point is in the next picture of the episode, as KITTI
    has it; the last picture of an episode has no valid pixel.

    Raises:
        ConfigError: Rows of pictures are exposed one after the other (`camera.shutter.readout`).
    """

    name = "flow/{:06d}.png"
    wants = frozenset({"parts"})
    files = Files(frame=(name,))

    def __init__(self, run: Run) -> None:
        if run.config.camera.shutter.rolls:
            raise ConfigError("video.writers: 'flow' is not known of a rolling shutter")

    def begin(self, episode: Episode) -> "FlowEpisode":
        """Return the writer of an episode's flow."""
        folder = episode.folder / "flow"
        with refusals(folder):
            folder.mkdir(exist_ok=True)
        return FlowEpisode(episode)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of files; None if one is missing."""
        return numbered(folder, self.name)


class FlowEpisode(EpisodeWriter):
    """The flow of one episode; that of a frame is known when the next one is."""

    def __init__(self, episode: Episode) -> None:
        self._folder, self._size = episode.folder, (episode.height, episode.width)
        self._last: Frame | None = None

    def add(self, frame: Frame) -> None:
        """Write the flow from the last frame to this one."""
        if self._last is not None:
            self._write(self._last.number, forward_flow(self._last, frame))
        self._last = frame

    def finish(self) -> None:
        """Write that of the last frame, which is not known."""
        if self._last is not None:
            self._write(self._last.number, np.zeros((*self._size, 3), np.uint16))

    def _write(self, number: int, flow: NDArray[np.uint16]) -> None:
        write_atomic(self._folder / FlowWriter.name.format(number), png_bytes(flow))


class _Camera(NamedTuple):
    """A camera, and what it sees."""

    eye: Floats  # Optical centre [m], shape (3,)
    axes: Floats  # Camera to world; columns forward, left, up, shape (3, 3)
    focal: Floats  # Focal length [pixels], shape (1,)
    middle: Floats  # Column and row of the principal point [pixels], shape (2,)
    bent: int  # 1: `lens` bends the picture
    lens: Lens
    row: NDArray[np.int32]  # See `MovingParts`, shape (H, W)
    depth: NDArray[np.float32]  # See `MovingParts`, shape (H, W)


class _Motion(NamedTuple):
    """Motion of each of I parts to the next frame."""

    known: NDArray[np.bool_]  # Whether it is in both frames, shape (I,)
    move: Floats  # World at the first frame to world at the second, shape (I, 3, 4)


def forward_flow(first: Frame, second: Frame) -> NDArray[np.uint16]:
    """Return the flow from one frame to the next in KITTI's encoding, shape (H, W, 3).

    Red and green are the motion to the right and down [pixels], as 32768 + 64 times that; blue is 1
    where it is valid. It is not, and all is 0, where the point leaves the picture, moves farther
    than 512 pixels, or is hidden in the second frame.
    """
    assert first.parts is not None
    assert second.parts is not None
    flow = np.zeros((*first.parts.row.shape, 3), np.uint16)
    seen = _camera(first.camera, first.parts), _camera(second.camera, second.parts)
    _follow(*seen, _motion(first.parts, second.parts), flow)
    return flow


def _camera(pose: CameraPose, parts: MovingParts) -> _Camera:
    focal = np.array([focal_length(pose.width, pose.field_of_view)])
    middle = np.array(principal_point(pose.lens, pose.width, pose.height))
    bent = int(pose.lens != NO_LENS)
    return _Camera(
        pose.position, pose.rotation, focal, middle, bent, pose.lens, parts.row, parts.depth
    )


def _motion(first: MovingParts, second: MovingParts) -> _Motion:
    """Return the motion of all parts: by the inverse of the first pose, then by the second one."""
    known = (first.part >= 0) & (first.part == second.part)
    shown = np.unique(first.row[first.row >= 0])
    used = shown[known[shown]]
    before, after = (each.pose[used].astype(np.float64) for each in (first, second))
    inverse = _inverse(before[..., :3])
    turn = _product(after[..., :3], inverse)
    move = np.zeros((len(known), 3, 4))
    move[used, :, :3] = turn
    move[used, :, 3] = after[..., 3] - _product(turn, before[..., 3:])[..., 0]
    return _Motion(known, move)


def _product(a: Floats, b: Floats) -> Floats:
    """Return products of matrices, summed in order: `@` would differ between processors."""
    first, second, third = (a[..., :, k, None] * b[..., k, None, :] for k in range(3))
    product: Floats = first + second + third
    return product


def _inverse(matrix: Floats) -> Floats:
    """Return inverses of matrices, shape (K, 3, 3), by their cofactors."""
    rows = [matrix[:, (k + 1) % 3] for k in range(3)], [matrix[:, (k + 2) % 3] for k in range(3)]
    cofactors = np.stack([np.cross(a, b) for a, b in zip(*rows, strict=True)], axis=1)
    size = sum(matrix[:, 0, k] * cofactors[:, 0, k] for k in range(3))
    inverse: Floats = cofactors.swapaxes(1, 2) / np.asarray(size)[:, None, None]
    return inverse


class _Point(NamedTuple):
    """A point in the second picture."""

    column: float
    line: float
    ahead: float  # Distance along the optical axis [m]; infinity for the sky


@kernel(inline=True)
def _moved(  # what is known of a pixel
    first: _Camera, second: _Camera, motion: _Motion, line: int, column: int
) -> _Point:
    """Return where a pixel's point is in the second picture; `ahead` is 0 if it is not known."""
    row, depth = first.row[line, column], float(first.depth[line, column])
    left = (first.middle[0] - (column + 0.5)) / first.focal[0]
    up = (first.middle[1] - (line + 0.5)) / first.focal[0]
    if first.bent == 1:
        right, down, forward, area = undistorted(first.lens, -left, -up)
        if area == 0.0:
            return _Point(0.0, 0.0, 0.0)
        left, up = -right / forward, -down / forward
    sky = depth == np.inf
    scale = 1.0 if sky else depth
    x = scale * (first.axes[0, 0] + left * first.axes[0, 1] + up * first.axes[0, 2])
    y = scale * (first.axes[1, 0] + left * first.axes[1, 1] + up * first.axes[1, 2])
    z = scale * (first.axes[2, 0] + left * first.axes[2, 1] + up * first.axes[2, 2])
    if not sky:
        x, y, z = x + first.eye[0], y + first.eye[1], z + first.eye[2]
        if row >= 0:
            if not motion.known[row]:
                return _Point(0.0, 0.0, 0.0)
            move = motion.move[row]
            x, y, z = (
                move[0, 0] * x + move[0, 1] * y + move[0, 2] * z + move[0, 3],
                move[1, 0] * x + move[1, 1] * y + move[1, 2] * z + move[1, 3],
                move[2, 0] * x + move[2, 1] * y + move[2, 2] * z + move[2, 3],
            )
        x, y, z = x - second.eye[0], y - second.eye[1], z - second.eye[2]
    axes, focal = second.axes, second.focal[0]
    ahead = axes[0, 0] * x + axes[1, 0] * y + axes[2, 0] * z
    if ahead < NEAR:
        return _Point(0.0, 0.0, 0.0)
    aside = axes[0, 1] * x + axes[1, 1] * y + axes[2, 1] * z
    above = axes[0, 2] * x + axes[1, 2] * y + axes[2, 2] * z
    middle, far = second.middle, np.inf if sky else ahead
    if second.bent == 1:
        right, down = distorted(second.lens, -aside, -above, ahead)
        return _Point(middle[0] + focal * right, middle[1] + focal * down, far)
    return _Point(middle[0] - focal * aside / ahead, middle[1] - focal * above / ahead, far)


@kernel(inline=True)
def _is_seen(second: _Camera, point: _Point, row: int) -> bool:
    """Return whether one of the four pixels around a point shows its part, and nothing nearer.

    One is enough: on a slanted surface, neighbours may be nearer.
    """
    height, width = second.row.shape
    first_line, first_column = int(np.floor(point.line - 0.5)), int(np.floor(point.column - 0.5))
    for k in range(4):
        line = min(max(first_line + (k >> 1), 0), height - 1)
        column = min(max(first_column + (k & 1), 0), width - 1)
        depth = float(second.depth[line, column])
        if second.row[line, column] == row and depth >= point.ahead * (1.0 - _TOLERANCE) - _LEAST:
            return True
    return False


@compiled
def _follow(first: _Camera, second: _Camera, motion: _Motion, flow: NDArray[np.uint16]) -> None:
    """Write the flow of all pixels; see `forward_flow`."""
    height, width = first.row.shape
    for line in range(height):
        for column in range(width):
            point = _moved(first, second, motion, line, column)
            inside = 0.0 <= point.column < width and 0.0 <= point.line < height
            if point.ahead <= 0.0 or not inside:
                continue
            if not _is_seen(second, point, first.row[line, column]):
                continue
            right = np.floor(SCALE * (point.column - (column + 0.5)) + ZERO + 0.5)
            down = np.floor(SCALE * (point.line - (line + 0.5)) + ZERO + 0.5)
            if 0.0 <= right < 65536.0 and 0.0 <= down < 65536.0:
                flow[line, column, 0], flow[line, column, 1] = int(right), int(down)
                flow[line, column, 2] = 1
