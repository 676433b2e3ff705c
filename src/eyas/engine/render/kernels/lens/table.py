"""Tables of a lens: where each sample of a picture lies in the faces that are drawn for it.

They are made when a lens is first used, in float64: the lens' polynomials cannot be inverted in
closed form, and Newton's steps for each sample of each picture would take a fifth of its time.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.optics.lens import Lens, undistorted
from eyas.engine.render.kernels.bundles import DARK, LENS_TILE, LensTables
from eyas.lanes import compiled, kernel

Floats = NDArray[np.float64]

_FAR = 1 << 30


class Survey(NamedTuple):
    """What the samples of a picture show through a lens."""

    lens: Lens
    camera: Floats
    """See `LensTables`, shape (4,)."""
    across: int
    """Samples along a row of each pixel."""
    down: int
    """Samples along a column of each pixel."""
    direction: Floats
    """Forward, left, up of length 1, and the solid angle of each sample [sr], 0 where it is dark,
    shape (rows, columns, 4)."""
    face: NDArray[np.int32]
    """See `LensTables`, shape (rows, columns)."""
    turn: Floats
    """Axes of F faces, see `LensTables`, shape (F, 3, 3)."""
    reach: Floats
    """For each face: the largest tangents aside and upright, and the least width of what a sample
    shows on a plane at distance 1 along its axis; shape (F, 3)."""


@compiled
def look_around(survey: Survey) -> None:
    """Write `Survey.direction`."""
    lens, camera, seen = survey.lens, survey.camera, survey.direction
    across, down = survey.across, survey.down
    rows, columns = seen.shape[0], seen.shape[1]
    one = 1.0 / (camera[0] * camera[1] * across * down)
    for row in range(rows):
        y = ((row + 0.5) / down - camera[3]) / camera[1]
        for column in range(columns):
            x = ((column + 0.5) / across - camera[2]) / camera[0]
            right, below, ahead, area = undistorted(lens, x, y)
            seen[row, column, 0], seen[row, column, 1] = ahead, -right
            seen[row, column, 2], seen[row, column, 3] = -below, area * one


@kernel(inline=True)
def _face_of(ahead: float, left: float, up: float, faces: int) -> int:
    """Return the face that shows a direction: ahead, or aside where that is farther."""
    if faces == 1:
        return 0
    across, down = abs(left), abs(up)
    if ahead >= across and ahead >= down:
        return 0
    if across >= down:
        return 1 if left > 0.0 else 2
    return 3 if up > 0.0 else 4


@kernel(inline=True)
def _in_face(survey: Survey, row: int, column: int, face: int) -> tuple[float, float, float]:
    """Return how far a sample's direction goes along the axes of a face."""
    turn, seen = survey.turn[face], survey.direction[row, column]
    return (
        turn[0, 0] * seen[0] + turn[0, 1] * seen[1] + turn[0, 2] * seen[2],
        turn[1, 0] * seen[0] + turn[1, 1] * seen[1] + turn[1, 2] * seen[2],
        turn[2, 0] * seen[0] + turn[2, 1] * seen[1] + turn[2, 2] * seen[2],
    )


@compiled
def survey_faces(survey: Survey) -> None:
    """Write the face of each pixel, and what the faces must reach."""
    seen, face, reach = survey.direction, survey.face, survey.reach
    across, down = survey.across, survey.down
    reach[:, 0], reach[:, 1], reach[:, 2] = 0.0, 0.0, 1e9
    face[:] = DARK
    for row in range(0, seen.shape[0], down):
        for column in range(0, seen.shape[1], across):
            ahead, left, up, least = 0.0, 0.0, 0.0, 1e9
            for k in range(across * down):
                sample = seen[row + k // across, column + k % across]
                ahead, left, up = ahead + sample[0], left + sample[1], up + sample[2]
                least = min(least, sample[3])
            if least <= 0.0:
                continue
            number = _face_of(ahead, left, up, len(survey.turn))
            for k in range(across * down):
                i, j = row + k // across, column + k % across
                face[i, j] = number
                forward, aside, upright = _in_face(survey, i, j, number)
                wide = math.sqrt(seen[i, j, 3] / (forward * forward * forward))
                reach[number, 0] = max(reach[number, 0], abs(aside) / forward)
                reach[number, 1] = max(reach[number, 1], abs(upright) / forward)
                reach[number, 2] = min(reach[number, 2], wide)


@compiled
def fill_tables(survey: Survey, tables: LensTables, slot: int) -> None:
    """Write the places of all samples into the tables of a lens, whose faces are known."""
    seen, across, down = survey.direction, survey.across, survey.down
    row_of, tile = tables.row[slot], tables.tile[slot]
    row_of[:, :, 0], row_of[:, :, 1] = _FAR, 0
    tile[:, :, :, :2], tile[:, :, :, 2:] = _FAR, 0
    tables.face[slot] = DARK
    for row in range(seen.shape[0]):
        for column in range(seen.shape[1]):
            face = survey.face[row, column]
            tables.face[slot, row, column] = face
            tables.size[slot, row, column] = 1.0
            if face == DARK:
                continue
            forward, aside, upright = _in_face(survey, row, column, face)
            focal_x, focal_y = tables.focal[slot, face, 0], tables.focal[slot, face, 1]
            width, height = tables.extent[slot, face, 0], tables.extent[slot, face, 1]
            x = across * (0.5 * width - focal_x * aside / forward)
            y = down * (0.5 * height - focal_y * upright / forward)
            wide = math.sqrt(seen[row, column, 3] / (forward * forward * forward))
            tables.column[slot, row, column], tables.line[slot, row, column] = x, y
            tables.size[slot, row, column] = wide * math.sqrt(across * down * focal_x * focal_y)
            # One sample more at each side: neighbours tell how distances change.
            rows = row_of[face, row // down]
            rows[0] = min(rows[0], max(int(y - 1.0) // down, 0))
            rows[1] = max(rows[1], min(int(y + 1.0) // down + 1, height))
            box = tile[face, int(y) // LENS_TILE, int(x) // LENS_TILE]
            box[0], box[1] = min(box[0], column), min(box[1], row)
            box[2], box[3] = max(box[2], column + 1), max(box[3], row + 1)
